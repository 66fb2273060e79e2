// What holds for any texture that is filled, and for any arguments.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { CagecastError } from 'cagecast';
import { type Image, layOver, resize } from 'cagecast/engines';
import fc from 'fast-check';
import { fill, type Layout } from '#bake';

const { CAGECAST_RUNS = 60, CAGECAST_SEED = 1 } = process.env;
const runs = { numRuns: Number(CAGECAST_RUNS), seed: Number(CAGECAST_SEED) };

const image = fc
  .tuple(fc.integer({ min: 1, max: 9 }), fc.integer({ min: 1, max: 9 }))
  .chain(([width, height]) =>
    fc
      .uint8Array({ minLength: 4 * width * height, maxLength: 4 * width * height })
      .map((data): Image => ({ width, height, data })),
  );

/** A grid in which triangles share corners and edges, or any place near the texture. */
const uv = fc.oneof(
  { weight: 4, arbitrary: fc.integer({ min: -2, max: 10 }).map((value) => value / 8) },
  { weight: 1, arbitrary: fc.double({ min: -1, max: 2, noNaN: true }) },
);
const layout = fc.integer({ min: 0, max: 6 }).chain((count) => {
  const uvs = fc.array(uv, { minLength: 6 * count, maxLength: 6 * count }).map((all) => Float64Array.from(all));
  const painted = fc.uint8Array({ min: 0, max: 1, minLength: count, maxLength: count });
  return fc.record({ name: fc.constantFrom('first', 'second'), to: uvs, from: uvs, painted });
});
const size = fc.integer({ min: 1, max: 24 });
const wrap = fc.constantFrom('repeat' as const, 'mirror' as const, 'clamp' as const);

test('a filled texture has its size, paint only within triangles and their gutter, and is the same again', () => {
  fc.assert(
    fc.property(fc.array(layout, { maxLength: 3 }), image, size, size, wrap, (layouts, paint, width, height, wrap) => {
      const options = { width, height, wrap, gutter: 0 };
      const baked = fill('test', layouts as Layout[], paint, options);
      assert.equal(baked.data.length, 4 * width * height);
      assert.equal(baked.mask.length, width * height);
      // Without a gutter, what may not be painted is clear.
      baked.mask.forEach((share, i) => {
        if (share === 0) assert.deepEqual([...baked.data.subarray(4 * i, 4 * i + 4)], [0, 0, 0, 0]);
      });
      assert.ok(baked.overlap.lost >= 0 && baked.overlap.lost <= 1 && baked.overlap.texels <= 1);
      assert.deepEqual(fill('test', layouts as Layout[], paint, options), baked);
      const wide = fill('test', layouts as Layout[], paint, { ...options, gutter: 1 });
      assert.deepEqual(wide.mask, baked.mask, 'a gutter may not be painted');
      const base = resize(paint, width, height);
      const over = layOver(base, baked);
      assert.equal(over.data.length, baked.data.length);
      for (let at = 0; at < over.data.length; at += 4) {
        assert.equal(over.data[at + 3], base.data[at + 3], 'the alpha is kept');
        if (baked.data[at + 3] === 0)
          assert.deepEqual([...over.data.subarray(at, at + 4)], [...base.data.subarray(at, at + 4)]);
      }
    }),
    runs,
  );
});

test('any arguments give a clear error or a texture', () => {
  const junk = fc.oneof(fc.constantFrom(NaN, -1, 0, 0.5, 1e9, 'x', null, [], {}, 3n), fc.anything({ maxDepth: 1 }));
  const names = ['width', 'height', 'kind', 'gutter', 'wrap', 'data'] as const;
  const anything = fc.record(Object.fromEntries(names.map((name) => [name, junk])), { requiredKeys: [] });
  fc.assert(
    fc.property(fc.oneof(anything, junk), fc.oneof(anything, image, junk), (options, given) => {
      for (const call of [
        () => fill('test', [], given as Image, options as object),
        () => resize(given as Image, (options as { width: number })?.width, 4),
      ]) {
        try {
          call();
        } catch (error) {
          assert.ok(error instanceof CagecastError, `not a CagecastError: ${(error as Error)?.stack ?? String(error)}`);
          assert.match(error.message, /^[^\n]{5,400}$/);
        }
      }
    }),
    { ...runs, numRuns: 4 * runs.numRuns },
  );
});
