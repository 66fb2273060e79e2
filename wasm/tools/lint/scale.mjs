// Weighs the project as a whole: `bench/budget.json` says under "scale" how much of each there may be. A commit that needs more raises
// the figure, and its body says why and what pays for it.
//
//   node wasm/tools/lint/scale.mjs [--record]      shows the figures; makes those of now the limits
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { isCpp, isScript, listFiles } from './files.mjs';

const kBudget = 'bench/budget.json';

const isCode = (path) => isCpp(path) || isScript(path) || /\.(tsx|css|html|h|c|py|glsl)$/.test(path);
const isPage = (path) => /^(README|CONTRIBUTING|CHANGELOG)\.md$|^docs\/.*\.md$/.test(path);
const isProduct = (path) => /^(core|wasm|web)\//.test(path);

/** Names of a module's exported values, with those of the modules it re-exports. */
function valuesOf(root, path, seen = new Set()) {
  if (seen.has(path)) return [];
  seen.add(path);
  const text = readFileSync(join(root, path), 'utf8');
  const found = [...text.matchAll(/^export (?:async )?(?:abstract )?(?:const|let|function\*?|class|enum) (\w+)/gm)].map(
    ([, name]) => name,
  );
  for (const [, names] of text.matchAll(/^export \{([^}]*)\}/gm))
    for (const name of names.split(','))
      if (name.trim() !== '' && !/^\s*type /.test(name))
        found.push(
          name
            .trim()
            .split(/\s+as\s+/)
            .at(-1),
        );
  for (const [, from] of text.matchAll(/^export \* from '(\.[^']*)\.js'/gm))
    found.push(...valuesOf(root, `${join(dirname(path), from)}.ts`, seen));
  return [...new Set(found)];
}

/** The entries of the package that are modules, and the source of each. */
function entriesOf(root) {
  const { exports } = JSON.parse(readFileSync(join(root, 'package.json'), 'utf8'));
  return Object.entries(exports).flatMap(([name, { types, default: file = '' }]) =>
    file.endsWith('.js') ? [{ name, source: types.replace(/^\.\/dist\/(.*)\.d\.ts$/, 'wasm/src/$1.ts') }] : [],
  );
}

const isComment = (line) => /^\s*(\/\/|\/?\*)/.test(line);
const clausesIn = (line) => line.match(/\b(that|what|which|those|whose)\b/gi)?.length ?? 0;

/** The flags of a command: in its own section of the page, and in those that it refers to. */
function flagsOf(page, command) {
  const sectionOf = (heading) => page.split(/^(?=## )/m).find((section) => section.startsWith(`## ${heading}\n`)) ?? '';
  const own = sectionOf(`cagecast ${command}`);
  const others = /^Also: .*$/m.exec(own)?.[0].matchAll(/\[([^\]]*)\]/g) ?? [];
  const all = [own, ...[...others].map(([, text]) => sectionOf(text[0].toUpperCase() + text.slice(1)))].join('');
  return [...new Set(all.match(/(?<=^\| `(-\w, )?)--[\w-]+/gm))];
}

/**
 * The project's weight. Lines of code are neither empty nor a comment alone.
 * @param {string} root  The repository.
 * @param {string[]} files  Paths from there.
 * @return {Record<string, number>}
 */
export function weigh(root, files) {
  const read = (path) => readFileSync(join(root, path), 'utf8');
  const linesOf = (some) => some.flatMap((path) => read(path).split('\n'));
  const codeOf = (some) => linesOf(some).filter((line) => line.trim() !== '' && !isComment(line)).length;
  const code = files.filter(isCode);
  const tests = code.filter((path) => path.startsWith('tests/'));
  const entries = entriesOf(root);
  const command = read('docs/cli.md');
  const commands = [...command.matchAll(/^## cagecast (\w+)$/gm)].map(([, name]) => name);
  const comments = linesOf(code).filter(isComment);
  const rounded = (share, digits) => Number(share.toFixed(digits));
  return {
    'lines of code': codeOf(code),
    'lines of tests per line of core, wasm and web': rounded(codeOf(tests) / codeOf(code.filter(isProduct)), 3),
    'lines that make samples': codeOf(code.filter((path) => path.startsWith('examples/samples/'))),
    'entries of the package': entries.length,
    'exported values': [...new Set(entries.map(({ source }) => source))].reduce(
      (sum, source) => sum + valuesOf(root, source).length,
      0,
    ),
    'flags of the command': new Set(commands.flatMap((name) => flagsOf(command, name))).size,
    'flags of batch': flagsOf(command, 'batch').length,
    'words of pages': files.filter(isPage).reduce((sum, path) => sum + read(path).split(/\s+/).length - 1, 0),
    'comment lines with three or more relative words, in %': rounded(
      (100 * comments.filter((line) => clausesIn(line) >= 3).length) / comments.length,
      2,
    ),
  };
}

/**
 * @param {string} root  The repository, or a tree like it.
 * @param {string[]} files  Paths from there.
 * @return {string[]}  What is wrong.
 */
export function checkScale(root, files) {
  if (!existsSync(join(root, kBudget))) return [];
  const { scale } = JSON.parse(readFileSync(join(root, kBudget), 'utf8'));
  return Object.entries(weigh(root, files)).flatMap(([name, value]) =>
    value <= (scale?.[name] ?? Infinity)
      ? []
      : `${name}: ${value}, more than the ${scale[name]} of ${kBudget}; remove as much, or raise it and say why in the commit`,
  );
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const root = fileURLToPath(new URL('../../..', import.meta.url));
  const scale = weigh(root, listFiles(root));
  const budget = JSON.parse(readFileSync(join(root, kBudget), 'utf8'));
  for (const [name, value] of Object.entries(scale))
    console.log(`${String(value).padStart(8)}  of ${budget.scale?.[name] ?? 'any'}  ${name}`);
  if (process.argv.includes('--record'))
    writeFileSync(join(root, kBudget), `${JSON.stringify({ ...budget, scale }, null, 2)}\n`);
}
