// Small changes to C++ sources, each of which a test should notice: operators, minima and maxima, constants.

/** What stands for an operator in its mutants: the neighbour at the bound, and the opposite. */
const kOperators = {
  '<': ['<=', '>='],
  '<=': ['<', '>'],
  '>': ['>=', '<='],
  '>=': ['>', '<'],
  '==': ['!='],
  '!=': ['=='],
  '+': ['-'],
  '-': ['+'],
  '*': ['/'],
  '/': ['*'],
  '&&': ['||'],
  '||': ['&&'],
};
const kCalls = { min: 'max', max: 'min', fmin: 'fmax', fmax: 'fmin' };

/** Comments, string and character literals, preprocessor lines and static assertions: nothing in them is changed. */
const kSkipped =
  /\/\/[^\n]*|\/\*[\s\S]*?\*\/|"(?:\\.|[^"\\\n])*"|(?<![\da-fA-F])'(?:\\.|[^'\\\n])+'|^[ \t]*#(?:\\\n|[^\n])*|static_assert\([^;]*;/gm;
/** clang-format puts space around binary operators, and around nothing else that is written with the same signs. */
const kOperator = /(?<=\s)(<=|>=|==|!=|&&|\|\||[<>+\-*/])(?=\s)/g;
const kCall = /\b(?:std|simd)::(f?min|f?max)(?=\()/g;
const kNumber = /(?<![\w.])(\d[\d']*(?:\.\d*)?(?:e[+-]?\d+)?)([fu]?)(?![\w.])/g;

/** The text with spaces for all that is skipped, so that places stay the same. */
function withoutSkipped(text) {
  return text.replace(kSkipped, (part) => part.replace(/[^\n]/g, ' '));
}

/** Whether a number is how many elements a declared array has, or a template's argument. */
function isSize(text, start, end) {
  const before = text.slice(text.lastIndexOf('\n', start) + 1, start);
  return (
    (/[\w>*&)]\s+\w+(\[\d+\])?\[$|\(&\w+\)\[$/.test(before) && !/\breturn\s+\w+\[$/.test(before)) ||
    (/\w<([^<>()]*,\s*)?$/.test(before) && /^[,>]/.test(text.slice(end)))
  );
}

function numbersInsteadOf(digits, suffix) {
  const value = Number(digits.replaceAll("'", ''));
  if (/[.e]/.test(digits) || suffix === 'f')
    return value === 0 ? [`1.0${suffix}`] : [`(2 * ${digits}${suffix})`, `(0.5${suffix} * ${digits}${suffix})`];
  return value === 0 ? [`1${suffix}`] : [`${value + 1}${suffix}`, `${value - 1}${suffix}`];
}

/** What may be put in the place of something: [start, end, text …]. */
function* replacements(text) {
  for (const { 1: operator, index } of text.matchAll(kOperator))
    yield [index, index + operator.length, ...kOperators[operator]];
  for (const match of text.matchAll(kCall)) {
    const end = match.index + match[0].length;
    yield [end - match[1].length, end, kCalls[match[1]]];
  }
  for (const { 0: all, 1: digits, 2: suffix, index } of text.matchAll(kNumber)) {
    const end = index + all.length;
    if (!isSize(text, index, end)) yield [index, end, ...numbersInsteadOf(digits, suffix)];
  }
}

/**
 * All mutants of a file, by place.
 * @param {string} file  Its path, which the mutants carry along.
 * @param {string} text
 * @return Where each starts and ends, what is put there, the number of its line, and that line before and after.
 */
export function mutantsOf(file, text) {
  const mutants = [];
  for (const [start, end, ...others] of replacements(withoutSkipped(text))) {
    const from = text.lastIndexOf('\n', start) + 1;
    const to = (text.indexOf('\n', start) + text.length + 1) % (text.length + 1);
    for (const put of others) {
      const line = text.slice(from, to).trim();
      const mutant = (text.slice(from, start) + put + text.slice(end, to)).trim();
      mutants.push({ file, start, end, put, number: text.slice(0, start).split('\n').length, line, mutant });
    }
  }
  return mutants.sort((a, b) => a.start - b.start);
}

/** The text of a file with one mutant in it. */
export const mutated = (text, { start, end, put }) => text.slice(0, start) + put + text.slice(end);

/** The same order for the same seed, on every machine. */
export function shuffled(values, seed) {
  let state = seed >>> 0;
  const random = () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
  return values
    .map((value) => [random(), value])
    .sort(([a], [b]) => a - b)
    .map(([, value]) => value);
}
