// Lists the licences of what others wrote and dist/ contains.

import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

const rule = `\n${'-'.repeat(80)}\n\n`;

/**
 * @param {string} root  The repository.
 * @param {Iterable<string>} inputs  Files that were bundled, from the repository on.
 * @param {string} nanoflann  nanoflann.hpp, which is compiled into the WebAssembly module.
 */
export function noticesOf(root, inputs, nanoflann) {
  const packages = new Set();
  for (const path of inputs) {
    const start = path.lastIndexOf('node_modules/');
    if (start < 0) continue;
    const [scope, name] = path.slice(start + 'node_modules/'.length).split('/');
    packages.add(`${path.slice(0, start)}node_modules/${scope.startsWith('@') ? `${scope}/${name}` : scope}`);
  }
  const header = readFileSync(nanoflann, 'utf8');
  const notices = [...packages].sort().map((folder) => noticeOf(join(root, folder)));
  return `Cagecast contains the following third-party software.\n${rule}${[
    ...notices,
    `nanoflann (in the WebAssembly module)\n\n${header.slice(header.indexOf('/*'), header.indexOf('*/') + 2)}\n`,
  ].join(rule)}`;
}

function noticeOf(folder) {
  const { name, version, license, homepage } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  const file = readdirSync(folder).find((entry) => /^(licen[cs]e|copying)/i.test(entry));
  const text = file && existsSync(join(folder, file)) ? readFileSync(join(folder, file), 'utf8').trim() : '';
  return `${name} ${version} (${license}${homepage ? `, ${homepage}` : ''})\n\n${text || `Licence: ${license}.`}\n`;
}
