// Files stay lean and keep their form: nothing replaced stays, and what was compressed is compressed again.
import assert from 'node:assert/strict';
import { copyFileSync, readdirSync, readFileSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';
import type { Document, GLTF, Primitive } from '@gltf-transform/core';
import { KHRDracoMeshCompression } from '@gltf-transform/extensions';
import { meshopt, quantize } from '@gltf-transform/functions';
import { transfer } from 'cagecast';
import draco from 'draco3dgltf';
import { MeshoptDecoder, MeshoptEncoder } from 'meshoptimizer';
import { ok } from '../../support/command.js';
import { glbOf, isOverlay, primitivesOf, unpackGlb, validate } from '../../support/gltf.js';
import { ball, head } from '../scenes.js';
import { io, jsonOf, workplace, write, writeChanged, writeMade } from './workplace.js';

const { cage, target } = workplace('lean', head(3, 24));
const indices = target.indices as Uint32Array;

before(async () => {
  await Promise.all([MeshoptDecoder.ready, MeshoptEncoder.ready]);
  io.registerDependencies({
    'meshopt.decoder': MeshoptDecoder,
    'meshopt.encoder': MeshoptEncoder,
    'draco3d.decoder': await draco.createDecoderModule(),
    'draco3d.encoder': await draco.createEncoderModule(),
  });
});

/** Transfers to a file and returns what is written: as it stands, and decoded. */
async function written(name: string, flags = '') {
  const out = `out-${name}`;
  const stdout = await ok(`transfer ${name} --cage cage.glb -o ${out}${flags && ' '}${flags}`);
  assert.match(stdout, /^[^\n]*: [\d,]+ vertices/, 'nothing else is printed');
  // The command adds a UV set without a material; the validator cannot see into compressed data.
  const issues = await validate(out, 2);
  for (const issue of issues)
    assert.match(issue, /TEXCOORD_\d+: UNUSED_OBJECT|UNSUPPORTED_EXTENSION|bufferViews\/\d+: UNUSED_OBJECT/);
  if (!/draco/.test(name + flags)) assert.ok(!issues.some((issue) => issue.includes('bufferViews')));
  return { json: jsonOf(out), document: await io.read(out), ratio: statSync(out).size / statSync(name).size };
}

/** Writes the target in another form. */
async function convert(name: string, change: (document: Document) => Promise<unknown>): Promise<void> {
  const document = await io.read('target.glb');
  await change(document);
  await io.write(name, document);
}

type Corner = { position: number[]; uv: number[] | undefined };

/** Colours of a picture of triangles from the front, by their UVs; grey without. */
function picture(corners: readonly Corner[]): Uint8Array {
  const size = 160;
  const [colors, depths] = [new Uint8Array(size * size), new Float64Array(size * size).fill(-Infinity)];
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = corners.slice(i, i + 3) as [Corner, Corner, Corner];
    const [p, q, r] = [a, b, c].map(({ position: [x, y, z] }) => [80 + 60 * x!, 80 - 60 * y!, z!]) as number[][];
    const [ux, uy, vx, vy] = [q![0]! - p![0]!, q![1]! - p![1]!, r![0]! - p![0]!, r![1]! - p![1]!];
    const area = ux * vy - uy * vx;
    if (area === 0) continue;
    const bounds = (k: number) => [p!, q!, r!].map((point) => point[k]!);
    for (let y = Math.ceil(Math.min(...bounds(1))); y <= Math.max(...bounds(1)); ++y)
      for (let x = Math.ceil(Math.min(...bounds(0))); x <= Math.max(...bounds(0)); ++x) {
        const [s, t] = [((x - p![0]!) * vy - (y - p![1]!) * vx) / area, (ux * (y - p![1]!) - uy * (x - p![0]!)) / area];
        const depth = p![2]! + s * (q![2]! - p![2]!) + t * (r![2]! - p![2]!);
        // Compression may turn a triangle of the overlay, which rounds its depths otherwise.
        if (s < 0 || t < 0 || s + t > 1 || depth < depths[y * size + x]! - 1e-6) continue;
        depths[y * size + x] = depth;
        const uv = a.uv && [0, 1].map((k) => a.uv![k]! + s * (b.uv![k]! - a.uv![k]!) + t * (c.uv![k]! - a.uv![k]!));
        colors[y * size + x] = uv ? 128 + 60 * Math.sin(20 * uv[0]!) + 60 * Math.sin(20 * uv[1]!) : 1;
      }
  }
  return colors;
}

/** The picture that the arrays of the transfer make. */
function computed(): Uint8Array {
  const { cosmeticTriangles, cornerUvs } = transfer(cage, target);
  return picture(
    Array.from(indices, (v, i) => ({
      position: [...target.positions.slice(3 * v, 3 * v + 3)],
      uv: cosmeticTriangles[Math.floor(i / 3)] === 1 ? [...cornerUvs.slice(2 * i, 2 * i + 2)] : undefined,
    })),
  );
}

/** The picture that a file makes. */
function shown(document: Document): Uint8Array {
  const corners: Corner[] = [];
  for (const node of document.getRoot().listNodes()) {
    const m = node.getWorldMatrix();
    for (const primitive of node.getMesh()?.listPrimitives() ?? [])
      for (const v of primitive.getIndices()!.getArray()!) {
        const [x = 0, y = 0, z = 0] = primitive.getAttribute('POSITION')!.getElement(v, []);
        corners.push({
          position: [0, 1, 2].map((k) => m[k]! * x + m[4 + k]! * y + m[8 + k]! * z + m[12 + k]!),
          uv: isOverlay(primitive) ? primitive.getAttribute('TEXCOORD_0')!.getElement(v, []) : undefined,
        });
      }
  }
  return picture(corners);
}

function assertSamePicture(is: Uint8Array, should: Uint8Array, most: number): void {
  const painted = should.filter((color) => color > 1).length;
  const other = should.filter((color, i) => Math.abs(color - is[i]!) > 6).length;
  assert.ok(painted > 2000, `${painted} pixels are painted`);
  assert.ok(other < most * painted, `${other} of ${painted} pixels differ`);
}

let plain: Promise<Uint8Array> | undefined;

/** The picture of the file that is not compressed. */
const plainPicture = (): Promise<Uint8Array> =>
  (plain ??= written('target.glb', '--texture paint.png').then(({ document }) => shown(document)));

/** The bytes of all views, and of the buffer, in words. */
const words = ({ bufferViews, buffers }: GLTF.IGLTF): [views: number, buffer: number] => [
  bufferViews!.reduce((sum, { byteLength }) => sum + Math.ceil(byteLength / 4), 0),
  Math.ceil(buffers![0]!.byteLength / 4),
];

test('nothing that is replaced stays in the file; UVs take four bytes, zones a byte or less', async () => {
  const { json, document, ratio } = await written('target.glb');
  assert.ok(ratio < 1.35, `${ratio}`);
  const used = new Set(
    json.accessors!.flatMap(({ bufferView, sparse }) => [
      bufferView,
      sparse?.indices.bufferView,
      sparse?.values.bufferView,
    ]),
  );
  assert.deepEqual(
    [...json.bufferViews!.keys()].filter((v) => !used.has(v)),
    [],
  );
  const [views, buffer] = words(json);
  assert.equal(buffer, views);
  const [primitive] = primitivesOf(document);
  assert.equal(primitive!.getAttribute('TEXCOORD_1')!.getArray()!.constructor, Uint16Array);
  assert.equal(primitive!.getAttribute('_NCZ')!.getArray()!.constructor, Uint8Array);
});

test('the overlay shows what was computed', async () => {
  assertSamePicture(await plainPicture(), computed(), 0.03); // it lies a little above the surface
});

const kForms = { none: undefined, meshopt: 'EXT_meshopt_compression', draco: 'KHR_draco_mesh_compression' };

test('--compress writes each form from each', async () => {
  let from = 'target.glb';
  for (const form of ['draco', 'meshopt', 'none'] as const) {
    await ok(`transfer ${from} --cage cage.glb -o ${form}.glb --compress ${form}`);
    const { extensionsRequired, extensionsUsed, buffers } = jsonOf(`${form}.glb`);
    const extensions = kForms[form] && [kForms[form]];
    assert.deepEqual([extensionsUsed, extensionsRequired], [extensions, extensions]);
    assert.equal(buffers!.length, form === 'meshopt' ? 2 : 1);
    assert.deepEqual(await validate(`${form}.glb`), []);
    const corners = primitivesOf(await io.read(`${form}.glb`))[0]!.getIndices()!;
    assert.equal(corners.getCount(), indices.length, form);
    from = `${form}.glb`;
  }
});

for (const [form, most, change] of [
  ['meshopt', 2.4, (document) => document.transform(meshopt({ encoder: MeshoptEncoder }))],
  ['draco', 3.2, async (document) => document.createExtension(KHRDracoMeshCompression).setRequired(true)],
  ['quantised', 2.4, (document) => document.transform(quantize())],
] as [string, number, (document: Document) => Promise<unknown>][])
  test(`a ${form} file stays so, with its overlay, and shows the same`, async () => {
    await convert(`${form}.glb`, change);
    const { json, document, ratio } = await written(`${form}.glb`, '--texture paint.png');
    assert.ok(ratio < most, `${ratio}`);
    const { primitives } = json.meshes![0]!;
    assert.equal(primitives.length, 2);
    if (form === 'meshopt') {
      const geometry = json.bufferViews!.filter(({ target }) => target !== undefined);
      assert.ok(geometry.length > 5 && geometry.every(({ extensions }) => extensions?.[kForms.meshopt]));
    } else if (form === 'draco') {
      assert.ok(primitives.every(({ extensions }) => extensions?.[kForms.draco]));
      assert.ok(json.accessors!.every(({ bufferView }) => bufferView === undefined));
    } else
      for (const primitive of primitivesOf(document))
        for (const semantic of primitive.listSemantics())
          assert.ok(!(primitive.getAttribute(semantic)!.getArray() instanceof Float32Array), semantic);
    assertSamePicture(shown(document), await plainPicture(), 0.01);
  });

test('what Draco has rounded before stays where it was, and attributes of an own name keep their values', async () => {
  await convert('draco-ids.glb', async (document) => {
    document.createExtension(KHRDracoMeshCompression).setEncoderOptions({ quantizationBits: { GENERIC: 0 } });
    const ids = Float32Array.from({ length: target.positions.length / 3 }, (_, i) => 100_003 * i);
    primitivesOf(document)[0]!.setAttribute('_ID', document.createAccessor().setArray(ids));
  });
  const positionsById = (document: Document): Map<number, number[]> => {
    const [ids, positions] = ['_ID', 'POSITION'].map((semantic) => primitivesOf(document)[0]!.getAttribute(semantic)!);
    return new Map(Array.from(ids!.getArray() as Float32Array, (id, i) => [id, positions!.getElement(i, [])]));
  };
  const before = positionsById(await io.read('draco-ids.glb'));
  const after = positionsById((await written('draco-ids.glb')).document);
  assert.deepEqual([...after.keys()].sort(), [...before.keys()].sort());
  for (const [id, position] of after)
    for (const [k, x] of position.entries()) assert.ok(Math.abs(x - before.get(id)![k]!) < 1e-6, `vertex ${id}`);
});

test('what Draco cannot compress is stored as it is', async () => {
  writeMade('flat.glb', (maker) => {
    maker.node({ mesh: maker.mesh(target) });
    const positions = new Float32Array([0, 0, 0.99, 0, 0, 0.99, 0, 0, 0.99]); // a triangle without an area
    maker.node({ mesh: maker.mesh({ positions, indices: new Uint32Array([0, 1, 2]) }) });
  });
  const { json } = await written('flat.glb', '--compress draco --texture paint.png');
  const [compressed, flat] = json.meshes!.map(({ primitives }) => primitives);
  assert.ok(compressed!.every(({ extensions }) => extensions));
  assert.equal(flat![0]!.extensions, undefined);
  assert.ok(json.accessors![flat![0]!.attributes['POSITION']!]!.bufferView !== undefined);
});

test('lines and small indices that share a view with triangles stay what they are with --compress meshopt', async () => {
  // As many lines as two triangles have corners, and less.
  const lines = [Uint32Array.of(0, 1, 1, 2, 2, 0), Uint16Array.of(3, 1, 8, 5), Uint8Array.of(6, 2, 5, 0)];
  writeMade('lines.glb', (maker) => {
    const attributes = { POSITION: maker.accessor(target.positions, 'VEC3') };
    const all = [indices, ...lines];
    const bytes = all.map(({ buffer, byteOffset, byteLength }) => Buffer.from(buffer, byteOffset, byteLength));
    const bufferView = maker.view(Buffer.concat(bytes), { target: 34963 });
    let byteOffset = 0;
    const primitives = all.map(({ length: count, byteLength, BYTES_PER_ELEMENT }, i) => {
      const componentType = { 1: 5121, 2: 5123, 4: 5125 }[BYTES_PER_ELEMENT]!;
      const accessor = { bufferView, byteOffset, componentType, count, type: 'SCALAR' } as GLTF.IAccessor;
      byteOffset += byteLength;
      return { attributes, indices: maker.json.accessors.push(accessor) - 1, ...(i > 0 && { mode: 1 as const }) };
    });
    maker.node({ mesh: maker.json.meshes.push({ primitives }) - 1 });
  });
  const { document } = await written('lines.glb', '--compress meshopt');
  const [, ...kept] = primitivesOf(document);
  assert.deepEqual(
    kept.map((primitive) => primitive.getIndices()!.getArray()),
    lines,
  );
});

test('what shares a view with something that is replaced stays, without it', async () => {
  const other = ball([0, 0, 5], () => 0.2, 12, 16);
  writeMade('joined.glb', (maker) => {
    const both = new Float32Array([...other.positions, ...target.positions]);
    const bufferView = maker.view(new Uint8Array(both.buffer), { target: 34962, byteStride: 12 });
    const part = (positions: Float32Array, corners: Uint32Array, byteOffset: number) => {
      const bound = (pick: typeof Math.min) => [0, 1, 2].map((k) => pick(...positions.filter((_, i) => i % 3 === k)));
      const accessor = {
        bufferView,
        byteOffset,
        componentType: 5126,
        count: positions.length / 3,
        type: 'VEC3',
      } as const;
      const POSITION = maker.json.accessors.push({ ...accessor, min: bound(Math.min), max: bound(Math.max) }) - 1;
      const primitive = { attributes: { POSITION }, indices: maker.accessor(corners, 'SCALAR') };
      return maker.node({ mesh: maker.json.meshes.push({ primitives: [primitive] }) - 1 }, false);
    };
    const hidden = part(other.positions as Float32Array, other.indices, 0);
    const seen = part(target.positions as Float32Array, indices, 4 * other.positions.length);
    maker.json.scenes = [{ nodes: [seen] }, { nodes: [hidden] }];
  });
  const { json, document } = await written('joined.glb');
  const [first, second] = primitivesOf(document).map((primitive) => primitive.getAttribute('POSITION')!);
  assert.deepEqual(first!.getArray(), other.positions);
  assert.ok(second!.getCount() > target.positions.length / 3, 'vertices are split');
  const floats = ({ target, byteLength }: GLTF.IBufferView) => target === 34962 && byteLength > 4 * first!.getCount();
  const stored = json.bufferViews!.filter(floats).reduce((sum, { byteLength }) => sum + byteLength, 0);
  assert.ok(stored <= 12 * first!.getCount() + 20 * second!.getCount());
  const [views, buffer] = words(json);
  assert.equal(buffer, views);
});

test('primitives that share vertices go on sharing them, and sparse morph targets stay sparse', async () => {
  writeMade('shared.glb', (maker) => {
    const mesh = maker.mesh({ positions: target.positions, indices: indices.slice(0, 3 * 500) });
    const primitive = maker.json.meshes[mesh]!.primitives[0]!;
    const moved = Uint16Array.from({ length: 20 }, (_, i) => 10 * i);
    const values = Float32Array.from({ length: 3 * moved.length }, (_, i) => i / 100);
    const view = (array: Uint16Array | Float32Array) => maker.view(new Uint8Array(array.buffer));
    primitive.targets = Array.from({ length: 8 }, () => {
      const where = { bufferView: view(moved), componentType: 5123 } as const;
      const sparse = { count: 20, indices: where, values: { bufferView: view(values) } };
      const bounds = { min: [0, 0, 0], max: [0.57, 0.58, 0.59] };
      const accessor = {
        componentType: 5126,
        count: target.positions.length / 3,
        type: 'VEC3',
        ...bounds,
        sparse,
      } as const;
      return { POSITION: maker.json.accessors.push(accessor) - 1 };
    });
    for (const own of [indices.slice(3 * 500, 3 * 900), indices.slice(3 * 900)])
      maker.json.meshes[mesh]!.primitives.push({ ...primitive, indices: maker.accessor(own, 'SCALAR') });
    maker.node({ mesh });
  });
  const { json, document, ratio } = await written('shared.glb');
  assert.ok(ratio < 1.4, `${ratio}`);
  const [a, ...others] = json.meshes![0]!.primitives;
  for (const other of others) assert.deepEqual([other.attributes, other.targets], [a!.attributes, a!.targets]);
  assert.ok(a!.targets!.every(({ POSITION }) => json.accessors![POSITION!]!.sparse !== undefined));
  // Every corner is where it was, and moves as it did.
  const before = primitivesOf(await io.read('shared.glb'));
  const cornersOf = (primitive: Primitive) =>
    [...primitive.getIndices()!.getArray()!].map((v) =>
      [primitive, primitive.listTargets()[5]!].map((one) => one.getAttribute('POSITION')!.getElement(v, [])),
    );
  for (const [p, primitive] of primitivesOf(document).entries())
    assert.deepEqual(cornersOf(primitive), cornersOf(before[p]!));
});

test('sparse accessors of meshes that share their views leave nothing behind where one is replaced', async () => {
  const [moved, kTargets] = [40, 30];
  const deltas = (of: number) => Float32Array.from({ length: 3 * moved }, (_, i) => (i + of) / 100);
  writeMade('shared-views.glb', (maker) => {
    const far = new Float32Array(3 * moved).map((_, i) => 50 + ((i * 7) % 11));
    const meshes = [
      maker.mesh({ positions: target.positions, indices }),
      maker.mesh({ positions: far, indices: Uint32Array.from({ length: 36 }, (_, i) => i) }),
    ];
    const count = meshes.length * kTargets;
    const places = new Uint16Array(moved * count).map((_, i) => i % moved);
    const values = new Float32Array(3 * moved * count);
    for (let t = 0; t < count; ++t) values.set(deltas(t), 3 * moved * t);
    const [where, what] = [places, values].map((array) => maker.view(new Uint8Array(array.buffer)));
    for (const [m, mesh] of meshes.entries()) {
      const { primitives } = maker.json.meshes[mesh]!;
      primitives[0]!.targets = Array.from({ length: kTargets }, (_, t) => {
        const at = m * kTargets + t;
        const sparse = {
          count: moved,
          indices: { bufferView: where!, byteOffset: 2 * moved * at, componentType: 5123 },
          values: { bufferView: what!, byteOffset: 12 * moved * at },
        } as const;
        const bounds = {
          min: [0, 0, 0].map((_, k) => (at + k) / 100),
          max: [2, 1, 0].map((k) => (3 * moved - 1 - k + at) / 100),
        };
        const vertices = m === 0 ? target.positions.length / 3 : moved;
        if (m === 0) bounds.min = [0, 0, 0];
        const accessor = { componentType: 5126, count: vertices, type: 'VEC3', sparse, ...bounds } as const;
        return { POSITION: maker.json.accessors.push(accessor) - 1 };
      });
      maker.node({ mesh });
    }
  });
  const { json, document } = await written('shared-views.glb');
  const slots = json.accessors!.flatMap(({ sparse }) => (sparse ? [{ ...sparse, bytes: 14 * sparse.count }] : []));
  const holding = new Set(slots.flatMap(({ indices, values }) => [indices.bufferView, values.bufferView]));
  const held = [...holding].reduce((sum, view) => sum + json.bufferViews![view]!.byteLength, 0);
  const needed = slots.reduce((sum, { bytes }) => sum + bytes, 0);
  assert.ok(held <= needed + 4 * slots.length, `${held} bytes for ${needed}`);
  const far = primitivesOf(document)[1]!;
  for (const [t, morph] of far.listTargets().entries())
    assert.deepEqual([...morph.getAttribute('POSITION')!.getArray()!], [...deltas(kTargets + t)]);
});

test('views and accessors to which an unknown extension may refer keep their numbers, also if less is added than replaced', async () => {
  await ok('transfer target.glb --cage cage.glb --texture paint.png -o painted.glb');
  for (const flags of ['--compress draco', '']) {
    let [indices, values] = [0, 0];
    let extension = {};
    writeChanged('metadata.glb', readFileSync('painted.glb'), (json, glb) => {
      const view = () => json.bufferViews!.push({ buffer: 0, byteOffset: glb.bin.length, byteLength: 4 }) - 1;
      [values, indices] = [
        view(),
        json.accessors!.push({ bufferView: view(), componentType: 5126, count: 1, type: 'SCALAR' }) - 1,
      ];
      extension = { propertyTables: [{ properties: { p: { values } } }], outline: { indices } };
      json.extensionsUsed = [...(json.extensionsUsed ?? []), 'EXT_structural_metadata'];
      json.extensions = { EXT_structural_metadata: extension };
      glb.bin = new Uint8Array(Buffer.concat([glb.bin, Buffer.from(Float32Array.of(42).buffer)]));
      json.buffers![0]!.byteLength = glb.bin.length;
    });
    await ok(`transfer metadata.glb --cage cage.glb -o metadata-out.glb${flags && ' '}${flags}`);
    const { json, bin } = unpackGlb(readFileSync('metadata-out.glb'));
    assert.deepEqual(json.extensions!['EXT_structural_metadata'], extension);
    assert.equal(json.accessors![indices]!.bufferView, values + 1);
    assert.equal(Buffer.from(bin).readFloatLE(json.bufferViews![values]!.byteOffset), 42);
  }
});

for (const form of ['keep', 'meshopt', 'draco'])
  test(`a file with an unknown extension does not grow by further transfers, once it is written with --compress ${form}`, async () => {
    writeChanged('ngon-0.glb', readFileSync('target.glb'), (json) => (json.extensionsUsed = ['FB_ngon_encoding']));
    const sizes = [];
    for (const n of [1, 2, 3]) {
      const line = `transfer ngon-${n - 1}.glb --cage cage.glb -o ngon-${n}.glb --texture paint.png --compress`;
      await ok(`${line} ${n === 1 ? form : 'keep'}`);
      const { accessors, bufferViews, images } = jsonOf(`ngon-${n}.glb`);
      const counts = [accessors, bufferViews, images].map((list) => list!.length);
      sizes.push({ counts, size: statSync(`ngon-${n}.glb`).size });
    }
    for (const { counts, size } of sizes.slice(1)) {
      assert.deepEqual(counts, sizes[0]!.counts);
      assert.ok(size < 1.01 * sizes[0]!.size, `${size} bytes, ${sizes[0]!.size} at first`);
    }
  });

test('a file does not grow by further transfers, whatever the length of the texture', async () => {
  const paint = readFileSync('paint.png');
  for (const more of [1, 2, 3]) {
    write('odd.png', Buffer.concat([paint, Buffer.alloc(((4 - (paint.length % 4)) % 4) + more)]));
    copyFileSync('target.glb', 'odd.glb');
    const sizes = [];
    for (let n = 0; n < 3; ++n) {
      await ok('transfer odd.glb --cage cage.glb --texture odd.png -o odd-out.glb');
      copyFileSync('odd-out.glb', 'odd.glb');
      sizes.push(statSync('odd.glb').size);
    }
    assert.deepEqual(sizes, Array(3).fill(sizes[0]));
  }
});

test('the joined buffer is not marked as a fallback', async () => {
  writeChanged('stand-in.glb', glbOf(target), (json) => {
    json.extensionsUsed = [kForms.meshopt];
    json.buffers![0]!.extensions = { [kForms.meshopt]: { fallback: true } };
  });
  await ok('transfer stand-in.glb --cage cage.glb -o stand-in-out.glb');
  assert.deepEqual(
    jsonOf('stand-in-out.glb').buffers!.map(({ extensions }) => extensions),
    [undefined],
  );
});

const formats = process.env['CAGECAST_ASSETS'] && join(process.env['CAGECAST_ASSETS'], 'formats');
for (const name of formats ? readdirSync(formats) : [])
  test(`${name} opens, stays compressed, and is valid`, async () => {
    await ok(`transfer ${join(formats!, name)} --cage cage.glb --texture paint.png -o format.glb`);
    assert.deepEqual(await validate('format.glb'), []);
    assert.ok(jsonOf('format.glb').extensionsRequired!.some((extension) => /draco|meshopt/.test(extension)));
    await ok('transfer format.glb --cage cage.glb');
  });
