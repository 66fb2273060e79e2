// Checks the pages of the documentation: links and paths lead somewhere, the two first pages stay short, and words that were given
// up do not come back, neither here nor where users read them.
import { existsSync, readFileSync } from 'node:fs';
import { dirname, join, normalize } from 'node:path';

/** Read first, so they have to be short. */
const kMaxLines = { 'README.md': 150, 'CONTRIBUTING.md': 150 };

/** Given up for a word of the field, which is beside it. */
const kWords = {
  'rims?': 'boundary loop',
  'vote[sr]?|voters|voting': 'interior samples',
  'UV atlas(es)?': 'UV charts', // an atlas is a texture of several materials
  'sunk\\w*Area': 'depthWeightedArea',
  copyOf: 'twinOf',
  'bared\\w*': 'hole contents',
  '(?<=\\.)restores': 'recovery',
  farRims: 'farLoops',
};

/** Where users read. */
const isForUsers = (path) =>
  /^(README|CONTRIBUTING|SECURITY)\.md$|^docs\/|^examples\/(node|three|native)\/|^core\/include\/|^wasm\/src\/(api|generated|cli)\/|^web\/index\.html$/.test(
    path,
  ) && /\.(md|hpp|def|ts|js|cpp|html)$/.test(path);

/** The anchors that GitHub makes of a page's headings. */
const anchorsOf = (text) =>
  new Set(
    [...text.matchAll(/^#+ (.*)$/gm)].map(([, heading]) =>
      heading
        .replace(/`|\*/g, '')
        .toLowerCase()
        .replace(/[^\p{L}\p{N} _-]/gu, '')
        .replaceAll(' ', '-'),
    ),
  );

function checkLinks(root, path, text) {
  const problems = [];
  for (const [, link] of text.matchAll(/\]\(([^)\s]+)\)/g)) {
    if (/^[a-z]+:/.test(link)) continue;
    const [file, anchor] = link.split('#');
    const to = file ? normalize(join(dirname(path), file)) : path;
    if (!existsSync(join(root, to))) problems.push(`${path} links to ${link}, which is not there`);
    else if (anchor && !anchorsOf(readFileSync(join(root, to), 'utf8')).has(anchor))
      problems.push(`${path} links to ${link}, but there is no such heading`);
  }
  return problems;
}

/** Paths are named between backticks, from the root, or from core/src, and may end in a folder or have a star. */
function checkPaths(files, path, text) {
  const problems = [];
  const folders = new Set(files.flatMap((file) => [dirname(file), dirname(dirname(file))]));
  for (const [, name] of text.matchAll(
    /`((?:core|wasm|web|tests|bench|examples|docs|input|steps|seams|clip|base|geometry)\/[\w./*-]*)`/g,
  )) {
    const wanted = name.replace(/\/$/, '');
    const pattern = new RegExp(`^(core/src/)?${wanted.replace(/[.]/g, '\\.').replaceAll('*', '[^/]*')}$`);
    if (!files.some((file) => pattern.test(file)) && ![...folders].some((folder) => pattern.test(folder)))
      problems.push(`${path} names ${name}, which is not there`);
  }
  return problems;
}

/**
 * @param {string} root  The repository, or a tree like it.
 * @param {string[]} files  Paths from there.
 * @return {string[]}  What is wrong.
 */
export function checkDocs(root, files) {
  const problems = [];
  const read = (path) => readFileSync(join(root, path), 'utf8');
  for (const [path, most] of Object.entries(kMaxLines)) {
    const lines = files.includes(path) ? read(path).split('\n').length - 1 : 0;
    if (lines > most) problems.push(`${path} has ${lines} lines; at most ${most} are allowed`);
  }
  for (const path of files.filter((file) => file.endsWith('.md'))) {
    const text = read(path);
    problems.push(...checkLinks(root, path, text), ...checkPaths(files, path, text));
  }
  for (const path of files.filter(isForUsers)) {
    for (const [word, instead] of Object.entries(kWords)) {
      const found = read(path).match(new RegExp(`\\b(${word})\\b`, 'i'));
      if (found) problems.push(`${path} says "${found[0]}"; say ${instead}`);
    }
  }
  return problems;
}
