import assert from 'node:assert/strict';
import { test } from 'node:test';
import { damageOf } from '../../../web/src/loading/image-damage';

/** A model whose images are all damaged. */
const damaged = (...names: string[]) => ({
  parser: {
    json: {
      images: names.map((name) => ({ name, uri: `${name}.png` })),
      textures: [...names, ...names].map((_, n) => ({ source: n % names.length })),
    },
    getDependencies: async () => [...names, ...names].map(() => null),
  },
});

test('the first damaged image is named, and the number of the others', async () => {
  const told = (...names: string[]) => damageOf(damaged(...names) as never, async () => new ArrayBuffer(0));
  assert.equal(await told(), undefined);
  assert.equal(await told('skin'), 'image “skin” cannot be shown: it is empty. White is shown in its place.');
  assert.match((await told('skin', 'eye', 'hair'))!, /^image “skin” cannot be shown \(nor can 2 more\): it is empty\./);
});
