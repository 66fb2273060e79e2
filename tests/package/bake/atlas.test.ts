// Textures of several materials in one: the model looks as before, with fewer materials.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { before, test } from 'node:test';
import type { GLTF } from '@gltf-transform/core';
import { init } from 'cagecast';
import { thumbnail } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import { fails, json, ok } from '../../support/command.js';
import { GlbMaker, unpackGlb, validate } from '../../support/gltf.js';
import { islandCage } from '../../support/models';
import { temporaryFolder } from '../../support/temporary.js';
import { picture } from './reference.js';

const { folder } = temporaryFolder('atlas');
const decode = (bytes: Uint8Array) => PNG.sync.read(Buffer.from(bytes));
const pngOf = ({ width, height, data }: { width: number; height: number; data: Uint8Array | Uint8ClampedArray }) =>
  PNG.sync.write(Object.assign(new PNG({ width, height }), { data: Buffer.from(data) }));
/** Soft colours that tell places apart. */
const soft = (size: number, seed: number) =>
  picture(size, (x, y) => [
    128 + 120 * Math.sin(x / 9 + seed),
    128 + 120 * Math.cos(y / 7 + 2 * seed),
    (97 * seed) % 256,
    255,
  ]);

/** What a square has: how its material is, and the corners of its UVs. */
type Square = { material: GLTF.IMaterial; image?: number; low?: number; high?: number };

/** Squares side by side that face +z, each with a material and a texture. @param finish  Adds to the file. */
function squares(list: readonly Square[], finish: (maker: GlbMaker) => void = () => {}): Buffer {
  const maker = new GlbMaker();
  maker.json.materials = [];
  maker.json.images = [48, 96, 64].map((size, i) => ({
    bufferView: maker.view(pngOf(soft(size, i))),
    mimeType: 'image/png' as const,
  }));
  maker.json.textures = maker.json.images.map((_, source) => ({ source }));
  list.forEach(({ material, image, low = 0.1, high = 0.9 }, i) => {
    const x = -0.8 + (1.6 / list.length) * i;
    const [left, right] = [x, x + 1.5 / list.length];
    const number = maker.json.materials!.push({ name: `m${i}`, ...material }) - 1;
    const pbr = {
      ...material.pbrMetallicRoughness,
      ...(image !== undefined && { baseColorTexture: { index: image } }),
    };
    maker.json.materials![number]!.pbrMetallicRoughness = pbr;
    const mesh = maker.mesh(
      {
        positions: Float32Array.from([left, -0.5, 0.8, right, -0.5, 0.8, right, 0.5, 0.8, left, 0.5, 0.8]),
        indices: Uint16Array.of(0, 1, 2, 0, 2, 3),
        uvs: Float32Array.from([low, high, high, high, high, low, low, low]),
      },
      { material: number },
    );
    maker.node({ mesh, name: `square${i}` });
  });
  finish(maker);
  return maker.finish();
}

before(async () => {
  await init();
  process.chdir(folder);
  writeFileSync('cage.glb', (await islandCage(1)).buffer);
  writeFileSync('paint.png', pngOf(picture(32, () => [230, 30, 40, 90])));
});

/** The same with an atlas and without: what is reported, and both files. */
async function baked(file: Buffer, flags = '') {
  writeFileSync('target.glb', file);
  await ok('bake target.glb --cage cage.glb --texture paint.png -o plain.glb');
  const { atlas } = await json<{
    atlas: {
      packed: string[][];
      textures: { slot: string; size: number }[];
      left: { material: string; reason: string }[];
    };
  }>(`bake target.glb --cage cage.glb --texture paint.png --atlas${flags} -o atlas.glb`);
  const [plain, packed] = ['plain.glb', 'atlas.glb'].map((name) => new Uint8Array(readFileSync(name)));
  assert.deepEqual(await validate('atlas.glb'), []);
  return { atlas, plain: plain!, packed: packed!, json: unpackGlb(Buffer.from(packed!)).json };
}

/** Asserts that two files look the same but for the rounding of colours. */
async function alike(a: Uint8Array, b: Uint8Array): Promise<void> {
  const [first, second] = [await thumbnail(a, { decode, size: 128 }), await thumbnail(b, { decode, size: 128 })];
  const most = first.data.reduce((worst, byte, i) => Math.max(worst, Math.abs(byte - second.data[i]!)), 0);
  assert.ok(first.data.some((byte) => byte > 0) && most <= 6, `${most}`);
}

test('materials that differ by textures and factors become one, and look as before', async () => {
  const factor = (...color: number[]) => ({
    pbrMetallicRoughness: { baseColorFactor: color as never, metallicFactor: 0 },
  });
  const { atlas, plain, packed, json } = await baked(
    squares([
      { material: factor(1, 1, 1, 1), image: 0 },
      { material: factor(0.3, 1, 0.6, 1), image: 1 },
      { material: factor(1, 0.5, 1, 1), image: 2 },
      { material: { ...factor(1, 1, 1, 1), alphaMode: 'BLEND' }, image: 2 },
    ]),
  );
  assert.deepEqual(atlas, {
    packed: [['m0', 'm1', 'm2'], ['m3']],
    textures: [{ slot: 'color', size: 256, mimeType: 'image/png' }],
    left: [],
  });
  assert.deepEqual([json.materials!.length, json.textures!.length, json.images!.length], [2, 1, 1]);
  assert.deepEqual(json.materials!.map(({ name }) => name).sort(), ['atlas', 'm3']);
  assert.deepEqual(new Set(json.meshes!.slice(0, 3).map(({ primitives }) => primitives[0]!.material)).size, 1);
  await alike(plain, packed);
});

test('what repeats, glows, or is told apart by extensions keeps its own texture, and its UVs', async () => {
  const { atlas, plain, packed, json } = await baked(
    squares(
      [
        { material: {}, image: 0 },
        { material: {}, image: 1 },
        { material: {}, image: 2, low: -0.5, high: 1.5 },
        { material: {} },
        { material: { emissiveTexture: { index: 0 } }, image: 1 },
        { material: { extensions: { VRMC_materials_mtoon: { specVersion: '1.0' } } }, image: 2 },
        { material: {}, image: 2 },
      ],
      ({ json: file }) => {
        file.extensionsUsed = ['VRMC_materials_mtoon', 'VRMC_vrm'];
        const expressions = { preset: { happy: { materialColorBinds: [{ material: 6, type: 'color' }] } } };
        Object.assign(file, { extensions: { VRMC_vrm: { expressions, meta: { thumbnailImage: 2 } } } });
      },
    ),
  );
  assert.deepEqual(atlas.packed, [['m0', 'm1']]);
  const reasons = Object.fromEntries(atlas.left.map(({ material, reason }) => [material, reason]));
  assert.match(reasons['m2']!, /its UVs lie outside of 0\.\.1/);
  assert.match(reasons['m3']!, /it has no texture/);
  assert.match(reasons['m4']!, /it has a texture that glows/);
  assert.match(reasons['m5']!, /it has VRMC_materials_mtoon/);
  assert.match(reasons['m6']!, /an expression of the avatar changes it/);
  const { VRMC_vrm: vrm } = json.extensions as {
    VRMC_vrm: {
      meta: { thumbnailImage: number };
      expressions: { preset: { happy: { materialColorBinds: [{ material: number }] } } };
    };
  };
  assert.equal(json.materials![vrm.expressions.preset.happy.materialColorBinds[0].material]!.name, 'm6');
  assert.ok(json.images![vrm.meta.thumbnailImage]);
  await alike(plain, packed);
});

test('normals, and occlusion, roughness and metalness are packed in the same way, where a material has none, too', async () => {
  const rough = { index: 2 };
  const { atlas, json } = await baked(
    squares([
      {
        material: {
          normalTexture: { index: 1 },
          occlusionTexture: rough,
          pbrMetallicRoughness: { metallicRoughnessTexture: rough, roughnessFactor: 0.5 },
        },
        image: 0,
      },
      { material: { pbrMetallicRoughness: { roughnessFactor: 0.2, metallicFactor: 0.4 } }, image: 1 },
    ]),
    ' 512',
  );
  assert.deepEqual(atlas.packed, [['m0', 'm1']]);
  assert.deepEqual(
    atlas.textures.map(({ slot, size }) => [slot, size]),
    [
      ['color', 512],
      ['normal', 512],
      ['orm', 512],
    ],
  );
  const { bin } = unpackGlb(readFileSync('atlas.glb'));
  const imageOf = (info: { index: number } | undefined) => {
    const view = json.bufferViews![json.images![json.textures![info!.index]!.source!]!.bufferView!]!;
    return decode(bin!.subarray(view.byteOffset ?? 0, (view.byteOffset ?? 0) + view.byteLength));
  };
  const [material] = json.materials!;
  const [normal, orm] = [
    imageOf(material!.normalTexture),
    imageOf(material!.pbrMetallicRoughness!.metallicRoughnessTexture),
  ];
  /** The texels at the middle of a square. */
  const middles = json.meshes!.map(({ primitives }) => {
    const { bufferView, byteOffset = 0 } = json.accessors![primitives[0]!.attributes['TEXCOORD_0']!]!;
    const start = (json.bufferViews![bufferView!]!.byteOffset ?? 0) + byteOffset;
    const uvs = new Uint16Array(Uint8Array.from(bin!.subarray(start, start + 16)).buffer);
    const at = (k: number) => Math.floor((512 * (uvs[k]! + uvs[4 + k]!)) / 2 / 65535);
    return 4 * (at(1) * 512 + at(0));
  });
  const own = soft(64, 2);
  const expected = [...own.data.subarray(4 * (32 * 64 + 32), 4 * (32 * 64 + 32) + 3)];
  const found = [...orm.data.subarray(middles[0]!, middles[0]! + 3)];
  const scaled = [expected[0]!, expected[1]! * 0.5, expected[2]!];
  scaled.forEach((value, k) => assert.ok(Math.abs(value - found[k]!) < 14, `${found} ${scaled}`));
  assert.deepEqual([...orm.data.subarray(middles[1]!, middles[1]! + 3)], [255, 51, 102]);
  assert.deepEqual([...normal.data.subarray(middles[1]!, middles[1]! + 3)], [128, 128, 255]);
  assert.equal(material!.pbrMetallicRoughness!.roughnessFactor, 1);
});

test('a VRM 0, and a single texture, stay as they are, and it says so', async () => {
  const list: Square[] = [
    { material: {}, image: 0 },
    { material: {}, image: 1 },
  ];
  const vrm = squares(list, ({ json: file }) => {
    file.extensionsUsed = ['VRM'];
    Object.assign(file, { extensions: { VRM: { meta: { texture: 1 } } } });
  });
  writeFileSync('target.glb', vrm);
  assert.match(
    await ok('bake target.glb --cage cage.glb --texture paint.png --atlas -o out.glb'),
    /textures are not packed: .*\nnot packed: "m0", "m1": VRM may refer to it/,
  );
  writeFileSync('target.glb', squares(list.slice(0, 1)));
  assert.match(
    await ok('bake target.glb --cage cage.glb --texture paint.png --atlas -o out.glb'),
    /textures are not packed: fewer than two/,
  );
  await fails(2, /--atlas needs an OUT\.glb/, 'bake target.glb --cage cage.glb --texture paint.png --atlas -o out.png');
  await fails(
    2,
    /not a whole number of texels within 64\.\.8192/,
    'bake target.glb --cage cage.glb --texture paint.png --atlas 7 -o out.glb',
  );
});
