// Lists the licences of what others wrote and dist/ contains.

import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

/** three.js has a copy of it. */
const inThree = /three\/examples\/jsm\/libs\/fflate/;
const fflateNotice = `fflate 0.8 (in command-formats.cjs, as a part of three, MIT, https://101arrowz.github.io/fflate)

Copyright (c) 2023 Arjun Barrett. The terms are those of three, above.
`;

const rule = `\n${'-'.repeat(80)}\n\n`;

/**
 * @param {string} root  The repository.
 * @param {Iterable<string>} inputs  Files that were bundled, from the repository on.
 * @param {string} build  The folder of the build, with what is compiled into the WebAssembly modules.
 */
export function noticesOf(root, inputs, build) {
  const packages = new Set();
  for (const path of inputs) {
    const start = path.lastIndexOf('node_modules/');
    if (start < 0) continue;
    const [scope, name] = path.slice(start + 'node_modules/'.length).split('/');
    packages.add(`${path.slice(0, start)}node_modules/${scope.startsWith('@') ? `${scope}/${name}` : scope}`);
  }
  const header = readFileSync(join(build, 'core/nanoflann/nanoflann.hpp'), 'utf8');
  const meshoptimizer = readFileSync(join(build, '_deps/cagecast_meshoptimizer-src/LICENSE.md'), 'utf8');
  const notices = [...packages].sort().map((folder) => noticeOf(join(root, folder)));
  return `Cagecast contains the following third-party software.\n${rule}${[
    ...notices,
    ...(inThree.test([...inputs].join('\n')) ? [fflateNotice] : []),
    `nanoflann (in the WebAssembly modules)\n\n${header.slice(header.indexOf('/*'), header.indexOf('*/') + 2)}\n`,
    `meshoptimizer 0.22 (in cagecast-cages.wasm, https://github.com/zeux/meshoptimizer)\n\n${meshoptimizer.trim()}\n`,
    `Eigen 3.4 (in cagecast-cages.wasm)\n\nMozilla Public License 2.0, https://www.mozilla.org/MPL/2.0/. Unchanged; the source is at\nhttps://eigen.tuxfamily.org and in Debian's package libeigen3-dev.\n`,
  ].join(rule)}`;
}

function noticeOf(folder) {
  const { name, version, license, homepage } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  const file = readdirSync(folder).find((entry) => /^(licen[cs]e|copying)/i.test(entry));
  const text = file && existsSync(join(folder, file)) ? readFileSync(join(folder, file), 'utf8').trim() : '';
  return `${name} ${version} (${license}${homepage ? `, ${homepage}` : ''})\n\n${text || `Licence: ${license}.`}\n`;
}
