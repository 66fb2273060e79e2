// Lists what others wrote and the package contains: for its file of licences, and for the list of parts that a release has (sbom.mjs).

import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

/**
 * @typedef {object} Part
 * @property {string} name
 * @property {string} version
 * @property {string} license  An SPDX expression.
 * @property {string} [url]
 * @property {string} purl  Its package URL, by which databases of vulnerabilities know it.
 * @property {string} [where]  What contains it, if that is not the package's own scripts.
 * @property {string} text  What its licence says.
 */

const rule = `\n${'-'.repeat(80)}\n\n`;

/**
 * @param {string} root  The repository.
 * @param {Iterable<string>} inputs  Files that were bundled, from the repository on, of which something is left.
 * @param {string} build  The folder of the build, with what is compiled into the WebAssembly modules.
 * @param {string} emscripten  The folder of Emscripten.
 * @return {Part[]}
 */
export function partsOf(root, inputs, build, emscripten) {
  const files = [...inputs];
  return [...npmParts(root, files), ...copiesInThree(root, files), ...compiledParts(build, emscripten)];
}

/** @param {Part[]} parts  @return {string}  The text of THIRD-PARTY-NOTICES.txt. */
export function noticesOf(parts) {
  const notices = parts.map(({ name, version, license, url, where, text }) => {
    const facts = [license, url, where && `in ${where}`].filter(Boolean).join(', ');
    return `${name} ${version} (${facts})\n\n${text.trim()}\n`;
  });
  return `Cagecast contains the following third-party software.\n${rule}${notices.join(rule)}`;
}

/** Packages that files were bundled from. */
function npmParts(root, files) {
  const packages = new Set();
  for (const path of files) {
    const start = path.lastIndexOf('node_modules/');
    if (start < 0) continue;
    const [scope, name] = path.slice(start + 'node_modules/'.length).split('/');
    packages.add(`${path.slice(0, start)}node_modules/${scope.startsWith('@') ? `${scope}/${name}` : scope}`);
  }
  return [...packages].sort().map((path) => {
    const folder = join(root, path);
    const { name, version, license, homepage } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
    const file = readdirSync(folder).find((entry) => /^(licen[cs]e|copying)/i.test(entry));
    const text = file && existsSync(join(folder, file)) ? readFileSync(join(folder, file), 'utf8').trim() : '';
    const purl = `pkg:npm/${name.replace('@', '%40')}@${version}`;
    return { name, version, license, url: homepage, purl, text: text || `Licence: ${license}.` };
  });
}

/** Libraries that three.js has copies of. */
function copiesInThree(root, files) {
  const copies = new Set(files.filter((path) => /three\/examples\/jsm\/libs\//.test(path)));
  return [...copies].map((path) => {
    if (!path.endsWith('/fflate.module.js'))
      throw new Error(`${path} is bundled; wasm/tools/notices.mjs has to name its licence`);
    const [, version] = /^version (\S+)$/m.exec(readFileSync(join(root, path), 'utf8'));
    return {
      name: 'fflate',
      version,
      license: 'MIT',
      url: 'https://101arrowz.github.io/fflate',
      purl: `pkg:npm/fflate@${version}`,
      where: 'three',
      text: 'Copyright (c) 2023 Arjun Barrett. The terms are those of three.',
    };
  });
}

/** What is compiled into the WebAssembly modules, which npm does not know of, and the script around them. */
function compiledParts(build, emscripten) {
  const read = (...path) => readFileSync(join(...path), 'utf8');
  const nanoflann = read(build, 'core/nanoflann/nanoflann.hpp');
  const meshoptimizer = join(build, '_deps/cagecast_meshoptimizer-src');
  const [, mesh] = /MESHOPTIMIZER_VERSION (\d+)/.exec(read(meshoptimizer, 'src/meshoptimizer.h'));
  const [, eigenFolder] = /^EIGEN_INCLUDE_DIR:\w+=(.*)$/m.exec(read(build, 'CMakeCache.txt'));
  const macros = read(eigenFolder, 'Eigen/src/Core/util/Macros.h');
  const eigen = ['WORLD', 'MAJOR', 'MINOR']
    .map((which) => new RegExp(`EIGEN_${which}_VERSION (\\d+)`).exec(macros)[1])
    .join('.');
  const emscriptenVersion = read(emscripten, 'emscripten-version.txt').replaceAll(/["\s]/g, '');
  const musl = read(emscripten, 'system/lib/libc/musl/VERSION').trim();
  return [
    {
      name: 'nanoflann',
      version: '1.4.3', // Its header says 1.4.2.
      license: 'BSD-2-Clause',
      url: 'https://github.com/jlblancoc/nanoflann',
      purl: 'pkg:github/jlblancoc/nanoflann@v1.4.3',
      where: 'the WebAssembly modules',
      text: nanoflann.slice(nanoflann.indexOf('/*'), nanoflann.indexOf('*/') + 2),
    },
    {
      name: 'meshoptimizer',
      version: (mesh / 1000).toFixed(2),
      license: 'MIT',
      url: 'https://github.com/zeux/meshoptimizer',
      purl: `pkg:github/zeux/meshoptimizer@v${(mesh / 1000).toFixed(2)}`,
      where: 'cagecast-cages.wasm',
      text: read(meshoptimizer, 'LICENSE.md'),
    },
    {
      name: 'eigen',
      version: eigen,
      license: 'MPL-2.0',
      url: 'https://eigen.tuxfamily.org',
      purl: `pkg:gitlab/libeigen/eigen@${eigen}`,
      where: 'cagecast-cages.wasm',
      text: "Mozilla Public License 2.0, https://www.mozilla.org/MPL/2.0/. Unchanged; the source is at\nhttps://eigen.tuxfamily.org and in Debian's package libeigen3-dev.",
    },
    {
      name: 'emscripten',
      version: emscriptenVersion,
      license: 'MIT AND Apache-2.0 WITH LLVM-exception',
      url: 'https://emscripten.org',
      purl: `pkg:github/emscripten-core/emscripten@${emscriptenVersion}`,
      where: 'the WebAssembly modules and the scripts that load them',
      text: `Copyright (c) 2010-2022 The Emscripten Authors, and, for its C library musl ${musl},
Copyright (c) 2005-2020 Rich Felker and others.

${kMit}

Its libc++, libc++abi and compiler-rt are those of LLVM, under the Apache License 2.0 with LLVM's exceptions.`,
    },
  ];
}

const kMit = `Permission is hereby granted, free of charge, to any person obtaining a copy
of this software and associated documentation files (the "Software"), to deal
in the Software without restriction, including without limitation the rights
to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
copies of the Software, and to permit persons to whom the Software is
furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all
copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
SOFTWARE.`;
