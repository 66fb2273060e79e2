// Pictures of models: by a reference that looks up each sample on its own, and as the command writes them.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { after, test } from 'node:test';
import type { GLTF } from '@gltf-transform/core';
import type { CagecastError } from 'cagecast';
import { paintGlb, type ThumbnailOptions, thumbnail } from 'cagecast/gltf';
import { terminate } from 'cagecast/worker';
import { PNG } from 'pngjs';
import { fails, json, ok, run } from '../../support/command.js';
import { GlbMaker, glbOf, unpackGlb } from '../../support/gltf.js';
import { ball } from '../scenes.js';
import { inRepository, png, workplace, write, writeChanged } from './workplace.js';

const { target } = workplace('thumbnail');
after(terminate);

const decode = (bytes: Uint8Array) => PNG.sync.read(Buffer.from(bytes));
const draw = (bytes: Uint8Array, options: ThumbnailOptions = {}) => thumbnail(bytes, { decode, ...options });
const kSize = 32;
/** Of what is framed, on all sides. */
const kMargin = 1.06;

type Quad = { z?: number; half?: number; uvs?: number[]; material?: GLTF.IMaterial; colors?: number[] };

const square = (half: number, z: number): Float32Array =>
  Float32Array.from([-half, -half, z, half, -half, z, half, half, z, -half, half, z]);

/** A file of squares that face +z. @param finish  Adds to it. */
function quads(list: readonly Quad[], finish: (maker: GlbMaker) => void = () => {}): Uint8Array {
  const maker = new GlbMaker();
  maker.json.materials = [];
  for (const { z = 0, half = 1, uvs = [0, 1, 1, 1, 1, 0, 0, 0], material = {}, colors } of list) {
    const number = maker.json.materials.push(material) - 1;
    const shape = {
      positions: square(half, z),
      indices: Uint16Array.of(0, 1, 2, 0, 2, 3),
      uvs: Float32Array.from(uvs),
    };
    const mesh = maker.mesh(shape as never, { material: number });
    if (colors)
      maker.json.meshes[mesh]!.primitives[0]!.attributes['COLOR_0'] = maker.accessor(
        Float32Array.from(colors),
        colors.length === 16 ? 'VEC4' : 'VEC3',
      );
    maker.node({ mesh, name: `quad${mesh}` });
  }
  finish(maker);
  return maker.finish();
}

/** An image of random colours, the same each time. */
function noise(width: number, height: number, alpha = (_: number) => 255): PNG {
  const image = new PNG({ width, height });
  let seed = 7;
  for (let i = 0; i < image.data.length; ++i) {
    seed = (Math.imul(seed, 1103515245) + 12345) >>> 0;
    image.data[i] = i % 4 === 3 ? alpha((i - 3) / 4) : seed >>> 24;
  }
  return image;
}

const textured = (image: PNG, sampler: GLTF.ISampler) => (maker: GlbMaker) => {
  maker.json.samplers = [sampler];
  maker.json.images = [{ bufferView: maker.view(PNG.sync.write(image)), mimeType: 'image/png' }];
  maker.json.textures = [{ source: 0, sampler: 0, name: 'skin' }];
};

const linear = (byte: number) => (byte <= 10.31 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);
const byteOf = (x: number) => 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
type Color = [number, number, number, number];

/** A texel by its wrap modes, in linear light. */
function texel({ width, height, data }: PNG, x: number, y: number, wraps: readonly number[]): Color {
  const place = (at: number, length: number, wrap: number): number => {
    if (wrap === 33071) return Math.min(length - 1, Math.max(0, at));
    let to = at;
    while (to < 0 || to >= (wrap === 33648 ? 2 : 1) * length)
      to += (to < 0 ? 1 : -1) * (wrap === 33648 ? 2 : 1) * length;
    return to < length ? to : 2 * length - 1 - to;
  };
  const at = 4 * (place(y, height, wraps[1]!) * width + place(x, width, wraps[0]!));
  return [linear(data[at]!), linear(data[at + 1]!), linear(data[at + 2]!), data[at + 3]! / 255];
}

function bilinear(image: PNG, u: number, v: number, wraps: readonly number[]): Color {
  const [x, y] = [u * image.width - 0.5, v * image.height - 0.5];
  const [left, top] = [Math.floor(x), Math.floor(y)];
  const out: Color = [0, 0, 0, 0];
  for (const dx of [0, 1])
    for (const dy of [0, 1]) {
      const weight = (dx ? x - left : 1 - x + left) * (dy ? y - top : 1 - y + top);
      texel(image, left + dx, top + dy, wraps).forEach((value, k) => (out[k]! += weight * value));
    }
  return out;
}

/** The picture of a square of side 2 whose spots have colours. @param colorAt  By x and y, each −1..1; y grows upwards. */
function reference(colorAt: (x: number, y: number) => Color): number[] {
  const out: number[] = [];
  for (let i = 0; i < kSize * kSize; ++i) {
    const sum: Color = [0, 0, 0, 0];
    for (const [dx, dy] of [
      [0.25, 0.25],
      [0.75, 0.25],
      [0.25, 0.75],
      [0.75, 0.75],
    ] as const) {
      const x = (((i % kSize) + dx) / kSize - 0.5) * 2 * kMargin;
      const y = (0.5 - (Math.floor(i / kSize) + dy) / kSize) * 2 * kMargin;
      if (Math.abs(x) > 1 || Math.abs(y) > 1) continue;
      const [r, g, b, a] = colorAt(x, y);
      [r, g, b].forEach((value, k) => (sum[k]! += value * a));
      sum[3] += a;
    }
    out.push(...(sum[3] > 0 ? [0, 1, 2].map((k) => byteOf(sum[k]! / sum[3])) : [0, 0, 0]), (255 * sum[3]) / 4);
  }
  return out;
}

/** Asserts that a picture is what it should be, within the rounding of samples to bytes. */
function near(data: ArrayLike<number>, expected: readonly number[], within = 1.6): void {
  assert.equal(data.length, expected.length);
  const bad = expected.findIndex((value, i) => !(Math.abs(data[i]! - value) <= within));
  assert.equal(bad, -1, `pixel ${Math.floor(bad / 4)}, channel ${bad % 4}: ${data[bad]}, not ${expected[bad]}`);
}

const pixel = (data: ArrayLike<number>, x = 0.5, y = 0.5, size = kSize): number[] => {
  const at = 4 * (Math.floor(y * size) * size + Math.floor(x * size));
  return [data[at]!, data[at + 1]!, data[at + 2]!, data[at + 3]!];
};

const uvs = [-0.7, 1.6, 1.9, 1.6, 1.9, -0.8, -0.7, -0.8];
for (const wraps of [
  [10497, 10497],
  [33071, 33648],
  [33648, 33071],
])
  for (const transform of [undefined, { offset: [0.2, -0.1], rotation: 0.6, scale: [1.5, 0.7] }])
    test(`a textured square, wrapped by ${wraps}${transform ? ' and moved' : ''}, is sampled as the format says`, async () => {
      const image = noise(8, 4);
      const info = { index: 0, ...(transform && { extensions: { KHR_texture_transform: transform } }) };
      const material = { pbrMetallicRoughness: { baseColorTexture: info, baseColorFactor: [0.5, 1, 0.25, 0.1] } };
      const bytes = quads(
        [{ uvs, material: material as GLTF.IMaterial }],
        textured(image, { wrapS: wraps[0], wrapT: wraps[1] } as GLTF.ISampler),
      );
      const { data, undecoded } = await draw(bytes, { size: kSize });
      assert.deepEqual(undecoded, []);
      near(
        data,
        reference((x, y) => {
          let [u, v] = [-0.7 + 1.3 * (x + 1), 1.6 - 1.2 * (y + 1)];
          if (transform) {
            const { offset, rotation, scale } = transform;
            const [su, sv] = [u * scale[0]!, v * scale[1]!];
            u = Math.cos(rotation) * su + Math.sin(rotation) * sv + offset[0]!;
            v = -Math.sin(rotation) * su + Math.cos(rotation) * sv + offset[1]!;
          }
          const [r, g, b] = bilinear(image, u, v, wraps);
          return [0.5 * r, g, 0.25 * b, 1];
        }),
      );
    });

const plain = (color: number[], more: Partial<GLTF.IMaterial> = {}): GLTF.IMaterial => ({
  pbrMetallicRoughness: { baseColorFactor: color as never },
  ...more,
});
const [red, green] = [
  [1, 0, 0, 1],
  [0, 1, 0, 1],
];

test('what is cut out by its alpha is not there; what is blended is, in linear light, once on every pixel', async () => {
  const image = noise(4, 4, (i) => [0, 90, 160, 255][i % 4]!);
  const info = { pbrMetallicRoughness: { baseColorTexture: { index: 0 } } };
  const spot = (x: number, y: number) => bilinear(image, (x + 1) / 2, (1 - y) / 2, [33071, 33071]);
  const sampler = { wrapS: 33071, wrapT: 33071 } as const;
  const masked = await draw(
    quads([{ material: { ...info, alphaMode: 'MASK', alphaCutoff: 0.4 } }], textured(image, sampler)),
    { size: kSize },
  );
  near(
    masked.data,
    reference((x, y) => {
      const [r, g, b, a] = spot(x, y);
      return a >= 0.4 ? [r, g, b, 1] : [0, 0, 0, 0];
    }),
  );
  const blended = await draw(quads([{ material: { ...info, alphaMode: 'BLEND' } }], textured(image, sampler)), {
    size: kSize,
  });
  near(blended.data, reference(spot), 3);
  const over = await draw(
    quads(
      [{ z: 0.1, material: { ...info, alphaMode: 'BLEND' } }, { material: plain([0.2, 0.4, 0.6, 1]) }],
      textured(image, sampler),
    ),
    { size: kSize },
  );
  near(
    over.data,
    reference((x, y) => {
      const [r, g, b, a] = spot(x, y);
      return [r * a + 0.2 * (1 - a), g * a + 0.4 * (1 - a), b * a + 0.6 * (1 - a), 1];
    }),
  );
});

test('what is blended lies over what is farther away, in whatever order the file has it', async () => {
  const half = (color: number[]) => plain([...color, 0.5], { alphaMode: 'BLEND' });
  const list: Quad[] = [
    { z: 0.1, material: half([1, 0, 0]) },
    { z: 0, material: half([0, 0, 1]) },
  ];
  const [a, b] = [await draw(quads(list)), await draw(quads([...list].reverse()))];
  assert.deepEqual(a.data, b.data);
  const expected = [byteOf(0.5 / 0.75), 0, byteOf(0.25 / 0.75), 255 * 0.75];
  near(pixel(a.data, 0.5, 0.5, 256), expected);
  // Where triangles meet, too.
  const colors = new Set(
    Array.from({ length: 200 }, (_, i) => String(pixel(a.data, 0.1 + i / 250, 0.9 - i / 250, 256))),
  );
  assert.equal(colors.size, 1);
});

test('the nearer surface is seen, single sides from their front only, mirrored nodes as they are', async () => {
  const list: Quad[] = [
    { z: 0.2, material: plain(red) },
    { z: 0, material: plain(green, { doubleSided: true }) },
  ];
  for (const order of [list, [...list].reverse()]) {
    assert.deepEqual(pixel((await draw(quads(order), { size: kSize })).data), [255, 0, 0, 255]);
    assert.deepEqual(pixel((await draw(quads(order), { size: kSize, view: 'back' })).data), [0, 255, 0, 255]);
  }
  const single = quads([{ material: plain(red) }]);
  assert.ok((await draw(single, { view: 'back' })).data.every((byte) => byte === 0));
  const mirrored = quads([{ material: plain(red) }], (maker) => (maker.json.nodes[0]!.scale = [-1, 1, 1]));
  assert.deepEqual(pixel((await draw(mirrored, { size: kSize })).data), [255, 0, 0, 255]);
});

test('colours of vertices tint; hidden nodes and cages are left out; a background lies behind', async () => {
  const colors = [1, 0.5, 0.25].flatMap((x) => [x, x, x, x]);
  const tinted = quads([
    { colors: Array.from({ length: 12 }, (_, i) => colors[4 * (i % 3)]!), material: plain([1, 1, 1, 1]) },
  ]);
  near(pixel((await draw(tinted, { size: kSize })).data), [1, 0.5, 0.25].map(byteOf).concat(255));
  const bytes = quads(
    [{ material: plain(red) }, { z: 1, material: plain(green) }, { z: 2, material: plain(green) }],
    ({ json }) => {
      json.nodes[1]!.extensions = { KHR_node_visibility: { visible: false } };
      json.nodes[2]!.name = 'Head_OuterCage';
    },
  );
  const { data } = await draw(bytes, { size: kSize, background: '#0102030a' });
  assert.deepEqual(pixel(data), [255, 0, 0, 255]);
  assert.deepEqual(pixel(data, 0.01), [1, 2, 3, 10]);
});

test('the picture is filled by parts, by a cage, or by the head that a joint holds', async () => {
  const list: Quad[] = [
    { material: plain(red), half: 4 },
    { z: 1, half: 3.6, material: plain(green) },
  ];
  const bytes = quads(list);
  const corner = async (options: ThumbnailOptions) => {
    const { data, framed } = await draw(bytes, { size: kSize, ...options });
    return [framed, ...pixel(data, 0.05, 0.05).slice(0, 2)];
  };
  assert.deepEqual(await corner({}), ['model', 255, 0]);
  assert.deepEqual(await corner({ view: 'face' }), ['model', 255, 0]);
  assert.deepEqual(await corner({ frame: ['*1'] }), ['parts', 0, 255]);
  assert.deepEqual(await corner({ cage: { positions: square(3.6, 3) } }), ['cage', 0, 255]);
  assert.deepEqual(
    await corner({ cage: glbOf({ positions: square(3.6, 3), indices: Uint16Array.of(0, 1, 2, 0, 2, 3) }) }),
    ['cage', 0, 255],
  );
  const withHead = quads(list, ({ json }) => {
    const head = json.nodes.push({ name: 'mixamorig:Head', children: [1] }) - 1;
    json.scenes![0]!.nodes = [0, head];
    Object.assign(json, { extensions: { VRMC_vrm: { humanoid: { humanBones: { head: { node: head } } } } } });
  });
  const face = await draw(withHead, { size: kSize, view: 'face' });
  assert.deepEqual([face.framed, ...pixel(face.data, 0.05, 0.05)], ['face', 0, 255, 0, 255]);
  // As of an FBX: each mesh has a skeleton of its own, whose head is in the same place.
  const withHeads = quads(
    [{ material: plain(red), half: 4 }, { z: 2, half: 2.5, material: plain(red) }, list[1]!],
    (maker) => {
      const { json } = maker;
      const heads = [1, 2].map((child) => maker.node({ name: 'Head', children: [child] }));
      const hips = maker.node({ name: 'Hips' });
      json.scenes![0]!.nodes = [0, ...heads, hips];
      json.skins = [{ joints: [hips, ...heads] }];
      json.nodes[0]!.skin = 0;
      const { attributes } = json.meshes[0]!.primitives[0]!;
      attributes['JOINTS_0'] = maker.accessor(new Uint8Array(16), 'VEC4');
      const weights = Float32Array.from({ length: 16 }, (_, i) => Number(i % 4 === 0));
      attributes['WEIGHTS_0'] = maker.accessor(weights, 'VEC4');
    },
  );
  const heads = await draw(withHeads, { size: kSize, view: 'face' });
  assert.deepEqual([heads.framed, ...pixel(heads.data, 0.05, 0.05)], ['face', 0, 255, 0, 255]);
});

test('views turn around the model, which looks at −z if it is of VRM 0', async () => {
  // Its left side is green: seen from there, from above, and by angles.
  const bytes = (extensions?: object) =>
    quads([{ material: plain(red) }, { material: plain(green) }], ({ json }) => {
      json.nodes[1]!.rotation = [0, Math.SQRT1_2, 0, Math.SQRT1_2]; // its front to +x
      json.nodes[1]!.translation = [1, 0, -1];
      Object.assign(json, extensions && { extensions });
    });
  const middle = async (view: ThumbnailOptions['view'], extensions?: object) =>
    pixel((await draw(bytes(extensions), { view, size: kSize })).data).slice(0, 2);
  assert.deepEqual(await middle('front'), [255, 0]);
  assert.deepEqual(await middle('left'), [0, 255]);
  assert.deepEqual(await middle({ azimuth: 90 }), [0, 255]);
  assert.deepEqual(await middle('right'), [0, 0]);
  assert.deepEqual(await middle('right', { VRM: {} }), [0, 255]);
  assert.deepEqual(await middle('back', { VRM: {} }), [255, 0]);
  assert.deepEqual(await middle('front', { VRM: {}, VRMC_vrm: {} }), [255, 0]);
});

test('what is painted is seen, and nothing else changes', async () => {
  const before = glbOf(target);
  const { bytes, triangles } = await paintGlb(before, { cage: readGlb('cage.glb'), texture: png(200) });
  const [clear, painted] = [await draw(before), await draw(bytes)];
  const differs = (i: number, k: number) => clear.data[4 * i + k] !== painted.data[4 * i + k];
  const all = [...Array(256 * 256).keys()];
  assert.ok(triangles.painted > 0 && all.filter((i) => differs(i, 0)).length > 1000);
  assert.ok(!all.some((i) => differs(i, 3)));
});

test('an overlay is drawn where all that it leaves of its part faces inward', async () => {
  const [skin, lining, core] = [1, 0.9, 0.5].map((radius) => ball([0, 0, 0], () => radius, 12, 24));
  const count = skin!.positions.length / 3;
  const head = {
    positions: Float32Array.of(...skin!.positions, ...lining!.positions),
    indices: Uint32Array.of(...skin!.indices, ...[...lining!.indices].reverse().map((v) => v + count)),
  };
  const maker = new GlbMaker();
  maker.json.materials = [{ ...plain(red) }, { ...plain(green) }];
  maker.node({ name: 'head', mesh: maker.mesh(head as never, { material: 0 }) });
  maker.node({ name: 'core', mesh: maker.mesh(core as never, { material: 1 }) });
  const blue = PNG.sync.write(Object.assign(new PNG({ width: 1, height: 1 }), { data: Buffer.of(0, 0, 255, 255) }));
  const { bytes } = await paintGlb(maker.finish(), {
    cage: readGlb('cage.glb'),
    texture: blue,
    decode: async (bytes) => decode(bytes),
  });
  const { meshes } = unpackGlb(bytes).json;
  assert.ok(meshes![0]!.primitives.some(({ extras }) => extras?.['cagecastInPlaceOf'] === 0));
  const [r, g, b] = pixel((await draw(bytes, { size: kSize })).data);
  assert.ok(b! > 0 && r === 0 && g === 0, `${r} ${g} ${b}`);
});

const readGlb = (name: string) => new Uint8Array(readFileSync(name));

test('a texture that cannot be decoded is named; without a decoder the error says what helps', async () => {
  const material = { pbrMetallicRoughness: { baseColorTexture: { index: 0 }, baseColorFactor: red as never } };
  const bytes = quads([{ material }, { z: 1, half: 0.5, material }], textured(noise(4, 4), {}));
  const failing = async () => {
    throw new Error('no room\nat all');
  };
  const { data, undecoded } = await draw(bytes, { size: kSize, decode: failing });
  assert.deepEqual(undecoded, ['skin: no room']);
  assert.deepEqual(pixel(data), [255, 0, 0, 255]);
  const odd = await draw(bytes, { size: kSize, decode: () => ({ width: 2, height: 2, data: new Uint8Array(3) }) });
  assert.match(odd.undecoded[0]!, /^skin: .*has 3 bytes, not 4 for each of 2 × 2 pixels/);
  await assert.rejects(thumbnail(bytes), (error: CagecastError) => {
    assert.match(error.message, /^thumbnail: this host does not decode images; give options\.decode, by sharp/);
    return error.code === 'unsupported' && error.argument === 'decode';
  });
  assert.deepEqual((await thumbnail(quads([{}]), { size: kSize })).undecoded, []);
});

test('wrong arguments are named', async () => {
  const bytes = quads([{}]);
  const wrong: [options: unknown, message: RegExp][] = [
    [{ size: 8 }, /options\.size is 8, not a whole number from 16 to 2048/],
    [{ view: 'up' }, /options\.view is "up", not front, back/],
    [{ view: { elevation: 91 } }, /options\.view\.elevation is 91, not a number from -90 to 90/],
    [{ view: { azimuth: Number.NaN } }, /options\.view\.azimuth is NaN/],
    [{ frame: [] }, /options\.frame is of type Array, not an array of patterns/],
    [{ frame: ['nose'] }, /frame: nothing is named "nose"; there are quad0/],
    [{ cage: {} }, /options\.cage is of type Object, not the bytes of a GLB, or a mesh/],
    [{ cage: new Uint8Array(3) }, /cage: /],
    [{ cage: bytes, frame: ['*'] }, /both given/],
    [{ background: 'red' }, /options\.background is "red", not a colour/],
    [{ decode: 1 }, /options\.decode is 1, not a function/],
    [{ zoom: 1 }, /options\.zoom is not an option; thumbnail takes: size, view/],
    [7, /options is 7, not an object/],
  ];
  for (const [options, message] of wrong)
    await assert.rejects(thumbnail(bytes, options as never), { name: 'CagecastError', message });
  await assert.rejects(thumbnail('x' as never), /bytes is "x", not a Uint8Array/);
  await assert.rejects(thumbnail(new GlbMaker().finish()), /bytes: has no triangles in its scene/);
});

test('the command writes PNGs, JPEGs and WebPs of several models, and says what it cannot draw', async () => {
  assert.equal(await ok('thumbnail target.glb -o one.png'), 'wrote one.png: 256 × 256, of target.glb\n');
  const { data } = await draw(readGlb('target.glb'));
  assert.deepEqual(decode(readFileSync('one.png')).data, Buffer.from(data));
  const human = inRepository('examples/samples/human/target.glb');
  const stdout = await ok(
    `thumbnail ${human} cage.glb --size 64 --view 30,15 --background #ffffff -o {name}-small.webp`,
  );
  assert.equal(stdout.split('\n').length, 3);
  assert.equal(readFileSync('cage-small.webp').subarray(8, 12).toString(), 'WEBP');
  const [made] = await json<{ framed: string }[]>(`thumbnail target.glb --cage cage.glb --size 64 -o side.jpg`);
  assert.equal(made!.framed, 'cage');
  assert.deepEqual([...readFileSync('side.jpg').subarray(0, 2)], [0xff, 0xd8]);
  write('broken.glb', 'glTF');
  const { status, stdout: lines } = await run('thumbnail broken.glb target.glb --size 16 -o new/{name}-16.png');
  assert.equal(status, 1);
  assert.match(lines, /^broken\.glb: .*\nwrote new\/target-16\.png: 16 × 16, of target\.glb\n$/);
  assert.ok(!existsSync('new/broken-16.png') && existsSync('new/target-16.png'));
  await fails(1, /broken\.glb: /, 'thumbnail broken.glb -o out.png');
  await fails(1, /target\.glb: .*nothing is named "nose"/, 'thumbnail target.glb --part nose -o out.png');
  writeChanged('textured.glb', glbOf(target), (file) => {
    file.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
    file.textures = [{ source: 0 }];
    file.images = [{ uri: 'data:image/ktx2;base64,q0tUWCAyMLsNChoK' }];
    file.meshes![0]!.primitives[0]!.material = 0;
  });
  assert.match(
    await ok('thumbnail textured.glb -o out.png'),
    /\nnot shown: the texture textures\[0\]: is a KTX2 image/,
  );
});
