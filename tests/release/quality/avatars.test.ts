import assert from 'node:assert/strict';
import { test } from 'node:test';
import { avatars, type Face } from '../../../bench/avatars/labels.js';
import { frameOf, scoreOf } from '../../../bench/avatars/score.js';

test('each avatar has a hash, which decides its half, and a face with its left on its left', () => {
  const all = avatars();
  assert.equal(new Set(all.map(({ file }) => file)).size, all.length);
  assert.equal(new Set(all.map(({ sha256 }) => sha256)).size, all.length);
  for (const { file, sha256, commit, half, face } of all) {
    assert.match(`${commit} ${sha256}`, /^[\da-f]{40} [\da-f]{64}$/, file);
    assert.equal(half, Number.parseInt(sha256[0]!, 16) % 2 === 0 ? 'open' : 'held', file);
    if (face) assert.ok(frameOf(face).unit > 0 && Math.abs(frameOf(face).z.y) < 0.9, file);
  }
});

/** A square in the plane of a face, of two triangles around a spot, with 6 corners. */
const square = (x: number, y: number, half: number, z = 0): number[] =>
  [-1, -1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1].flatMap((side, i) =>
    i % 2 === 0 ? [x + side * half] : [y + side * half, z],
  );

test('holes off by a tenth are seen, depth counts a quarter, and painted eyes and clothes are shares', () => {
  const face: Face = { eyeL: [0.5, 1, 0], eyeR: [-0.5, 1, 0], mouth: [0, 0, 0], by: 'hand' };
  const model = {
    positions: Float32Array.from([...square(0.5, 1, 0.1), ...square(0, 0.5, 0.1), ...square(0, -3, 0.1)]),
    indices: Uint32Array.from({ length: 18 }, (_, i) => i),
    groups: Uint32Array.from({ length: 18 }, (_, i) => Math.floor(i / 6)),
    names: [['eye'], ['skin'], ['shirt']],
  };
  const corners = [square(0.6, 1, 0.05), square(-0.5, 1, 0.05), square(0, 0, 0.05, 0.2)];
  const cage = {
    positions: Float32Array.from(corners.flat()),
    indices: Uint32Array.from({ length: 18 }, (_, i) => i),
    uvs: new Float32Array(36),
    landmarks: {},
    holes: { eye_left: [0, 1, 2, 5], eye_right: [6, 7, 8, 11], mouth: [12, 13, 14, 17] },
  };
  const zones = [0, 0, 0, 2, 2, 2, 0, 0, 0, 1, 0, 1, 2, 2, 2, 0, 0, 0];
  const score = scoreOf(cage, model, zones, face, { eyes: ['eye'], clothes: ['shirt'] });
  const rounded = Object.fromEntries(Object.entries(score).map(([name, value]) => [name, Number(value.toFixed(6))]));
  assert.deepEqual(rounded, { clothes: 0.5, face: 0.1, eyes: 0.5, bare: 0 });
});
