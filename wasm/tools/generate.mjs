// Writes what follows from the lists of options, error codes and zones of the core: wasm/src/generated/*.ts and docs/options.md;
// and from the list of the command's flags: docs/cli.md.
//
//   npm run generate
//   node wasm/tools/generate.mjs [--check] [--root FOLDER]     where the npm packages are there
//     --check   writes nothing; fails if a file is not as it would be written
//     --root    another tree than this repository, such as a test's

import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';
import { readCodes, readEnum, readOptions } from './options-list.mjs';

const { values } = parseArgs({ options: { check: { type: 'boolean' }, root: { type: 'string' } } });
const root = resolve(values.root ?? fileURLToPath(new URL('../..', import.meta.url)));

const kHead = (source) => `// Made by wasm/tools/generate.mjs from core/include/cagecast/${source}. Do not edit.\n`;

const quoted = (value) => (typeof value === 'string' ? `'${value}'` : String(value));
const typeOf = ({ kind, range }) =>
  kind === 'toggle' ? 'boolean' : kind === 'choice' ? range.map(quoted).join(' | ') : 'number';
/** What its values are, for people. */
function rangeOf({ kind, range }) {
  if (kind === 'toggle') return 'true or false';
  if (kind === 'choice')
    return new Intl.ListFormat('en', { type: 'disjunction' }).format(range.map((name) => `\`${name}\``));
  const limits = range[1] === Infinity ? `at least ${range[0]}` : `${range[0]} to ${range[1]}`;
  return kind === 'length' ? `${limits}, as a share of the target's diagonal` : limits;
}
const defaultsOf = ({ standard, paper }) =>
  standard === paper ? `Default: \`${standard}\`.` : `Default: \`${standard}\`; in the preset \`paper\`: \`${paper}\`.`;

/** Breaks a text into the lines of a comment, as formatted code has them. */
function comment(text, indent = '  ') {
  const most = 120 - indent.length - 3;
  if (text.length + 8 <= 120 - indent.length) return `${indent}/** ${text} */\n`;
  const lines = [''];
  for (const word of text.split(' ')) {
    const line = lines.at(-1);
    if (line !== '' && line.length + 1 + word.length > most) lines.push(word);
    else lines[lines.length - 1] = line === '' ? word : `${line} ${word}`;
  }
  return `${indent}/**\n${lines.map((line) => `${indent} * ${line}\n`).join('')}${indent} */\n`;
}

const field = (option) =>
  comment(`${option.text} ${capital(rangeOf(option))}. ${defaultsOf(option)}`) +
  `  ${option.name}?: ${typeOf(option)} | undefined;\n`;
const capital = (text) => text[0].toUpperCase() + text.slice(1);

function makeOptions(options) {
  const of = (stage, isStep) => options.filter((option) => option.stage === stage && option.isStep === isStep);
  const interfaceOf = (name, text, fields) =>
    `${comment(text, '')}export interface ${name} {\n${fields.map(field).join('')}}\n`;
  const row = ({ name, stage, isStep, kind, type }) =>
    `  ${name}: { stage: '${stage}', isStep: ${isStep}, kind: '${kind}'${type ? `, type: '${type}'` : ''} },\n`;
  const literal = (text) => (text.includes("'") ? (text.includes('"') ? `\`${text}\`` : `"${text}"`) : `'${text}'`);
  const values = (option) => {
    const range = `[${option.range.map(quoted).join(', ')}]`;
    const [standard, paper] = [quoted(option.standard), quoted(option.paper)];
    const text = literal(option.text);
    return `  {\n    name: '${option.name}',\n    kind: '${option.kind}',\n    range: ${range},\n    standard: ${standard},\n    paper: ${paper},\n    text: ${text},\n  },\n`;
  };
  return [
    kHead('options.def'),
    interfaceOf('ProjectStage', 'Options that `project` reads.', of('project', false)),
    interfaceOf('ClassifyStage', 'Options that `classify` reads.', of('classify', false)),
    interfaceOf('ProjectSteps', 'Switches for single steps in `project`, for measuring them.', of('project', true)),
    interfaceOf('ClassifySteps', 'Switches for single steps in `classify`, for measuring them.', of('classify', true)),
    `/** Every option: which function reads it, whether it is in \`steps\`, and what its values are. */\nexport const optionTable = {\n${options.map(row).join('')}} as const;\n`,
    `/** The values of each option outside \`steps\`, for the command and its configurations. */\nexport const optionValues = [\n${options
      .filter(({ isStep }) => !isStep)
      .map(values)
      .join('')}] as const;\n`,
  ].join('\n');
}

function makeCodes(codes) {
  return `${kHead('codes.def')}
/** Errors that the core reports. */
export type CoreCode =
${codes.map(({ name, text }) => `${comment(text)}  | '${name}'`).join('\n')};
`;
}

function makeEnums(types) {
  const js = (text) => text.replaceAll('`cosmetic`', '`Cosmetic`').replaceAll('`CulledBy`', '`culledBy`');
  const one = (type) => {
    const { text, values } = readEnum(root, type);
    return `
${comment(js(text), '')}export const ${type} = {
${values.map(({ name, value, text }) => `  /** ${js(text)} */\n  ${name}: ${value},\n`).join('')}} as const;

/** A value of {@link ${type}}. */
export type ${type} = (typeof ${type})[keyof typeof ${type}];
`;
  };
  return kHead('result.hpp') + types.map(one).join('');
}

/** The page about options: its text as it is here, with the table that follows from the list between marks. */
function makePage(options) {
  const row = (option) =>
    `| \`${option.name}\` | ${rangeOf(option).replace(/\|/g, '\\|')} | \`${option.standard}\` | \`${option.paper}\` | ${option.stage} | ${option.text} |\n`;
  const head = '| Option | Values | `default` | `paper` | Read by | What it does |\n|---|---|---|---|---|---|\n';
  const rows = options.filter(({ isStep }) => !isStep).map(row);
  const page = readFileSync(new URL('../../docs/options.md', import.meta.url), 'utf8');
  return page.replace(/(?<=<!-- table -->\n)[\s\S]*(?=<!-- end -->)/, () => head + rows.join(''));
}

/**
 * The page about the command, from the very list that `--help` prints. The command's sources are bundled without the modules that
 * the C++ build makes, which are not there yet.
 */
async function makeCommandPage() {
  const { build } = await import('esbuild').catch(() => {
    console.error('docs/cli.md needs the npm packages: `npm run generate` installs them');
    process.exit(1);
  });
  const folder = mkdtempSync(join(tmpdir(), 'cagecast-cli-'));
  const outfile = join(folder, 'program.mjs');
  const withoutModules = {
    name: 'without-modules',
    setup({ onResolve, onLoad }) {
      onResolve({ filter: /^#/ }, ({ path }) => ({ path, namespace: 'module' }));
      onLoad({ filter: /.*/, namespace: 'module' }, () => ({ contents: 'module.exports = {};' }));
    },
  };
  try {
    const contents =
      "export { makeProgram } from './program.ts'; export { pageOf } from './page.ts'; export { Io } from '../io/io.ts';";
    await build({
      stdin: { contents, resolveDir: join(root, 'wasm/src/cli/commands'), loader: 'ts' },
      outfile,
      bundle: true,
      format: 'esm',
      platform: 'node',
      logLevel: 'error',
      define: { CAGECAST_VERSION: '""' },
      banner: {
        js: "import { createRequire as cagecastRequire } from 'node:module'; const require = cagecastRequire(import.meta.url), __dirname = '', __filename = '';",
      },
      loader: { '.wasm': 'empty' },
      plugins: [withoutModules],
    });
    const { makeProgram, pageOf, Io } = await import(pathToFileURL(outfile));
    return pageOf(makeProgram(new Io({})));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

const options = readOptions(root);
const files = {
  'wasm/src/generated/options.ts': makeOptions(options),
  'wasm/src/generated/codes.ts': makeCodes(readCodes(root)),
  'wasm/src/generated/enums.ts': makeEnums(['Visibility', 'Zone']),
  'docs/options.md': makePage(options),
  // Made last, as it depends on the first of these. A test's tree has no command.
  ...(existsSync(join(root, 'wasm/src/cli')) && { 'docs/cli.md': makeCommandPage }),
};
let stale = 0;
for (const [name, made] of Object.entries(files)) {
  const text = typeof made === 'function' ? await made() : made;
  const path = join(root, name);
  if (existsSync(path) && readFileSync(path, 'utf8') === text) continue;
  if (values.check) {
    console.error(`${name} is stale: run node wasm/tools/generate.mjs`);
    ++stale;
  } else {
    mkdirSync(dirname(path), { recursive: true });
    writeFileSync(path, text);
  }
}
process.exit(stale > 0 ? 1 : 0);
