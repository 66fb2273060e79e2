// Paint that is carried from one cage to another.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { type CagecastError, init, type Mesh, type TransferResult, transfer } from 'cagecast';
import { fitCage, loadTemplate, makeCage } from 'cagecast/cages';
import { type Baked, type Image, relayPaint } from 'cagecast/engines';
import { cageModel, cageTemplate } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import { fails, json } from '../../support/command.js';
import { glbOf } from '../../support/gltf.js';
import { temporaryFolder } from '../../support/temporary.js';
import { ball, join3d, modelFolders, within } from '../scenes.js';
import { picture } from './reference.js';

const { folder } = temporaryFolder('relay');
before(init);

const kSize = 512;
/** A paint in which each place has a colour of its own. */
const places = (): Image => picture(kSize, (x, y) => [x / 2, y / 2, 128, 255]);

/** The texel at the middle of a triangle. */
function texelAt({ width, height }: Image, { cornerUvs }: TransferResult, triangle: number): [number, number] {
  const middle = (k: number) => [0, 2, 4].reduce((sum, at) => sum + cornerUvs[6 * triangle + at + k]! / 3, 0);
  const within = (at: number, size: number) => Math.min(size - 1, Math.max(0, Math.floor(at * size)));
  return [within(middle(0), width), within(middle(1), height)];
}
const colorAt = ({ data, width }: Image, [x, y]: readonly [number, number]) =>
  data.subarray(4 * (y * width + x), 4 * (y * width + x) + 4);
const apart = (a: ArrayLike<number>, b: ArrayLike<number>) =>
  Math.max(...[0, 1, 2, 3].map((k) => Math.abs(a[k]! - b[k]!)));

/** A colour that is more than this off is another one. */
const kTolerance = 12;

/**
 * Of the triangles that both cages paint, the share in whose middle `to` with the relayed paint shows another colour than `from` with
 * its own, and the share that shows none.
 */
function compare(image: Image, relayed: Image, from: TransferResult, to: TransferResult) {
  const isShared = (t: number) => from.cosmeticTriangles[t] === 1 && to.cosmeticTriangles[t] === 1;
  const shared = [...from.cosmeticTriangles.keys()].filter(isShared);
  let [wrong, clear] = [0, 0];
  for (const t of shared) {
    const shown = colorAt(relayed, texelAt(relayed, to, t));
    if (shown[3]! < 128) ++clear;
    else if (apart(shown, colorAt(image, texelAt(image, from, t))) > kTolerance) ++wrong;
  }
  assert.ok(shared.length > 100);
  return { wrong: wrong / shared.length, clear: clear / shared.length };
}

/** The painted figures with a cage of their own, and the template for them. */
const heads = modelFolders().filter((one) => /samples\/human$|makehuman_head$/.test(one));

describe('on heads', () => {
  for (const one of heads)
    test(`a made cage and a fitted template show what the model's own cage shows, and the other way round: ${one}`, async () => {
      const read = (name: string) => new NodeIO().read(`${one}/${name}.glb`);
      const model = await cageModel(await read('target'));
      const cages = {
        own: cageTemplate(await read('cage')),
        made: await makeCage(model, { voxels: 80 }),
        fitted: (await fitCage(await loadTemplate('human-head'), model)).cage,
      };
      const results = Object.fromEntries(Object.entries(cages).map(([name, cage]) => [name, transfer(cage, model)]));
      const image = places();
      const ways = [
        ['own', 'made'],
        ['own', 'fitted'],
        ['made', 'fitted'],
        ['fitted', 'made'],
      ] as const;
      for (const [a, b] of ways) {
        const relayed = relayPaint(image, cages[a], cages[b], model);
        assert.deepEqual([relayed.width, relayed.height], [kSize, kSize]);
        const { wrong, clear } = compare(image, relayed, results[a]!, results[b]!);
        // Holes are filled less far where the first cage is smaller: on lips, nothing is shown then.
        assert.ok(wrong < 0.004 && clear < 0.007, `from ${a} to ${b}: ${wrong} differ, ${clear} show nothing`);
      }
    });
});

const unit = (radius: number, rings: number) => ball([0, 0, 0], () => radius, rings, 2 * rings);
/** The same cage in another layout: turned by a quarter, and smaller. */
const turned = <M extends Mesh>(cage: M): M => ({
  ...cage,
  uvs: cage.uvs!.map((_, i, uvs) => (i % 2 === 0 ? 0.05 + 0.9 * (1 - uvs[i + 1]!) : 0.05 + 0.9 * uvs[i - 1]!)),
});
const skin = unit(1, 24);
const whole = unit(1.05, 24);
/** Below a height: a hole at the equator, away from the seam and the poles of the layout. */
const below = (limit: number) => (_x: number, y: number) => y < limit;
/** The triangles of which the middle is somewhere. */
function trianglesWhere({ positions, indices }: Mesh, isThere: (x: number, y: number, z: number) => boolean): number[] {
  const middle = (t: number) =>
    [0, 1, 2].map((k) => [0, 1, 2].reduce((sum, c) => sum + positions[3 * indices[3 * t + c]! + k]! / 3, 0));
  return [...Array(indices.length / 3).keys()].filter((t) => isThere(...(middle(t) as [number, number, number])));
}
/** The colours at the middle of triangles of which a result paints some. */
const shownBy = (relayed: Baked, result: TransferResult, triangles: readonly number[]) =>
  triangles
    .filter((t) => result.cosmeticTriangles[t] === 1)
    .map((t) => [...colorAt(relayed, texelAt(relayed, result, t))]);
const red = picture(64, () => [200, 30, 40, 255]);

describe('holes', () => {
  test('where only the first cage has a hole, the paint beside it goes on, but not far', () => {
    const onBelt = trianglesWhere(skin, (_x, _y, z) => Math.abs(z) < 0.9);
    const result = transfer(turned(whole), skin);
    const shown = (limit: number, triangles: readonly number[]) =>
      shownBy(relayPaint(red, within(whole, below(limit)), turned(whole), skin, { gutter: 0 }), result, triangles);
    for (const color of shown(1.045, onBelt)) assert.deepEqual(color, [200, 30, 40, 255]);
    const [near, far] = [below(0.4), (_x: number, y: number) => y > 0.8].map((is) => trianglesWhere(skin, is));
    for (const color of shown(
      0.5,
      near!.filter((t) => onBelt.includes(t)),
    ))
      assert.equal(color[3], 255);
    for (const color of shown(0.5, far!)) assert.equal(color[3], 0);
  });

  test('where only the second one has a hole, nothing of the model is lost: the other way round, it is as before', () => {
    const open = within(turned(whole), below(0.9));
    const image = places();
    const there = relayPaint(image, whole, open, skin);
    const { wrong, clear } = compare(image, there, transfer(whole, skin), transfer(open, skin));
    assert.ok(wrong + clear < 0.001, `${wrong}, ${clear}`);
  });

  test('a part of its own that shows through a hole of the first cage stays transparent', () => {
    const eye = ball([0, 0.92, 0], () => 0.2, 20, 40);
    const model = join3d(skin, eye);
    const eyed = ball(
      [0, 0, 0],
      (phi, theta) => 1.05 + 0.15 * Math.exp(-8 * ((phi - Math.PI / 2) ** 2 + (theta - Math.PI / 2) ** 2)),
      16,
      32,
    );
    const from = within(eyed, below(1.02));
    const to = turned(eyed);
    const result = transfer(to, model);
    const ofEye = trianglesWhere(model, (_x, y) => y > 1.07);
    const colors = shownBy(relayPaint(red, from, to, model, { width: 512 }), result, ofEye);
    assert.ok(colors.length > 20);
    const clear = colors.filter((color) => color[3] === 0).length;
    assert.ok(clear === colors.length, `${clear} of ${colors.length}`);
  });
});

test('a cage in another layout shows the same picture turned; normals turn with it', () => {
  const size = 256;
  const relayed = relayPaint(places(), whole, turned(whole), skin, { width: size });
  assert.equal(relayed.height, size);
  const lean = picture(16, () => [218, 128, 218, 255]); // to the right, as u grows
  const normals = relayPaint(lean, whole, turned(whole), skin, { kind: 'normal', width: size });
  assert.equal(normals.kind, 'normal');
  const sums = [0, 0, 0, 0];
  normals.mask.forEach((share, i) => {
    if (share < 255) return;
    for (let k = 0; k < 3; ++k) sums[k]! += normals.data[4 * i + k]!;
    ++sums[3]!;
  });
  assert.ok(sums[3]! > size ** 2 / 2);
  // u grows where v of the new layout grows: down, against the bitangent.
  const mean = sums.map((sum) => sum / sums[3]!);
  assert.ok(Math.max(...[128, 38, 218].map((value, k) => Math.abs(value - mean[k]!))) < 8, mean.join());
});

test('rules of the transfers hold for both', () => {
  const masks = {
    vertices: new Int8Array(skin.positions.length / 3).map((_, v) => (skin.positions[3 * v]! > 0 ? -1 : 0)),
  };
  const relayed = relayPaint(red, whole, turned(whole), skin, { transfer: { masks }, gutter: 0 });
  const all = relayPaint(red, whole, turned(whole), skin, { gutter: 0 });
  const count = ({ mask }: Baked) => mask.filter((share) => share > 0).length;
  assert.ok(count(relayed) < 0.6 * count(all) && count(relayed) > 0.3 * count(all));
});

test('errors name the argument', () => {
  const bare = { positions: whole.positions, indices: whole.indices };
  const far = { ...whole, positions: whole.positions.map((x) => x + 100) };
  const cases: [call: () => unknown, code: string, argument: string | undefined, says: RegExp][] = [
    [
      () => relayPaint({ ...red, width: 3 }, whole, whole, skin),
      'badArgument',
      'image',
      /^image\.data has 16384 bytes, not 4 for each of 3 × 64/,
    ],
    [() => relayPaint(red, bare, whole, skin), 'missingUvs', 'from', /^from\.uvs is missing/],
    [() => relayPaint(red, whole, bare, skin), 'missingUvs', 'to', /^to\.uvs is missing/],
    [() => relayPaint(red, whole, undefined as never, skin), 'badArgument', 'to', /^to is undefined/],
    [
      () => relayPaint(red, whole, whole, { ...skin, indices: Uint32Array.of(0, 1, 99999) }),
      'indexOutOfRange',
      'model',
      /^model\.indices\[2\]/,
    ],
    [
      () => relayPaint(red, whole, far, skin),
      'badArgument',
      'model',
      /^model has no triangle that both cages paint: of its \d+, from paints \d+, to paints 0/,
    ],
    [
      () => relayPaint(red, whole, whole, skin, { wrap: 'clamp' } as never),
      'badOption',
      'options',
      /^options\.wrap is not an option; there are: width, height, kind, gutter, transfer/,
    ],
    [
      () => relayPaint(red, whole, whole, skin, { transfer: { threshold: 2 } }),
      'badOption',
      'options',
      /^options\.transfer\.threshold/,
    ],
    [() => relayPaint(red, whole, whole, skin, { width: 0 }), 'badArgument', 'options', /^options\.width is 0/],
  ];
  for (const [call, code, argument, says] of cases)
    assert.throws(call, (error: CagecastError) => {
      assert.deepEqual([error.code, error.fn, error.argument], [code, 'relayPaint', argument], error.message);
      assert.match(error.reason, says);
      return true;
    });
});

test('the command writes the same as a PNG', async () => {
  const image = places();
  const path = (name: string) => `${folder}/${name}`;
  writeFileSync(path('ball.glb'), glbOf({ ...skin, uvs: undefined }));
  writeFileSync(path('from.glb'), glbOf(whole));
  writeFileSync(path('to.glb'), glbOf(turned(whole)));
  const png = Object.assign(new PNG({ width: kSize, height: kSize }), { data: Buffer.from(image.data) });
  writeFileSync(path('paint.png'), PNG.sync.write(png));
  const line = `relay ${path('ball.glb')} --cage ${path('from.glb')} --texture ${path('paint.png')} --to ${path('to.glb')}`;
  const { width, height, triangles } = await json<{ width: number; height: number; triangles: Record<string, number> }>(
    `${line} --size 128 -o ${path('out.png')}`,
  );
  assert.deepEqual([width, height, triangles.painted === triangles.shared], [128, 128, true]);
  const { data } = relayPaint(image, whole, turned(whole), skin, { width: 128 });
  assert.deepEqual(new Uint8Array(PNG.sync.read(readFileSync(path('out.png'))).data), new Uint8Array(data));
  await fails(2, /to\.glb would overwrite|paint\.png would overwrite/, `${line} -o ${path('paint.png')}`);
  writeFileSync(path('far.glb'), glbOf({ ...whole, positions: whole.positions.map((x) => x + 100) }));
  await fails(
    1,
    /ball\.glb: model has no triangle that both cages paint/,
    `${line.replace('to.glb', 'far.glb')} -o ${path('no.png')}`,
  );
});
