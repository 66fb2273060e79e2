import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { CagecastError } from 'cagecast';
import { forPeople, reasonOf } from '../../../web/src/state/wording';
import { inRepository } from '../../support/site';

test('findings are said in the words of the page: parts, the model', () => {
  assert.equal(forPeople('Half of the target is bare'), 'Half of the model is bare');
  assert.equal(
    forPeople('Of “Target_Body” and "segment 2" of the target'),
    'Of “Target_Body” and "segment 2" of the model',
  );
  assert.equal(forPeople('Of 2 segments with the shape of "eye", 1 is'), 'Of 2 parts with the shape of "eye", 1 is');
});

test('errors are said without the function that threw them', () => {
  assert.equal(reasonOf(new CagecastError('badModel', 'makeCage', 'model is too thin')), 'model is too thin');
  assert.equal(reasonOf(new Error('face.png: not an image')), 'face.png: not an image');
});

test('nothing that the package finds has words of programs', () => {
  for (const file of ['segments', 'placement', 'holes', 'inside', 'normals', 'topology', 'uv']) {
    const source = readFileSync(inRepository('wasm/src/inspect', `${file}.ts`), 'utf8');
    const texts = [...source.matchAll(/(?:sentence|advice):\s*[`']([^`']*)/g)];
    assert.ok(texts.length > 0, `no sentence or advice found in ${file}.ts`);
    for (const [, text] of texts) assert.doesNotMatch(text!, /--|refineCage|\block/, file);
  }
});
