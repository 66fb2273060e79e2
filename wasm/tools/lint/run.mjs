// Checks how the sources look: `npm run lint`, and the first thing that `npm test` does.
//
//   node wasm/tools/lint/run.mjs [step …] [--root FOLDER]
//     step      arrows, limits, patterns, pins, scale, generated, docs, format, biome, tidy; all but the last, which takes a minute, if none is named
//     --root    another tree than this repository, such as a test's

import { execFile } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { checkArrows } from './arrows.mjs';
import { checkDocs } from './docs.mjs';
import { isCpp, listFiles } from './files.mjs';
import { checkLimits } from './limits.mjs';
import { checkPatterns } from './patterns.mjs';
import { checkPins } from './pins.mjs';
import { checkScale } from './scale.mjs';
import { checkTidy } from './tidy.mjs';

const repository = fileURLToPath(new URL('../../..', import.meta.url));

/** Runs a command; what it printed if it failed, by lines. */
function problemsOf(root, program, ...args) {
  return new Promise((done) => {
    execFile(program, args, { cwd: root, maxBuffer: 1 << 26 }, (error, stdout, stderr) => {
      if (!error) return done([]);
      done(
        `${stdout}${stderr}`
          .trim()
          .split('\n')
          .filter(Boolean)
          .concat(stdout || stderr ? [] : error.message),
      );
    });
  });
}

/** The file in node_modules/.bin stands in for npx, which takes half a second to find it. */
const biome = join(repository, 'node_modules/@biomejs/biome/bin/biome');

/** The checks, by name: each returns a line for each fault. */
const kSteps = {
  arrows: (root, files) => checkArrows(root, files),
  limits: (root, files) => checkLimits(root, files),
  patterns: (root, files) => checkPatterns(root, files),
  pins: (root, files) => checkPins(root, files),
  scale: (root, files) => checkScale(root, files),
  generated: (root) => {
    const generate = join(root, 'wasm/tools/generate.mjs');
    return existsSync(generate) ? problemsOf(root, process.execPath, generate, '--check') : [];
  },
  docs: (root, files) => checkDocs(root, files),
  format: (root, files) => {
    const sources = files.filter(isCpp).filter((file) => !file.endsWith('.def'));
    return sources.length > 0 ? problemsOf(root, 'clang-format', '--dry-run', '-Werror', ...sources) : [];
  },
  biome: (root) =>
    problemsOf(root, process.execPath, biome, 'check', '--error-on-warnings', '--colors=off', '--max-diagnostics=100'),
  tidy: (root) => checkTidy(root),
};

const { values, positionals } = parseArgs({ allowPositionals: true, options: { root: { type: 'string' } } });
const unknown = positionals.find((name) => !(name in kSteps));
if (unknown) {
  console.error(`no step "${unknown}"; there are: ${Object.keys(kSteps).join(', ')}`);
  process.exit(2);
}
const root = resolve(values.root ?? repository);
const files = listFiles(root);
let failed = 0;
const usual = Object.keys(kSteps).filter((name) => name !== 'tidy');
for (const name of positionals.length > 0 ? positionals : usual) {
  const began = Date.now();
  const problems = await kSteps[name](root, files);
  console.log(
    `lint ${name.padEnd(9)} ${problems.length > 0 ? 'FAILED' : 'ok'} (${((Date.now() - began) / 1000).toFixed(1)} s)`,
  );
  for (const line of problems) console.log(`  ${line}`);
  failed += Number(problems.length > 0);
}
process.exit(failed > 0 ? 1 : 0);
