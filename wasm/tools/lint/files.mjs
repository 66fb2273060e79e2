// The files for the lint: tracked by Git, or new; build outputs never count.
import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';

/**
 * @param {string} root  A folder of a Git work tree.
 * @return {string[]}  Paths from `root`, with forward slashes, sorted.
 */
export function listFiles(root) {
  const text = execFileSync('git', ['ls-files', '-z', '--cached', '--others', '--exclude-standard'], {
    cwd: root,
    encoding: 'utf8',
    maxBuffer: 1 << 26,
  });
  return [...new Set(text.split('\0'))].filter((path) => path && existsSync(join(root, path))).sort();
}

export const isCpp = (path) => /\.(cpp|hpp|def|c|h)$/.test(path);
export const isScript = (path) => /\.(ts|mjs|js)$/.test(path);
