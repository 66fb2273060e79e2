// Writes the core as two files, for programs that are built without CMake:
//
//   node core/amalgamate.mjs FOLDER [nanoflann.hpp]     FOLDER/cagecast.hpp and FOLDER/cagecast.cpp, and cagecast_c.h for C

import { copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const core = fileURLToPath(new URL('.', import.meta.url));
const read = (path) => readFileSync(join(core, path), 'utf8');

const kHeaders = ['transfer', 'split', 'clip'].map((name) => `cagecast/${name}.hpp`);
const kNanoflann = ['/usr/include', '/usr/local/include', '/opt/homebrew/include'].map(
  (path) => `${path}/nanoflann.hpp`,
);

const [folder, nanoflann = kNanoflann.find(existsSync)] = process.argv.slice(2);
if (folder === undefined || nanoflann === undefined) {
  console.error('usage: node core/amalgamate.mjs FOLDER [nanoflann.hpp]     (Debian, Ubuntu: libnanoflann-dev)');
  process.exit(1);
}

const seen = new Set();

/** A file with all that it includes in its place: headers once, lists (.def) each time. */
function inlined(path) {
  if (seen.has(path)) return '';
  if (!path.endsWith('.def')) seen.add(path);
  return expanded(read(existsSync(join(core, 'include', path)) ? `include/${path}` : `src/${path}`));
}

function expanded(text) {
  return text
    .replace(/^#pragma once\n+/m, '')
    .replace(/^#include "(.+)".*\n/gm, (_, path) => inlined(path))
    .replace(/^#include <nanoflann\.hpp>\n/m, () => withoutWarnings(expanded(readFileSync(nanoflann, 'utf8'))));
}

/** Code of others, which a compiler need not warn of. Clang takes pragmas of GCC. */
function withoutWarnings(text) {
  const ignored = ['-Wconversion', '-Wsign-conversion', '-Wshadow'].map(
    (flag) => `#pragma GCC diagnostic ignored "${flag}"\n`,
  );
  return `#pragma GCC diagnostic push\n${ignored.join('')}${text}#pragma GCC diagnostic pop\n`;
}

const version = /project\(cagecast VERSION (\S+)/.exec(read('../CMakeLists.txt'))[1];
const sources = /set\(CAGECAST_SOURCES\n([\s\S]*?)\)/.exec(read('CMakeLists.txt'))[1].trim().split(/\s+/);
const licence = read('../LICENSE').trim().replace(/^/gm, '// ').replace(/ +$/gm, '');
const title = `// Cagecast ${version}, in two files: cagecast.hpp and cagecast.cpp. Made by core/amalgamate.mjs.\n//\n${licence}\n\n`;

mkdirSync(folder, { recursive: true });
writeFileSync(join(folder, 'cagecast.hpp'), `${title}#pragma once\n\n${kHeaders.map(inlined).join('')}`);
copyFileSync(join(core, 'include/cagecast/cagecast_c.h'), join(folder, 'cagecast_c.h'));
writeFileSync(
  join(folder, 'cagecast.cpp'),
  `${title}#include "cagecast.hpp"

#ifdef __FAST_MATH__
#error "Compile cagecast.cpp without -ffast-math and with -ffp-contract=off: every build gives the same bits."
#endif

${sources.map((path) => expanded(read(path))).join('')}`,
);
