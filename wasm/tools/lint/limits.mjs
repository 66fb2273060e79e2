// Checks how many files a folder has and how many lines a file. The length of functions and the number of their parameters are
// left to clang-tidy (.clang-tidy) and Biome (biome.json).
import { readFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { isCpp, isScript } from './files.mjs';

const kMaxFiles = 25;
const kMaxLines = 450;

const hasLineLimit = (path) => /^(core|wasm)\//.test(path) && (isCpp(path) || isScript(path));

/**
 * @param {string} root  The repository, or a tree like it.
 * @param {string[]} files  Paths from there.
 * @return {string[]}  What is wrong.
 */
export function checkLimits(root, files) {
  const problems = [];
  const counts = new Map();
  // Dot files at the top are settings, not reading matter.
  for (const path of files.filter((file) => !basename(file).startsWith('.'))) {
    counts.set(dirname(path), (counts.get(dirname(path)) ?? 0) + 1);
  }
  for (const [folder, count] of counts) {
    if (count > kMaxFiles) problems.push(`${folder}/ has ${count} files; at most ${kMaxFiles} are allowed`);
  }
  for (const path of files.filter(hasLineLimit)) {
    const lines = readFileSync(join(root, path), 'utf8').split('\n').length - 1;
    if (lines > kMaxLines) problems.push(`${path} has ${lines} lines; at most ${kMaxLines} are allowed`);
  }
  return problems;
}
