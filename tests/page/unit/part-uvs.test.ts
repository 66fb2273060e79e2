import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Vector2 } from 'three';
import { PartUvs } from '../../../web/src/tools/paint/part-uvs';

/** Squares side by side in the texture, two triangles each; of every one, the mesh that it belongs to. */
function squares(...meshes: number[]): PartUvs {
  const uvs = meshes.flatMap((_, i) => {
    const [left, right] = [i / meshes.length, (i + 1) / meshes.length];
    return [left, 0, right, 0, right, 1, left, 1];
  });
  const shown = {
    target: {
      mesh: { indices: Uint32Array.from(meshes.flatMap((_, i) => [0, 1, 2, 0, 2, 3].map((at) => 4 * i + at))) },
    },
    projection: {
      uvs: Float32Array.from(uvs),
      cornerUvs: new Float32Array(),
      segments: Uint32Array.from(meshes.flatMap((_, i) => [i, i, i, i])),
      segmentStats: meshes.map((group) => ({ group })),
    },
  };
  return new PartUvs(shown, { cosmeticTriangles: new Uint8Array(2 * meshes.length).fill(1) });
}

const columns = (uvs: ArrayLike<number>): number[] =>
  [...new Set(Array.from(uvs).filter((_, i) => i % 2 === 0))].sort((a, b) => a - b);

test('a sticker keeps to the mesh that it is on, with all its pieces', () => {
  const jacketAndNeck = squares(0, 1, 0);
  const jacket = jacketAndNeck.at(new Vector2(0.1, 0.4))!;
  assert.deepEqual(
    columns(jacket.uvs).map((u) => Math.round(3 * u)),
    [0, 1, 2, 3],
  );
  assert.equal(jacket.uvs.length, 24, 'both pieces of it');
  assert.equal(jacketAndNeck.at(new Vector2(0.9, 0.9)), jacket, 'the same object on its other piece');
  const neck = jacketAndNeck.at(new Vector2(1.5, -0.7))!;
  assert.deepEqual(
    columns(neck.uvs).map((u) => Math.round(3 * u)),
    [1, 2],
    'in the texture as it repeats',
  );
});

test('a model of one mesh bounds no sticker, nor does a spot that takes no paint', () => {
  assert.equal(squares(0, 0).at(new Vector2(0.2, 0.2)), undefined);
  assert.equal(squares(0, 1).at(new Vector2(Number.NaN, 0.2)), undefined);
});
