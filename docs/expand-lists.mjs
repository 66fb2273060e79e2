// Shows Doxygen a header with the lines of its lists (options.def, codes.def) written out, each with its text as a comment.
//
//   node docs/expand-lists.mjs HEADER
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const include = fileURLToPath(new URL('../core/include/', import.meta.url));

/** Splits the arguments of a macro at its top commas. */
function argumentsOf(text) {
  const parts = [''];
  let depth = 0;
  let isQuoted = false;
  for (const c of text) {
    if (c === '"') isQuoted = !isQuoted;
    if (!isQuoted) depth += Number(c === '(') - Number(c === ')');
    if (c === ',' && depth === 0 && !isQuoted) parts.push('');
    else parts[parts.length - 1] += c;
  }
  return parts.map((part) => part.trim());
}

/** The lines of a list: the macro of each, and its arguments. */
const entriesOf = (list) =>
  [...readFileSync(`${include}${list}`, 'utf8').matchAll(/^(CAGECAST_\w+)\((.*)\)$/gm)].map(([, macro, values]) => ({
    macro,
    values: argumentsOf(values),
  }));

/** What a macro makes of a line of the list, with the line's text as a comment. */
function expand({ names, body }, values) {
  const byName = Object.fromEntries(names.map((name, i) => [name, values[i]]));
  const typed = body.replace(/CAGECAST_TYPE_##(\w+)/, (_, kind) =>
    byName[kind]
      .replace(/^choice\((\w+)\)$/, '$1')
      .replace(/^(share|length)$/, 'float')
      .replace(/^toggle$/, 'bool'),
  );
  const code = typed.replace(/\b\w+\b/g, (word) => byName[word] ?? word);
  if (/\boptions\./.test(code)) return code;
  const [least, most] = (byName.range ?? '').slice(1, -1).split(', ');
  const range = /^(share|length)$/.test(byName.kind)
    ? ` Range ${least} to ${most}.`.replace(/(\d)f/g, '$1').replace('kInfinity', 'infinity')
    : '';
  return `${code}  ///< ${byName.text.slice(1, -1)}${range}`;
}

const text = readFileSync(process.argv[2], 'utf8').replace(
  /((?:^#define CAGECAST_(?:OPTION|STEP|CODE|CAGES_CODE)\(.*\n)+)#include "(.*\.def)"$/gm,
  (_, defines, list) => {
    const macros = Object.fromEntries(
      [...defines.matchAll(/^#define (CAGECAST_\w+)\((.*?)\) (.*)$/gm)].map(([, name, names, body]) => [
        name,
        { names: argumentsOf(names), body },
      ]),
    );
    const lines = entriesOf(list).filter(({ macro }) => macro in macros);
    return lines.map(({ macro, values }) => expand(macros[macro], values)).join('\n');
  },
);
process.stdout.write(text);
