// Paints that are drawn for any cage.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { type Cage, loadTemplate, type TemplateName } from 'cagecast/cages';
import { draw } from '../../../web/src/loading/drawn/draw';
import { drawnPaints } from '../../../web/src/loading/drawn/names';
import { patterns } from '../../../web/src/loading/drawn/patterns';
import { portrait } from '../../../web/src/loading/drawn/portrait';

const kSize = 64;
const kFine = 256; // where single spots count
const templates = Object.fromEntries(
  await Promise.all(
    (['human-head', 'human-body', 'animal-head', 'car'] as const).map(async (name) => [name, await loadTemplate(name)]),
  ),
) as Record<TemplateName, Cage>;
const head = templates['human-head'];
const alphas = (pixels: Uint8ClampedArray): Uint8ClampedArray => pixels.filter((_, at) => at % 4 === 3);

/** Says whether the middle of a texel is in a triangle of a cage's UVs, by the signs of three areas. */
function coverOf({ uvs, indices }: Cage): (x: number, y: number) => boolean {
  const corners = Array.from(indices, (v) => [uvs[2 * v]! * kSize - 0.5, uvs[2 * v + 1]! * kSize - 0.5] as const);
  return (x, y) => {
    for (let i = 0; i < corners.length; i += 3) {
      const side = (k: number): number => {
        const [[px, py], [qx, qy]] = [corners[i + k]!, corners[i + ((k + 1) % 3)]!];
        return (qx - px) * (y - py) - (qy - py) * (x - px);
      };
      const [a, b, c] = [side(0), side(1), side(2)];
      if ((a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0)) return true;
    }
    return false;
  };
}

/** The texel at a landmark of the head, which is on a vertex of it or near one. */
function atLandmark(pixels: Uint8ClampedArray, name: string): number[] {
  const mark = head.landmarks[name]!;
  let [nearest, least] = [0, Infinity];
  for (let v = 0; v < head.positions.length / 3; ++v) {
    const distance = Math.hypot(...mark.map((x, k) => x - head.positions[3 * v + k]!));
    if (distance < least) [nearest, least] = [v, distance];
  }
  const [x, y] = [0, 1].map((k) => Math.floor(head.uvs[2 * nearest + k]! * kFine));
  return [...pixels.subarray(4 * (y! * kFine + x!), 4 * (y! * kFine + x!) + 4)];
}

test('each paint of the list has a pattern, and each pattern is in it', () => {
  assert.deepEqual(drawnPaints.map(({ name }) => name).sort(), Object.keys(patterns).sort());
});

test('a texture covers each texel of the cage, and little more', () => {
  for (const cage of [head, templates.car]) {
    const found = alphas(draw(patterns['camouflage']!, cage, kSize));
    const isCovered = coverOf(cage);
    let [covered, others] = [0, 0];
    for (let texel = 0; texel < found.length; ++texel) {
      const isIn = isCovered(texel % kSize, Math.floor(texel / kSize));
      if (isIn) assert.equal(found[texel], 255, `texel ${texel}`);
      covered += Number(isIn);
      others += Number(!isIn && found[texel]! > 0);
    }
    assert.ok(covered > 0.2 * found.length && others < covered, `${covered} and ${others}`);
  }
});

test('a paint is the same each time, wherever the model is and however large, and no two are the same', () => {
  const moved = {
    ...head,
    positions: head.positions.map((x, i) => 4 * x + (i % 3)),
    landmarks: Object.fromEntries(
      Object.entries(head.landmarks).map(([name, at]) => [name, at.map((x, k) => 4 * x + k)]),
    ),
  };
  const seen = new Set<string>();
  for (const [name, pattern] of Object.entries(patterns)) {
    const pixels = draw(pattern, head, kSize);
    assert.deepEqual(draw(pattern, head, kSize), pixels);
    const elsewhere = draw(pattern, moved, kSize);
    const different = pixels.filter((byte, i) => Math.abs(byte - elsewhere[i]!) > 24).length;
    assert.ok(different < 0.01 * pixels.length, `${name}: ${different} bytes`);
    seen.add(Buffer.from(pixels).toString('base64'));
  }
  assert.equal(seen.size, drawnPaints.length);
});

test('faces are painted by their landmarks: lips, eyes and what stays bare', () => {
  const [make, skull] = ['stage-make-up', 'skull'].map((name) => draw(patterns[name]!, head, kFine));
  const [red, green, , alpha] = atLandmark(make!, 'lip_lower');
  assert.ok(alpha! > 150 && red! > 2 * green!, 'the lips are red');
  for (const bare of ['forehead', 'occiput', 'ear_top_left', 'chin']) assert.equal(atLandmark(make!, bare)[3], 0, bare);
  for (const side of ['left', 'right']) {
    const socket = atLandmark(skull!, `eye_outer_${side}`);
    assert.ok(Math.max(...socket.slice(0, 3)) < 60, `${socket}`);
  }
  assert.ok(Math.min(...atLandmark(skull!, 'forehead').slice(0, 3)) > 120, 'and bone is pale');
});

test('a portrait shows the cage from the front: a face fills it, and all of anything else is seen', () => {
  for (const [name, cage] of Object.entries(templates)) {
    const seen = alphas(portrait(patterns['scales']!, cage, 48));
    const share = seen.filter((alpha) => alpha === 255).length / seen.length;
    assert.ok(share > (/head/.test(name) ? 0.4 : 0.1), `${name}: ${share}`);
    if (!/head|body/.test(name))
      for (const corner of [0, 47, 48 * 47, 48 * 48 - 1]) assert.equal(seen[corner], 0, `${name}, ${corner}`);
  }
});
