import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { forPeople } from '../../web/src/scene/wording';
import { inRepository } from '../support/site';

test('findings are told in the words of the page: parts, no flags, no functions', () => {
  for (const [text, told] of [
    [
      'If that is wrong, override it (--keep "l-eye"), or widen or close the holes over it.',
      'If that is wrong, override it, or widen or close the holes over it.',
    ],
    ['Of 2 segments with the shape of "eye", 1 is painted', 'Of 2 parts with the shape of "eye", 1 is painted'],
    [
      'less than the threshold of 0.5, but a lock excludes it',
      'less than the threshold of 0.5, but you chose to exclude it',
    ],
    [
      'is in pieces that lie too far apart for one cage: make one for each, or raise the option closing',
      'is in pieces that lie too far apart for one cage: open each as a model of its own, or switch off those that are not painted, in the options of Make a cage',
    ],
    ['Move it by about (0, 1), or call refineCage of cagecast/cages.', 'Move it by about (0, 1).'],
  ] as const)
    assert.equal(forPeople(text), told);
});

test('nothing that the package finds keeps words of programs on the page', () => {
  for (const file of ['segments', 'placement', 'holes', 'inside', 'normals', 'topology', 'uv']) {
    const source = readFileSync(inRepository('wasm/src/inspect', `${file}.ts`), 'utf8');
    const texts = [...source.matchAll(/(?:sentence|advice):\s*[`']([^`']*)/g)];
    assert.ok(texts.length > 0, `no sentence or advice found in ${file}.ts`);
    for (const [, text] of texts)
      assert.doesNotMatch(
        forPeople(text!.replace(/\$\{option\(\w+\)\}/, '--keep "eye"')),
        /segment|--|refineCage/,
        file,
      );
  }
});
