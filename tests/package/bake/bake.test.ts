import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { before, test } from 'node:test';
import { CagecastError, init, type Mesh, type TransferResult, transfer } from 'cagecast';
import { bakeTexture, cageTexture, type Image, layOver, resize } from 'cagecast/engines';
import { PNG } from 'pngjs';
import { fill, type Layout } from '#bake';
import { readPlain } from '../scenes.js';
import { picture, randomNumbers, smoothImage, texelsOf } from './reference';

before(init);

/** Triangles anywhere in both textures; every fifth is not painted, every ninth has no area. */
function randomLayouts(seed: number, reach = 1): Layout[] {
  const random = randomNumbers(seed);
  return ['first', 'second'].map((name) => {
    const count = 12;
    const to = new Float64Array(6 * count);
    for (let t = 0; t < count; ++t) {
      const [u, v] = [reach * random(), reach * random()];
      for (let k = 0; k < 6; ++k) to[6 * t + k] = (k % 2 ? v : u) + 0.4 * (random() - 0.5);
      if (t % 9 === 4) to.copyWithin(6 * t + 2, 6 * t, 6 * t + 2);
    }
    const from = Float64Array.from({ length: 6 * count }, () => random());
    return { name, to, from, painted: Uint8Array.from({ length: count }, (_, t) => Number(t % 5 !== 2)) };
  });
}

const texel = ({ data, width }: Image, x: number, y: number): number[] => [
  ...data.subarray(4 * (y * width + x), 4 * (y * width + x) + 4),
];
const apart = (a: readonly number[], b: readonly number[]): number =>
  Math.max(...a.map((value, k) => Math.abs(value - b[k]!)));

/** Compares every texel with the reference, but for those on edges. */
function compare(layouts: Layout[], image: Image, size: number, far = 0): void {
  const isCoarse = image.width < size;
  const baked = fill('test', layouts, image, { width: size, gutter: 0, wrap: far > 0 ? 'repeat' : 'clamp' });
  let [painted, clear, worst] = [0, 0, 0];
  texelsOf(layouts, image, { size, samples: isCoarse ? 2 : 4, isCoarse, far }).forEach((expected, i) => {
    if (!expected) return;
    const found = [...baked.data.subarray(4 * i, 4 * i + 4)];
    if (expected[3] === 0) {
      ++clear;
      assert.deepEqual(found, [0, 0, 0, 0], `texel ${i}`);
    } else if (expected[3]! > 8) {
      ++painted;
      worst = Math.max(worst, apart(found, expected));
    }
  });
  assert.ok(painted > 50 && (clear > 100 || far > 0), `${painted} texels are painted, ${clear} are clear`);
  assert.ok(worst <= 1.5, `off by up to ${worst}`);
}

for (const seed of [1, 2, 3]) {
  test(`a texture is what a search among all triangles finds, texel by texel: scene ${seed}`, () => {
    const layouts = randomLayouts(seed);
    for (const isOpaque of [true, false]) {
      compare(layouts, smoothImage(20, 15, isOpaque), 64);
      compare(layouts, smoothImage(600, 400, isOpaque), 40);
    }
  });
}

test('UVs beyond 0 to 1 repeat', () => {
  const layouts = randomLayouts(7, 1.5);
  compare(layouts, smoothImage(20, 20), 40, 2);
  compare(layouts, smoothImage(400, 400), 32, 2);
});

/** A square of two triangles in the whole texture, `n` by `n`, beside which nothing is. */
const square = (at = 0, size = 1): Mesh & { uvs: Float32Array } => ({
  positions: new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]),
  indices: new Uint32Array([0, 1, 2, 0, 2, 3]),
  uvs: Float32Array.from([0, 0, 1, 0, 1, 1, 0, 1], (value) => at + size * value),
});

const resultOf = (mesh: Mesh, uvs = mesh.uvs!): Pick<TransferResult, 'uvs' | 'cornerUvs' | 'cosmeticTriangles'> => ({
  uvs: Float32Array.from(uvs),
  cornerUvs: new Float32Array(0),
  cosmeticTriangles: new Uint8Array(mesh.indices.length / 3).fill(1),
});

test('a square with the same UVs in both textures copies the paint, byte for byte', () => {
  const mesh = square();
  const image = smoothImage(64, 64, false);
  const { data, mask } = bakeTexture(mesh, resultOf(mesh), image, { width: 64 });
  for (let at = 0; at < data.length; at += 4)
    assert.ok(
      image.data[at + 3]! < 8 || apart([...data.subarray(at, at + 4)], [...image.data.subarray(at, at + 4)]) <= 1,
    );
  assert.ok(mask.every((share) => share === 255));
});

test('the gutter has the colour of the edge; beyond it, and in the mask, nothing is', () => {
  const mesh = square(0.25, 0.5);
  const red = { width: 1, height: 1, data: new Uint8Array([230, 30, 40, 255]) };
  const baked = bakeTexture(mesh, resultOf(mesh), red, { width: 64, gutter: 5 });
  for (let y = 0; y < 64; ++y)
    for (let x = 0; x < 64; ++x) {
      const beyond = Math.max(16 - x, x - 47, 16 - y, y - 47);
      assert.deepEqual(texel(baked, x, y), beyond <= 5 ? [230, 30, 40, 255] : [0, 0, 0, 0], `${x}, ${y}`);
      assert.equal(baked.mask[64 * y + x], beyond <= 0 ? 255 : 0);
    }
});

test('what must not be painted keeps its texels clear, though its neighbours are painted', () => {
  const mesh = square();
  const result = resultOf(mesh);
  result.cosmeticTriangles[0] = 0;
  const baked = bakeTexture(mesh, result, smoothImage(8, 8), { width: 64 });
  for (let y = 0; y < 64; ++y)
    for (let x = 0; x < 64; ++x) {
      if (x > y) assert.equal(texel(baked, x, y)[3], 0);
      if (x < y) assert.equal(texel(baked, x, y)[3], 255);
    }
});

test('mirrored halves that share texels are reported, with the names of the parts; parts alone are not', () => {
  const mesh = square();
  const half = [0, 0, 0.5, 0, 0.5, 1, 0, 1];
  const uvs = Float32Array.from([...half, ...half.map((value, k) => (k % 2 ? value : 0.5 - value))]);
  const both = { indices: new Uint32Array([...mesh.indices, ...mesh.indices.map((v) => v + 4)]), uvs };
  const parts = ['left', 'right'].map((name, p) => ({ name, firstTriangle: 2 * p, triangleCount: 2 }));
  const result = { ...resultOf(mesh), uvs, cosmeticTriangles: new Uint8Array(4).fill(1) };
  const { overlap } = bakeTexture(both, result, smoothImage(16, 16), { width: 64, parts });
  assert.deepEqual(overlap, { texels: 1, lost: 0.5, parts: ['left', 'right'] });
  const alone = bakeTexture(both, result, smoothImage(16, 16), { width: 64, parts: parts.slice(0, 1) });
  assert.deepEqual(alone.overlap, { texels: 0, lost: 0, parts: [] });
  assert.equal(texel(alone, 50, 32)[3], 0, 'the other half of the texture is empty');
});

test('a normal map is turned with the UVs: a quarter turn, a mirror, and back', () => {
  const mesh = square();
  const turned = Float32Array.from([1, 0, 1, 1, 0, 1, 0, 0]); // the tangent is where −v was
  const mirrored = Float32Array.from([1, 0, 0, 0, 0, 1, 1, 1]);
  const normals = { width: 1, height: 1, data: new Uint8Array([204, 128, 230, 255]) }; // leans to +x
  const leaning = (uvs: Float32Array): number[] =>
    texel(bakeTexture({ ...mesh, uvs }, resultOf(mesh), normals, { width: 16, kind: 'normal' }), 8, 8);
  assert.ok(apart(leaning(mesh.uvs), [204, 128, 230, 255]) <= 2, String(leaning(mesh.uvs)));
  assert.ok(apart(leaning(mirrored), [51, 128, 230, 255]) <= 2, String(leaning(mirrored)));
  assert.ok(apart(leaning(turned), [128, 51, 230, 255]) <= 2, String(leaning(turned)));
  const there = bakeTexture({ ...mesh, uvs: turned }, resultOf(mesh), normals, { width: 16, kind: 'normal' });
  const back = cageTexture({ ...mesh, uvs: turned }, resultOf(mesh), there, { width: 16, kind: 'normal' });
  assert.ok(apart(texel(back, 8, 8), [204, 128, 230, 255]) <= 2);
});

test('a texel at a border shows what its triangle shows there, not what lies beyond', () => {
  const reddish = picture(64, (x) => (x < 48 ? [230, 30, 40, 255] : [20, 40, 250, 255]));
  // Of the second texel of the narrow rectangle, 0.4 is covered; the middle of the texel would be blue.
  const rectangle = (left: number, right: number) => [left, 0, right, 0, right, 0.5, left, 0.5];
  const uvs = Float32Array.from([...rectangle(0, 0.5), ...rectangle(0.75, 0.75 + 1.4 / 64)]);
  const indices = new Uint32Array([0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7]);
  const result = {
    uvs: Float32Array.from([...rectangle(0, 0.5), ...rectangle(0.5, 0.74)]),
    cornerUvs: new Float32Array(0),
    cosmeticTriangles: new Uint8Array(4).fill(1),
  };
  const baked = bakeTexture({ indices, uvs }, result, reddish, { width: 64, gutter: 0 });
  assert.equal(texel(baked, 49, 3)[3], 255);
  for (let i = 0; i < 64 * 64; ++i)
    if (baked.mask[i] !== 0) assert.deepEqual([...baked.data.subarray(4 * i, 4 * i + 4)], [230, 30, 40, 255]);
});

test('on the way back, what must not be painted does not bleed in', () => {
  const mesh = square();
  const result = resultOf(mesh);
  result.cosmeticTriangles[0] = 0;
  const atlas = picture(64, (x, y) => (x < y ? [230, 30, 40, 255] : x > y ? [20, 40, 250, 0] : [125, 35, 145, 128]));
  for (const width of [20, 64, 150]) {
    const back = cageTexture(mesh, result, atlas, { width });
    assert.ok(back.mask.reduce((count, share) => count + Number(share === 255), 0) > 0.4 * width ** 2, `${width}`);
    back.mask.forEach((share, i) => {
      if (share > 0) assert.deepEqual([...back.data.subarray(4 * i, 4 * i + 4)], [230, 30, 40, 255], `texel ${i}`);
    });
  }
});

test('on the way back, what is painted is seen though it shares its texels with what must not be', () => {
  const half = (left: number) => [left, 0, left + 0.5, 0, left + 0.5, 1, left, 1];
  const indices = Uint32Array.from({ length: 18 }, (_, i) => 4 * Math.floor(i / 6) + [0, 1, 2, 0, 2, 3][i % 6]!);
  const uvs = Float32Array.from([...half(0), ...half(0), ...half(0.5)]);
  const result = { uvs, cornerUvs: new Float32Array(0), cosmeticTriangles: Uint8Array.of(0, 0, 1, 1, 1, 1) };
  const image = smoothImage(64, 64);
  const { data } = cageTexture({ indices, uvs }, result, image, { width: 64 });
  const worst = apart([...data], [...image.data]);
  assert.ok(worst <= 1, `off by up to ${worst}`);
});

test('on the way back, a pattern that repeats is seen as it is', () => {
  const mesh = square();
  const stripes = picture(16, (x) => (x < 8 ? [230, 30, 40, 255] : [20, 40, 250, 255]));
  const uvs = mesh.uvs.map((value) => 40 * value);
  const result = { ...resultOf(mesh), cosmeticTriangles: Uint8Array.of(0, 1) };
  const { data, mask } = cageTexture({ ...mesh, uvs }, result, stripes, { width: 320 });
  const seen = new Set([...mask.keys()].filter((i) => mask[i] === 255).map((i) => data[4 * i]! > 125));
  assert.equal(seen.size, 2);
});

test('other values than colours are averaged as they are', () => {
  const mesh = square();
  const image = { width: 2, height: 1, data: new Uint8Array([0, 40, 0, 255, 200, 40, 0, 255]) };
  const middle = (kind: 'color' | 'data') =>
    texel(bakeTexture(mesh, resultOf(mesh), image, { width: 3, height: 1, gutter: 0, kind }), 1, 0)[0]!;
  assert.ok(Math.abs(middle('data') - 100) <= 1);
  assert.ok(middle('color') > 130, 'colours are mixed in linear light');
});

test('what is baked lies over an image of the same size; alpha and bytes beyond are kept', () => {
  const mesh = square(0.25, 0.5);
  const red = { width: 1, height: 1, data: new Uint8Array([230, 30, 40, 255]) };
  const base = smoothImage(64, 64, false);
  const baked = bakeTexture(mesh, resultOf(mesh), red, { width: 64, gutter: 0 });
  const laid = layOver(base, baked);
  for (let y = 0; y < 64; ++y)
    for (let x = 0; x < 64; ++x) {
      const inside = Math.min(x, y) >= 16 && Math.max(x, y) < 48;
      const before = texel(base, x, y);
      assert.deepEqual(texel(laid, x, y), inside ? [230, 30, 40, before[3]] : before, `${x}, ${y}`);
    }
  assert.throws(() => layOver(smoothImage(32, 64), baked), /image has 32 × 64 texels, what was baked 64 × 64/);
});

test('an image is resized by the areas that pixels cover', () => {
  const image = {
    width: 4,
    height: 2,
    data: new Uint8Array(32).map((_, at) => (at % 4 === 3 ? 255 : at % 16 < 8 ? 10 : 210)),
  };
  const small = resize(image, 2, 1);
  assert.ok(small.data[0]! < 60 && small.data[4]! > 160, String(small.data));
  assert.equal(resize(image, 4, 2), image);
  assert.deepEqual(resize(resize(image, 64, 64), 64, 64).width, 64);
});

test('there and back, from the cage to the lizard’s atlas and to the cage, the paint differs little on the mean', async () => {
  const [cage, whole] = await Promise.all(
    ['cage', 'target'].map((name) => readPlain(`examples/samples/lizard/${name}.glb`)),
  );
  // Its skin alone, which is the first part.
  const indices = Uint32Array.from(whole!.indices).filter((_, i, all) => whole!.groups![all[i - (i % 3)]!] === 0);
  const target = { ...whole!, indices };
  const result = transfer(cage!, target);
  const side = 256;
  const read = (name: string): Image =>
    resize(PNG.sync.read(readFileSync(`examples/samples/lizard/paint-${name}.png`)), side, side);
  // War paint and stripes are as fine as the texels of the atlas.
  const paints: [Image, number][] = [
    [smoothImage(side, side), 0.9],
    [read('war-paint'), 3.8],
    [read('tiger'), 4.3],
  ];
  for (const [paint, most] of paints) {
    const atlas = bakeTexture(target, result, paint, { width: side });
    const back = cageTexture(target, result, atlas, { width: side });
    const before = resize(paint, side, side);
    let [sum, covered] = [0, 0];
    back.mask.forEach((share, i) => {
      if (share !== 255) return;
      ++covered;
      // By what is seen: premultiplied.
      for (let k = 0; k < 4; ++k) {
        const seen = ({ data }: Image) => (k === 3 ? data[4 * i + 3]! : (data[4 * i + k]! * data[4 * i + 3]!) / 255);
        sum += Math.abs(seen(back) - seen(before)) / 4;
      }
    });
    assert.ok(covered > 0.3 * side * side && sum / covered <= most, `${sum / covered} over ${covered} texels`);
    // The left eye is a hole of the cage.
    assert.deepEqual(texel(back, 93, 196), [0, 0, 0, 0]);
  }
});

test('what cannot be baked is one clear error', () => {
  const mesh = square();
  const [result, paint] = [resultOf(mesh), smoothImage(4, 4)];
  const cases: [() => unknown, RegExp][] = [
    [() => bakeTexture({ indices: mesh.indices }, result, paint), /^bakeTexture: target has no UVs/],
    [
      () => bakeTexture({ ...mesh, uvs: mesh.uvs.map((u, i) => (i === 5 ? NaN : u)) }, result, paint),
      /^bakeTexture: target\.uvs\[5\] is NaN/,
    ],
    [
      () => bakeTexture({ ...mesh, indices: new Uint32Array([0, 1, 9]) }, result, paint),
      /target\.indices\[2\] = 9 is out of range \(4 UVs\)/,
    ],
    [
      () => bakeTexture(mesh, { ...result, cosmeticTriangles: new Uint8Array(7) }, paint),
      /result\.cosmeticTriangles has 7 entries, the target needs 2/,
    ],
    [
      () => bakeTexture(mesh, result, { ...paint, data: new Uint8Array(5) }),
      /image\.data has 5 bytes, not 4 for each of 4 × 4/,
    ],
    [
      () => bakeTexture(mesh, result, paint, { kind: 'hue' as 'color' }),
      /options\.kind is "hue"; there are: color, data, normal/,
    ],
    [() => bakeTexture(mesh, result, paint, { wrap: 'fold' as 'clamp' }), /options\.wrap is "fold"; there are/],
    [() => bakeTexture(mesh, result, paint, { gutter: -1 }), /options\.gutter is -1/],
    [
      () => bakeTexture(mesh, result, paint, { size: 2048 } as object),
      /^bakeTexture: options\.size is not an option; there are: width, height, kind, gutter, wrap, parts$/,
    ],
    [() => cageTexture(mesh, result, paint, { size: 64 } as object), /^cageTexture: options\.size is not an option/],
    [
      () => bakeTexture(mesh, result, paint, { parts: [{ name: 'x', firstTriangle: 1, triangleCount: 2 }] }),
      /options\.parts\[0\] is not/,
    ],
    [
      () => bakeTexture({ ...mesh, positions: new Float32Array(3) }, result, paint, { kind: 'normal' }),
      /target\.positions has 3 numbers/,
    ],
    [
      () => bakeTexture({ ...mesh, uvs: mesh.uvs.map((u) => 1e6 * u) }, result, paint),
      /triangle 0 of "target": a triangle extends over more than 64 textures/,
    ],
    [() => cageTexture({ indices: mesh.indices }, result, paint), /^cageTexture: target has no UVs/],
    [() => cageTexture(null as unknown as typeof mesh, result, paint), /^cageTexture: target is null/],
    [() => cageTexture({} as typeof mesh, result, paint), /^cageTexture: target\.indices is undefined/],
    [() => cageTexture(mesh, result, paint, null as unknown as object), /^cageTexture: options is null/],
  ];
  for (const size of [0, 1e5, NaN, 2.5, -1])
    cases.push([
      () => bakeTexture(mesh, result, paint, { width: size }),
      new RegExp(`options\\.width is ${size}, not a whole number of texels from 1 to 8192`),
    ]);
  for (const [call, message] of cases)
    assert.throws(call, (error: unknown) => {
      assert.ok(error instanceof CagecastError, String(error));
      assert.match(error.message, message);
      assert.equal(error.argument, /^(target|result|image|options)\b/.exec(error.reason)?.[0], error.message);
      return true;
    });
});
