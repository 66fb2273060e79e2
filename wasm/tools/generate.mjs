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
const flagOf = ({ name }) => `--${name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`)}`;

function makeOptions(options) {
  const of = (stage, isStep) => options.filter((option) => option.stage === stage && option.isStep === isStep);
  const interfaceOf = (name, text, fields) =>
    `${comment(text, '')}export interface ${name} {\n${fields.map(field).join('')}}\n`;
  const row = ({ name, stage, isStep, kind, type }) =>
    `  ${name}: { stage: '${stage}', isStep: ${isStep}, kind: '${kind}'${type ? `, type: '${type}'` : ''} },\n`;
  const literal = (text) => (text.includes("'") ? (text.includes('"') ? `\`${text}\`` : `"${text}"`) : `'${text}'`);
  const flag = (option) => {
    const range = `[${option.range.map(quoted).join(', ')}]`;
    const [standard, paper] = [quoted(option.standard), quoted(option.paper)];
    const text = literal(option.text);
    return `  {\n    name: '${option.name}',\n    flag: '${flagOf(option)}',\n    kind: '${option.kind}',\n    range: ${range},\n    standard: ${standard},\n    paper: ${paper},\n    text: ${text},\n  },\n`;
  };
  return [
    kHead('options.def'),
    interfaceOf('ProjectStage', 'Options that `project` reads.', of('project', false)),
    interfaceOf('ClassifyStage', 'Options that `classify` reads.', of('classify', false)),
    interfaceOf('ProjectSteps', 'Switches for single steps in `project`, for measuring them.', of('project', true)),
    interfaceOf('ClassifySteps', 'Switches for single steps in `classify`, for measuring them.', of('classify', true)),
    `/** Every option: which function reads it, whether it is in \`steps\`, and what its values are. */\nexport const optionTable = {\n${options.map(row).join('')}} as const;\n`,
    `/** The command's flags, one for each option outside \`steps\`. */\nexport const optionFlags = [\n${options
      .filter(({ isStep }) => !isStep)
      .map(flag)
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

function makePage(options) {
  const row = (option) =>
    `| \`${option.name}\` | ${rangeOf(option).replace(/\|/g, '\\|')} | \`${option.standard}\` | \`${option.paper}\` | ${option.stage} | ${option.text} |\n`;
  const head = '| Option | Values | `default` | `paper` | Read by | What it does |\n|---|---|---|---|---|---|\n';
  const rows = (isStep) =>
    options
      .filter((option) => option.isStep === isStep)
      .map(row)
      .join('');
  const flags = options.filter(({ isStep }) => !isStep).map((option) => `\`${flagOf(option)}\``);
  return `# Options

<!-- Made by wasm/tools/generate.mjs from core/include/cagecast/options.def. Do not edit. -->

C++ (\`TransferOptions\`), JavaScript and the command have the same options with the same defaults. \`transfer\`
reads all of them, \`project\` and \`classify\` those of their own stage. \`cutBorders\` keeps the verdicts on segments that it is
given: of the options of \`project\` it reads all (\`weldTolerance\` only decides which vertices take part: what is cut is not welded by it), of those of
\`classify\` only \`partialTriangles\`. Options that are not given have the value of the preset: \`default\`, or \`paper\` for the method as published.

${head}${rows(false)}
JavaScript also has \`preset\`, \`locks\`, \`masks\` and \`reuse\` (an earlier result whose arrays are overwritten). C++ also has
\`locks\` and \`masks\`, and \`TransferOptions::paper()\` in place of \`preset\`. For example, in JavaScript,
\`locks: { segments: { 7: 'keep' }, groups: { 3: 'exclude' } }\` never culls segment 7 and always culls the other segments
of group 3: the lock of a segment overrides that of its group. \`keep\` only prevents culling: occluded and uncovered points of a kept segment stay unpainted unless step 9 or 10
recovers them. The command has ${flags.join(', ')}, \`--preset\`, \`--keep\` and \`--exclude\`.

## Masks

Locks are for whole segments and parts. Masks are for what no name tells apart, such as the eyes of a scan in one piece:
−1 is never painted, 1 always, and 0 is left to the method. −1 overrides 1, and masks override locks.

| Source | \`cagecast\`, \`cagecast/worker\` | \`cagecast/gltf\` | \`cagecast/three\` | Command |
|---|---|---|---|---|
| an array, as a painting tool makes | \`masks: { vertices, triangles }\`, \`Int8Array\`s; in C++ \`masks\`, spans of \`Mask\` | \`masks\` | \`masks\` | |
| an image in the model's own UVs: white is masked | \`maskTriangles\` of \`cagecast/bake\` | \`maskImages: { never, always }\` | \`modelMasks(model, { never, always })\` | \`--never-mask\`, \`--always-mask\` |
| vertex colours: red never, green always | \`maskVertices\` of \`cagecast/bake\` | \`maskColors: 'COLOR_0'\` | \`modelMasks(model, { attribute: 'color' })\` | \`--mask-colors COLOR_0\` |

- **Masks end at edges of triangles.** An image masks a triangle if at least half of it is white. A vertex of −1 keeps paint
  from all triangles at it; a triangle with a vertex of 1 is painted if its other vertices may be. With \`borders: 'cut'\`, a masked
  triangle is decided as a whole.
- **"Always" does not make room on the cage.** Over a hole, or beyond the cage's border, what is painted shows the nearest place of the
  cage, often stretched. Under another surface it is painted, but not seen.
- Masks change neither segments nor their scores, and explain no holes. A masked vertex has zone 3, culled, though its
  segment is not. Pass the same masks to \`classify\` and \`cutBorders\`.
- Images hold for all parts with UVs. Where parts have textures of their own, use arrays.

## Steps

The switches in \`steps\` turn single steps of the [method](method.md) on and off. They are meant for measuring what each step
contributes and are not part of the stable interface.

${head}${rows(true)}`;
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
        js: "import { createRequire } from 'node:module'; const require = createRequire(import.meta.url), __dirname = '', __filename = '';",
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
