// The same mesh in other forms gives the same answer.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { type GLTF, NodeIO } from '@gltf-transform/core';
import { KHRMeshQuantization } from '@gltf-transform/extensions';
import { json, ok } from '../../support/command.js';
import { type GlbMaker, glbOf, unpackGlb, validate } from '../../support/gltf.js';
import { ball, join3d } from '../scenes.js';
import { png, workplace, write, writeChanged, writeMade } from './workplace.js';

const { cage, target } = workplace('forms');
const vertices = target.positions.length / 3;
const paint = png(200);

interface Report {
  counts: object;
  areas: { total: number; cosmetic: number };
  segments: { points: number; exposedArea: number; coveredArea: number; culled: boolean }[];
  parts: { name: string }[];
  target: { vertices: number };
}

const reportOf = (path: string, cage = 'cage.glb') => json<Report>(`transfer ${path} --cage ${cage}`);

/** Counts, areas and segments of a target. */
async function answer(path: string, cage?: string): Promise<object> {
  const { counts, areas, segments } = await reportOf(path, cage);
  const round = (x: number) => Number(x.toPrecision(5));
  const rows = segments.map((one) => [one.points, round(one.exposedArea), round(one.coveredArea), one.culled]);
  return { counts, area: round(areas.total), rows };
}

/** A mesh scaled along the axes. Where that mirrors it, its triangles are turned. */
function scaled<Mesh extends typeof cage>(mesh: Mesh, ...factors: number[]): Mesh {
  const indices = Uint32Array.from(mesh.indices);
  if (factors[0]! * factors[1]! * factors[2]! < 0)
    for (let t = 0; t < indices.length; t += 3) [indices[t + 1], indices[t + 2]] = [indices[t + 2]!, indices[t + 1]!];
  return { ...mesh, indices, positions: mesh.positions.map((x, i) => x * factors[i % 3]!) };
}

/** Adds a mesh that joints hold. @param jointOf  The joint that holds a vertex. */
function skinned(maker: GlbMaker, mesh: typeof target, jointOf: (vertex: number) => number, skin: GLTF.ISkin): void {
  const number = maker.mesh(mesh);
  const { attributes } = maker.json.meshes[number]!.primitives[0]!;
  const held = Uint8Array.from({ length: 4 * vertices }, (_, i) => (i % 4 === 0 ? jointOf(i / 4) : 0));
  attributes['JOINTS_0'] = maker.accessor(held, 'VEC4');
  const weights = Float32Array.from(held, (_, i) => Number(i % 4 === 0));
  attributes['WEIGHTS_0'] = maker.accessor(weights, 'VEC4');
  maker.json.skins = [skin];
  maker.node({ mesh: number, skin: 0, translation: [100, 0, 0] }); // which the format ignores
}

/** The target, some times as large as it is shown, held by two joints of a rig that is turned. @param bent Whether one has moved since. */
function rigged(maker: GlbMaker, times: number, bent: boolean): void {
  const back = [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1].map((x, i) => (i < 12 ? x / times : x));
  const inverses = [back, back.map((x, i) => (i === 12 ? x - 0.5 : x)), back.map(() => 7)]; // the third holds nothing
  const inverseBindMatrices = maker.accessor(Float32Array.from(inverses.flat()), 'MAT4');
  maker.node({ name: 'unused' });
  maker.node({ name: 'rig', matrix: [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1], children: [2] });
  maker.node({ name: 'tip', translation: [bent ? 3 : 0.5, 0, 0] }, false);
  skinned(maker, scaled(target, times, times, times), (v) => v % 2, { joints: [1, 2, 0], inverseBindMatrices });
}

const forms: Record<string, (maker: GlbMaker) => void> = {
  'indices of 16 bits': (maker) =>
    maker.node({ mesh: maker.mesh({ ...target, indices: Uint16Array.from(target.indices) }) }),
  'moved and turned by nodes, undone by their parents': (maker) => {
    const inner = maker.node({ mesh: maker.mesh(target), translation: [1, 2, 3], scale: [2, 2, 2] }, false);
    const matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, -2, -3, 1];
    maker.node({ children: [maker.node({ children: [inner], matrix }, false)], scale: [0.5, 0.5, 0.5] });
  },
  'mirrored by its node': (maker) => maker.node({ mesh: maker.mesh(scaled(target, -1, 1, 1)), scale: [-1, 1, 1] }),
  'held by a joint where it is': (maker) => {
    maker.node({ name: 'bone' });
    skinned(maker, target, () => 0, { joints: [0] });
  },
  'held by a skeleton, in another unit and with other axes': (maker) => rigged(maker, 128, false),
  'held by joints that have moved: in its bind pose': (maker) => rigged(maker, 1, true),
  'the same in another unit': (maker) => rigged(maker, 128, true),
  'with instances: where the first one is': (maker) => {
    const TRANSLATION = maker.accessor(new Float32Array([0, 4, 0, 3, 0, 0]), 'VEC3');
    const ROTATION = maker.accessor(new Float32Array([0, 0, 1, 0, 0, 0, 0, 1]), 'VEC4');
    const SCALE = maker.accessor(new Float32Array([2, 2, 2, 1, 1, 1]), 'VEC3');
    const undone = { translation: [0, 2, 0], rotation: [0, 0, 1, 0], scale: [0.5, 0.5, 0.5] };
    const extensions = { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION, ROTATION, SCALE } } };
    maker.node({ children: [maker.node({ mesh: maker.mesh(target), ...undone, extensions } as GLTF.INode, false)] });
    maker.json.extensionsUsed = ['EXT_mesh_gpu_instancing'];
  },
  'with a sparse accessor': (maker) => {
    const moved = Uint16Array.of(3, 8, 20);
    const base = target.positions.map((x, i) => (moved.includes(Math.floor(i / 3)) ? 9 : x));
    const values = Float32Array.from([...moved].flatMap((v) => [...target.positions.subarray(3 * v, 3 * v + 3)]));
    const mesh = maker.mesh({ ...target, positions: base });
    const accessor = maker.json.accessors[maker.json.meshes[mesh]!.primitives[0]!.attributes['POSITION']!]!;
    const view = (array: Uint16Array | Float32Array) => maker.view(new Uint8Array(array.buffer));
    const indices = { bufferView: view(moved), componentType: 5123 };
    accessor.sparse = { count: 3, indices, values: { bufferView: view(values) } } as GLTF.IAccessorSparse;
    maker.node({ mesh });
  },
  'with an unknown extension of materials, though required': (maker) => {
    maker.node({ mesh: maker.mesh(target) });
    maker.json.extensionsUsed = maker.json.extensionsRequired = ['ACME_materials'];
  },
  'beside nodes outside the scene that are their own ancestors': (maker) => {
    maker.node({ mesh: maker.mesh(target) });
    maker.json.nodes.push({ children: [2] }, { children: [1] });
  },
};

for (const [name, make] of Object.entries(forms))
  test(name, async () => {
    writeMade('form.glb', make);
    assert.deepEqual(await answer('form.glb'), await answer('target.glb'));
  });

test('not indexed', async () => {
  const corners = [...target.indices].flatMap((v) => [...target.positions.subarray(3 * v, 3 * v + 3)]);
  writeMade('soup.glb', (maker) => {
    const POSITION = maker.accessor(Float32Array.from(corners), 'VEC3');
    maker.node({ mesh: maker.json.meshes.push({ primitives: [{ attributes: { POSITION } }] }) - 1 });
  });
  const [soup, plain] = [await reportOf('soup.glb'), await reportOf('target.glb')];
  const points = ({ segments }: Report) => segments.map((segment) => segment.points);
  assert.deepEqual(points(soup), points(plain));
  assert.ok(Math.abs(soup.areas.cosmetic - plain.areas.cosmetic) < 1e-6 * soup.areas.total);
});

test('a cage that its node mirrors: outside stays outside', async () => {
  writeMade('mirrored-cage.glb', (maker) =>
    maker.node({ mesh: maker.mesh(scaled(cage, 1, -1, 1)), scale: [1, -1, 1] }),
  );
  assert.deepEqual((await reportOf('target.glb', 'mirrored-cage.glb')).counts, (await reportOf('target.glb')).counts);
});

test('quantised positions, normalised, with the scale in the node; vertices that are split stay so, in words of four bytes', async () => {
  const words = Int16Array.from({ length: 4 * vertices }, (_, i) =>
    i % 4 === 3 ? 0 : Math.round((target.positions[3 * Math.floor(i / 4) + (i % 4)]! / 2) * 32767),
  );
  const rounded = target.positions.map((x) => (Math.round((x / 2) * 32767) / 32767) * 2);
  write('rounded.glb', glbOf({ ...target, positions: rounded }));
  writeMade('quantised.glb', (maker) => {
    const bound = (pick: typeof Math.min) => [0, 1, 2].map((k) => pick(...words.filter((_, i) => i % 4 === k)));
    const accessor = { componentType: 5122, normalized: true, count: vertices, type: 'VEC3' } as const;
    const bufferView = maker.view(new Uint8Array(words.buffer), { byteStride: 8 });
    const POSITION =
      maker.json.accessors.push({ ...accessor, bufferView, min: bound(Math.min), max: bound(Math.max) }) - 1;
    const primitive = { attributes: { POSITION }, indices: maker.accessor(target.indices as Uint32Array, 'SCALAR') };
    maker.node({ mesh: maker.json.meshes.push({ primitives: [primitive] }) - 1, scale: [2, 2, 2] });
    maker.json.extensionsUsed = maker.json.extensionsRequired = ['KHR_mesh_quantization'];
  });
  assert.deepEqual((await reportOf('quantised.glb')).counts, (await reportOf('rounded.glb')).counts);
  assert.match(await ok('transfer quantised.glb --cage cage.glb -o split.glb'), / split at seams/);
  assert.deepEqual(await validate('split.glb'), []);
  const [primitive] = (await new NodeIO().registerExtensions([KHRMeshQuantization]).read('split.glb'))
    .getRoot()
    .listMeshes()[0]!
    .listPrimitives();
  const positions = primitive!.getAttribute('POSITION')!;
  assert.ok(positions.getNormalized());
  assert.deepEqual(
    positions.getArray()!.slice(0, 3 * vertices),
    words.filter((_, i) => i % 4 < 3),
  );
});

test('strips and fans', async () => {
  const positions = new Float32Array([-0.1, -0.1, 0.9, 0.1, -0.1, 0.9, -0.1, 0.1, 0.9, 0.1, 0.1, 0.9]);
  const answers = [];
  for (const [mode, indices] of [
    [4, [0, 1, 2, 2, 1, 3]],
    [5, [0, 1, 2, 3]],
    [6, [1, 3, 2, 0]],
  ] as const) {
    write('mode.glb', glbOf({ positions, indices: Uint16Array.from(indices), mode }));
    answers.push(await answer('mode.glb'));
    await ok('transfer mode.glb --cage cage.glb --texture paint.png -o wound.glb');
    const overlay = (await new NodeIO().read('wound.glb')).getRoot().listMeshes()[0]!.listPrimitives()[1]!;
    const corners = [...overlay.getIndices()!.getArray()!].map((v) =>
      overlay.getAttribute('POSITION')!.getElement(v, [] as number[]),
    );
    // All triangles of the overlay face up, as the cage is above.
    for (let i = 0; i < corners.length; i += 3) {
      const [a, b, c] = corners.slice(i, i + 3) as [number[], number[], number[]];
      assert.ok((b[0]! - a[0]!) * (c[1]! - a[1]!) > (b[1]! - a[1]!) * (c[0]! - a[0]!), `mode ${mode}`);
    }
  }
  assert.deepEqual(answers, Array(3).fill(answers[0]));
});

test('buffers and images beside a glTF, or in it as data URIs of any kind, become one GLB', async () => {
  const { json: whole, bin } = unpackGlb(glbOf(target));
  const base64 = (bytes: Uint8Array) => Buffer.from(bytes).toString('base64');
  const escaped = (bytes: Uint8Array) => [...bytes].map((byte) => `%${byte.toString(16).padStart(2, '0')}`).join('');
  const encoded = (bytes: Uint8Array) => encodeURIComponent(base64(bytes));
  const embedded = (kind: string, encode: (bytes: Uint8Array) => string): [string, string, string] => [
    `data:application/octet-stream${kind},${encode(bin)}`,
    `data:image/png${kind},${encode(paint)}`,
    'first',
  ];
  mkdirSync('loose');
  write('loose/mesh data.bin', bin);
  write('loose/head 50%.bin', bin);
  for (const name of ['skin', 'own name']) write(`loose/${name}.png`, paint);
  for (const [buffer, image, name] of [
    ['mesh%20data.bin', 'skin.png', 'skin'],
    ['head 50%.bin', 'own%20name.png', 'own name'], // as no URI is
    embedded(';base64', base64),
    embedded(';BASE64', base64),
    embedded(';base64', encoded),
    embedded('', escaped),
  ] as const) {
    whole.buffers![0]!.uri = buffer;
    whole.images = [{ uri: image, ...(name === 'first' && { name }) }];
    whole.textures = [{ source: 0 }];
    whole.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
    whole.meshes![0]!.primitives[0]!.material = 0;
    write('loose/target.gltf', JSON.stringify(whole));
    await ok('transfer loose/target.gltf --cage cage.glb -o packed.glb');
    assert.deepEqual(await answer('loose/target.gltf'), await answer('target.glb'), buffer.slice(0, 60));
    assert.deepEqual(await validate('packed.glb'), []);
    const { images, bufferViews } = unpackGlb(readFileSync('packed.glb')).json;
    const { byteOffset = 0, byteLength } = bufferViews![images![0]!.bufferView!]!;
    const stored = unpackGlb(readFileSync('packed.glb')).bin.subarray(byteOffset, byteOffset + byteLength);
    assert.deepEqual([images![0]!.name, Buffer.from(stored)], [name, paint]);
  }
});

test('images of kinds that only an extension admits are known by the endings of their names', async () => {
  const images: GLTF.IImage[] = [{ uri: 'skin.avif' }, { uri: 'skin.DDS' }, { uri: 'skin.bmp', mimeType: 'image/bmp' }];
  for (const { uri } of images) write(uri!, 'image');
  writeChanged('avif.glb', glbOf(target), (json) =>
    Object.assign(json, { images, extensionsUsed: ['EXT_texture_avif'] }),
  );
  await ok('transfer avif.glb --cage cage.glb -o avif-out.glb');
  const types = unpackGlb(readFileSync('avif-out.glb')).json.images!.map(({ mimeType }) => mimeType);
  assert.deepEqual(types, ['image/avif', 'image/vnd-ms.dds', 'image/bmp']);
});

test('every primitive of every node is a group of its own', async () => {
  const half = Math.floor(target.indices.length / 6) * 3;
  writeMade('parts.glb', (maker) => {
    const [a, b] = [target.indices.slice(0, half), target.indices.slice(half)].map((indices) =>
      maker.mesh({ ...target, indices }),
    );
    maker.json.meshes[a!]!.primitives.push(maker.json.meshes[b!]!.primitives[0]!);
    maker.node({ mesh: a!, name: 'split' });
  });
  const { parts, segments, target: found } = await reportOf('parts.glb');
  assert.deepEqual([parts.length, found.vertices], [2, 2 * vertices]);
  assert.ok(segments.length > (await reportOf('target.glb')).segments.length);
});

test('a mesh that two nodes show gets UVs for each of them, as two meshes would', async () => {
  const small = ball([0, 0, 0], () => 0.2, 8, 12);
  const at = (x: number) => ({
    ...small,
    positions: small.positions.map((value, i) => (i % 3 === 0 ? value + x : value)),
  });
  write('pair.glb', glbOf({ ...join3d(at(-0.6), at(0.6)), groups: undefined }));
  writeMade('twins.glb', (maker) => {
    const mesh = maker.mesh(small);
    for (const x of [-0.6, 0.6]) maker.node({ mesh, translation: [x, 0, 0] });
  });
  const uvs = [];
  for (const name of ['pair', 'twins']) {
    await ok(`transfer ${name}.glb --cage cage.glb --seams vertex --texture paint.png -o ${name}-out.glb`);
    assert.deepEqual(await validate(`${name}-out.glb`), []);
    const meshes = (await new NodeIO().read(`${name}-out.glb`)).getRoot().listMeshes();
    uvs.push(meshes.flatMap((mesh) => [...mesh.listPrimitives()[0]!.getAttribute('TEXCOORD_1')!.getArray()!]));
  }
  assert.deepEqual(uvs[1], uvs[0]);
});
