// Checks which folder includes or imports which: dependencies go one way only.
import { existsSync, readFileSync } from 'node:fs';
import { dirname, join, normalize } from 'node:path';
import { isCpp, isScript } from './files.mjs';

// Folders lowest first: a file may include or import its own folder and those before it. Files beside the folders have their
// places by name, as transfer.cpp of the core has.
const kCoreOrder = ['base', 'simd', 'geometry', 'input', 'search', 'cage', 'steps', 'seams', 'clip', 'transfer', 'c'];
const kCagesOrder = ['linear', 'mesh', 'hull', 'views', 'landmarks', 'charts', 'make', 'fit', 'refine', 'c'];
const kPackageOrder = [
  'generated',
  'core',
  'api',
  'inspect',
  'index',
  'bake',
  'parts',
  'engines',
  'worker',
  'cages',
  'scene',
  'gltf',
  'three',
  'react',
  'viewer',
  'cli',
];
const kCommandOrder = ['model', 'io', 'transfer', 'commands', 'command', 'main'];
const kPageOrder = ['state', 'platform', 'loading', 'view', 'tools', 'explain', 'export', 'panels', 'features', 'app'];

/** The orders, by where they hold: of those that hold two files, the first counts. */
const kOrders = {
  'wasm/src/cli/': kCommandOrder,
  'core/src/': kCoreOrder,
  'core/cages/': kCagesOrder,
  'wasm/src/': kPackageOrder,
  'web/src/': kPageOrder,
};

/** Where a quoted include is looked up, after the folder of the file itself. */
const kIncludeFolders = ['core/src', 'core/include', 'core/cages', 'core', 'tests/core'];

/**
 * What C++ files may include, by where they are; the first line that fits counts. Folders that are not listed, the tests and
 * the benchmark, may include anything.
 */
const kCppRules = [
  { from: 'core/include/', may: ['core/include/'], rule: 'public headers include public headers only' },
  { from: 'core/src/', may: ['core/include/', 'core/src/'], rule: 'the core includes nothing but itself' },
  {
    from: 'core/cages/',
    may: ['core/include/', 'core/src/', 'core/cages/'],
    rule: 'core/cages uses the core and itself only',
  },
  { from: 'core/gltf/', may: ['core/include/', 'core/gltf/'], rule: 'core/gltf uses the public headers only' },
  { from: 'wasm/', may: ['core/include/', 'wasm/'], rule: 'the bindings use the public headers only' },
  {
    from: 'examples/',
    may: ['core/include/', 'core/gltf/', 'examples/'],
    rule: 'examples use the public headers only',
  },
];

/** What TypeScript and JavaScript may import by a relative path, as above. Other parts are imported by the package's name. */
const kScriptRules = [
  { from: 'wasm/src/', may: ['wasm/src/'], rule: 'the package imports nothing of the rest of the repository' },
  { from: 'wasm/tools/', may: ['wasm/tools/', 'package.json'], rule: 'build tools import build tools only' },
  { from: 'web/', may: ['web/'], rule: "the page imports the package by its public name, 'cagecast'" },
  { from: 'examples/', may: ['examples/'], rule: "examples import the package by its public name, 'cagecast'" },
];

/** What browsers have and Node lacks, which the state of the page does without. */
const kOfBrowsers =
  /\b(document|window|location|navigator|localStorage|sessionStorage|addEventListener|requestAnimationFrame|HTML\w*Element)\b/;

/** `steps` for steps/holes.cpp, `transfer` for transfer.cpp. */
function folderOf(path) {
  const [first, ...rest] = path.split('/');
  return rest.length > 0 ? first : first.replace(/\.[a-z]+$/, '');
}

/** Checks two files of the same part against the order of its folders. */
function checkOrder(from, to) {
  const part = Object.keys(kOrders).find((candidate) => from.startsWith(candidate) && to.startsWith(candidate));
  if (part === undefined) return undefined;
  const order = kOrders[part];
  const [higher, lower] = [from, to].map((path) => folderOf(path.slice(part.length)));
  const unknown = [higher, lower].find((folder) => !order.includes(folder));
  if (unknown !== undefined) return `${unknown} is not in the order of folders: ${order.join(', ')}`;
  return order.indexOf(lower) > order.indexOf(higher) ? `${higher} is below ${lower}` : undefined;
}

function checkInclude(root, from, text) {
  const to = [dirname(from), ...kIncludeFolders]
    .map((folder) => normalize(join(folder, text)).replaceAll('\\', '/'))
    .find((path) => existsSync(join(root, path)));
  if (to === undefined) return undefined; // Of the system, or of a library.
  const rule = kCppRules.find((candidate) => from.startsWith(candidate.from));
  if (rule && !rule.may.some((folder) => to.startsWith(folder))) return rule.rule;
  return checkOrder(from, to);
}

function checkImport(from, text) {
  if (!text.startsWith('.')) {
    const isItself = from.startsWith('wasm/src/') && /^cagecast(\/|$)/.test(text);
    return isItself ? 'the package does not import itself by name' : undefined;
  }
  const to = normalize(join(dirname(from), text)).replaceAll('\\', '/');
  const rule = kScriptRules.find((candidate) => from.startsWith(candidate.from));
  if (rule && !rule.may.some((folder) => to.startsWith(folder))) return rule.rule;
  return checkOrder(from, to);
}

const kInclude = /^\s*#\s*include\s+["<]([^">]+)[">]/;
const kComment = /^\s*(\*|\/\/|\/\*)/;
const kImport = /(?:^|[^\w.])(?:from|import)\s*\(?\s*(['"])([^'"\n]+)\1/;

/**
 * @param {string} root  The repository, or a tree like it.
 * @param {string[]} files  Paths from there.
 * @return {string[]}  What is wrong, as `path:line: …`.
 */
export function checkArrows(root, files) {
  const problems = [];
  for (const path of files) {
    if (!isCpp(path) && !isScript(path)) continue;
    const lines = readFileSync(join(root, path), 'utf8').split('\n');
    for (const [index, line] of lines.entries()) {
      if (kComment.test(line)) continue;
      const text = isCpp(path) ? kInclude.exec(line)?.[1] : kImport.exec(line)?.[2];
      const problem = text && (isCpp(path) ? checkInclude(root, path, text) : checkImport(path, text));
      if (problem) problems.push(`${path}:${index + 1}: "${text}": ${problem}`);
      const browsers = path.startsWith('web/src/state/') && kOfBrowsers.exec(line.replace(/\/\/.*/, ''))?.[0];
      if (browsers) problems.push(`${path}:${index + 1}: "${browsers}": the state of the page does without browsers`);
    }
  }
  return problems;
}
