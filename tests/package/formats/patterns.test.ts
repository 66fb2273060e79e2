// Regular expressions meet text of strangers: each takes time in proportion to it, whatever it is.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { fileKind } from 'cagecast/gltf';

const root = fileURLToPath(new URL('../../..', import.meta.url));
/** What the lint makes of the sources. */
const lint = (name: string) => import(pathToFileURL(join(root, 'wasm/tools/lint', name)).href);
const { listFiles } = (await lint('files.mjs')) as { listFiles(root: string): string[] };
const { patternsIn } = (await lint('patterns.mjs')) as {
  patternsIn(path: string, text: string): { at: string; pattern: string; flags: string }[];
};
const kLength = 4096; // bytes
const kMax = 10_000; // microseconds of CPU

/** Characters that patterns tell from others. */
const kSpecial = [...' \t\n#/\\."()[{<=:,-0aev\xff'];
const single = Array.from({ length: 256 }, (_, code) => String.fromCharCode(code));
const texts = [...single, ...kSpecial.flatMap((one) => kSpecial.map((other) => one + other))].flatMap((part) => {
  const text = part.repeat(kLength / part.length);
  return [text, `${text.slice(1)}!`];
});

/** Whether some text takes it longer than that, each time of a few: once, anything may come between. */
function slowOn(test: (text: string) => void): string | undefined {
  return texts.find((text) =>
    [1, 2, 3, 4].every(() => {
      const { user: before } = process.cpuUsage();
      test(text);
      return process.cpuUsage().user - before > kMax;
    }),
  );
}

const shown = (text: string | undefined): string | undefined =>
  text && JSON.stringify(`${text.slice(0, 4)}…${text.at(-1)}`);

test('what recognises files', () => {
  const beginnings = [
    '',
    '#',
    'ply\n',
    'solid ',
    'o x\n',
    'o \n',
    'mtllib a\n',
    '\xef\xbb\xbf',
    `PK${'a'.repeat(28)}`,
    '<?xml',
  ];
  for (const start of beginnings) {
    const slow = slowOn((text) => fileKind(Buffer.from(start + text, 'latin1')));
    assert.equal(shown(slow), undefined, `after ${JSON.stringify(start)}`);
  }
});

test('each pattern of the package and the page', () => {
  const files = listFiles(root).filter((path) => /^(wasm|web)\/src\/.*\.ts$/.test(path));
  const patterns = files.flatMap((path) => patternsIn(path, readFileSync(join(root, path), 'utf8')));
  assert.ok(patterns.length > 100);
  const slow = patterns.flatMap(({ at, pattern, flags }) => {
    const text = slowOn((text) => text.replace(new RegExp(pattern, flags), ''));
    return text === undefined ? [] : [`${at} /${pattern}/${flags} on ${shown(text)}`];
  });
  assert.deepEqual(slow, []);
});
