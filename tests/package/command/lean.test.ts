import assert from 'node:assert/strict';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { type Document, type GLTF, NodeIO, type Primitive } from '@gltf-transform/core';
import { ALL_EXTENSIONS, KHRDracoMeshCompression } from '@gltf-transform/extensions';
import { meshopt, quantize } from '@gltf-transform/functions';
import { init, type TransferResult, transfer } from 'cagecast';
import draco from 'draco3dgltf';
import { MeshoptDecoder, MeshoptEncoder } from 'meshoptimizer';
import { PNG } from 'pngjs';
import { cagecast, GlbMaker, glbOf, packGlb, unpackGlb, validate } from '../../support/gltf.js';
import { temporaryFolder } from '../../support/temporary.js';
import { ball, head } from '../scenes.js';

const { at } = temporaryFolder('lean');
const scene = head(3, 24);
const target = { ...scene.target, groups: undefined };
let io: NodeIO;
let result: TransferResult;

before(async () => {
  await Promise.all([init(), MeshoptDecoder.ready, MeshoptEncoder.ready]);
  io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
    'meshopt.decoder': MeshoptDecoder,
    'meshopt.encoder': MeshoptEncoder,
    'draco3d.decoder': await draco.createDecoderModule(),
    'draco3d.encoder': await draco.createEncoderModule(),
  });
  result = transfer(scene.cage, target);
  writeFileSync(at('cage.glb'), glbOf(scene.cage));
  writeFileSync(at('target.glb'), glbOf(target));
  writeFileSync(at('paint.png'), PNG.sync.write(new PNG({ width: 4, height: 4 })));
});

/** Transfers to a file and returns what is written: as it stands, and decoded. */
async function written(name: string, ...flags: string[]) {
  const out = at(`out-${name}`);
  const { status, stdout, stderr } = cagecast('transfer', at(name), '--cage', at('cage.glb'), '-o', out, ...flags);
  assert.equal(status, 0, stderr);
  assert.equal(stderr, '');
  assert.match(stdout, /^[^\n]*: [\d,]+ vertices/, 'nothing else is printed');
  // A UV set that no material uses is what the command adds; the validator cannot see into what is compressed.
  for (const issue of await validate(out, 2))
    assert.match(issue, /TEXCOORD_\d+: UNUSED_OBJECT|UNSUPPORTED_EXTENSION|bufferViews\/\d+: UNUSED_OBJECT/);
  if (!/draco/.test([name, ...flags].join()))
    assert.ok(!(await validate(out, 2)).some((issue) => /bufferViews/.test(issue)));
  return { json: unpackGlb(readFileSync(out)).json, document: await io.read(out), ratio: ratio(out, at(name)) };
}

const ratio = (out: string, from: string): number => statSync(out).size / statSync(from).size;

/** A file in another form. */
async function converted(name: string, change: (document: Document) => Promise<unknown>): Promise<void> {
  const document = await io.read(at('target.glb'));
  await change(document);
  await io.write(at(name), document);
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
    for (let y = Math.ceil(Math.min(...bounds(1))); y <= Math.max(...bounds(1)); ++y) {
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
  }
  return colors;
}

/** The picture that the arrays of the transfer make. */
const computed = (): Uint8Array =>
  picture(
    Array.from(target.indices, (v, i) => ({
      position: [...target.positions.slice(3 * v, 3 * v + 3)],
      uv: result.cosmeticTriangles[Math.floor(i / 3)] === 1 ? [...result.cornerUvs.slice(2 * i, 2 * i + 2)] : undefined,
    })),
  );

/** The picture that a file makes. */
function shown(document: Document): Uint8Array {
  const corners: Corner[] = [];
  for (const node of document.getRoot().listNodes()) {
    const m = node.getWorldMatrix();
    for (const primitive of node.getMesh()?.listPrimitives() ?? []) {
      const isOverlay = primitive.getExtras()['cagecastOverlay'] === true;
      for (const v of primitive.getIndices()!.getArray()!) {
        const [x = 0, y = 0, z = 0] = primitive.getAttribute('POSITION')!.getElement(v, []);
        corners.push({
          position: [0, 1, 2].map((k) => m[k]! * x + m[4 + k]! * y + m[8 + k]! * z + m[12 + k]!),
          uv: isOverlay ? primitive.getAttribute('TEXCOORD_0')!.getElement(v, []) : undefined,
        });
      }
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
function plainPicture(): Promise<Uint8Array> {
  plain ??= written('target.glb', '--texture', at('paint.png')).then(({ document }) => shown(document));
  return plain;
}

const arrays = (primitive: Primitive) =>
  [...primitive.listSemantics()].map((semantic) => [semantic, primitive.getAttribute(semantic)!] as const);

describe('files stay lean', () => {
  test('nothing that is replaced stays in the file; UVs take four bytes, zones a byte or less', async () => {
    const { json, document, ratio } = await written('target.glb');
    assert.ok(ratio < 1.35, `${ratio}`);
    const used = new Set(
      json.accessors!.flatMap((accessor) => [
        accessor.bufferView,
        accessor.sparse?.indices.bufferView,
        accessor.sparse?.values.bufferView,
      ]),
    );
    assert.deepEqual(
      json.bufferViews!.map((_, v) => v).filter((v) => !used.has(v)),
      [],
    );
    const bytes = json.bufferViews!.reduce((sum, { byteLength }) => sum + Math.ceil(byteLength / 4) * 4, 0);
    assert.equal(Math.ceil(json.buffers![0]!.byteLength / 4) * 4, bytes);
    const [primitive] = document.getRoot().listMeshes()[0]!.listPrimitives();
    assert.equal(primitive!.getAttribute('TEXCOORD_1')!.getArray()!.constructor, Uint16Array);
    assert.equal(primitive!.getAttribute('_NCZ')!.getArray()!.constructor, Uint8Array);
  });

  test('views and accessors to which an unknown extension may refer keep their numbers', () => {
    const { json, bin } = unpackGlb(readFileSync(at('target.glb')));
    const view = () => json.bufferViews!.push({ buffer: 0, byteOffset: bin.length, byteLength: 4 }) - 1;
    const [values, bufferView] = [view(), view()];
    const indices = json.accessors!.push({ bufferView, componentType: 5126, count: 1, type: 'SCALAR' }) - 1;
    const extension = { propertyTables: [{ properties: { p: { values } } }], outline: { indices } };
    json.extensionsUsed = [...(json.extensionsUsed ?? []), 'EXT_structural_metadata'];
    json.extensions = { ...json.extensions, EXT_structural_metadata: extension };
    const all = Buffer.concat([bin, new Uint8Array(Float32Array.of(42).buffer)]);
    json.buffers![0]!.byteLength = all.length;
    writeFileSync(at('metadata.glb'), packGlb({ json, bin: all }));
    const { status, stderr } = cagecast(
      ...[
        'transfer',
        at('metadata.glb'),
        '--cage',
        at('cage.glb'),
        '--compress',
        'draco',
        '-o',
        at('metadata-out.glb'),
      ],
    );
    assert.deepEqual([status, stderr], [0, '']);
    const out = unpackGlb(readFileSync(at('metadata-out.glb')));
    assert.deepEqual(out.json.extensions!['EXT_structural_metadata'], extension);
    assert.equal(out.json.accessors![indices]!.bufferView, bufferView);
    assert.equal(Buffer.from(out.bin).readFloatLE(out.json.bufferViews![values]!.byteOffset), 42);
  });

  for (const form of ['keep', 'meshopt', 'draco'])
    test(`a file with an unknown extension does not grow by further transfers, once it is written with --compress ${form}`, () => {
      const { json, bin } = unpackGlb(readFileSync(at('target.glb')));
      json.extensionsUsed = [...(json.extensionsUsed ?? []), 'FB_ngon_encoding'];
      writeFileSync(at('ngon-0.glb'), packGlb({ json, bin }));
      const sizes = [1, 2, 3].map((n) => {
        const [from, out] = [at(`ngon-${n - 1}.glb`), at(`ngon-${n}.glb`)];
        const flags = ['--texture', at('paint.png'), '--compress', n === 1 ? form : 'keep'];
        const { status, stderr } = cagecast('transfer', from, '--cage', at('cage.glb'), '-o', out, ...flags);
        assert.deepEqual([status, stderr], [0, '']);
        const { accessors, bufferViews, images } = unpackGlb(readFileSync(out)).json;
        return { counts: [accessors, bufferViews, images].map((list) => list!.length), size: statSync(out).size };
      });
      for (const { counts, size } of sizes.slice(1)) {
        assert.deepEqual(counts, sizes[0]!.counts);
        assert.ok(size < 1.01 * sizes[0]!.size, `${size} bytes, ${sizes[0]!.size} at first`);
      }
    });

  test('a file does not grow by further transfers, whatever the length of the texture', () => {
    const paint = readFileSync(at('paint.png'));
    for (const length of [1, 2, 3].map((more) => 4 * Math.ceil(paint.length / 4) + more)) {
      writeFileSync(at('odd.png'), Buffer.concat([paint, Buffer.alloc(length - paint.length)]));
      const sizes = ['target', 'odd-0', 'odd-1'].map((from, n) => {
        const [target, out] = [at(`${from}.glb`), at(`odd-${n}.glb`)];
        const { status, stderr } = cagecast(
          ...['transfer', target, '--cage', at('cage.glb'), '--texture', at('odd.png'), '-o', out],
        );
        assert.deepEqual([status, stderr], [0, '']);
        return statSync(out).size;
      });
      assert.deepEqual(sizes, Array<number>(3).fill(sizes[0]!), `a texture of ${length} bytes`);
    }
  });

  test('what an unknown extension refers to keeps its number when a transfer adds less than it replaces', () => {
    const transferTo = (from: string, out: string, ...flags: string[]) => {
      const { status, stderr } = cagecast('transfer', at(from), '--cage', at('cage.glb'), '-o', at(out), ...flags);
      assert.deepEqual([status, stderr], [0, '']);
    };
    transferTo('target.glb', 'outline-0.glb', '--texture', at('paint.png'));
    const { json, bin } = unpackGlb(readFileSync(at('outline-0.glb')));
    const indices = json.accessors!.push({ componentType: 5126, count: 7, type: 'SCALAR' }) - 1;
    json.extensionsUsed = ['CESIUM_primitive_outline'];
    json.meshes![0]!.primitives[0]!.extensions = { CESIUM_primitive_outline: { indices } };
    writeFileSync(at('outline-1.glb'), packGlb({ json, bin }));
    transferTo('outline-1.glb', 'outline-2.glb');
    const out = unpackGlb(readFileSync(at('outline-2.glb'))).json;
    assert.equal(out.accessors![indices]!.count, 7);
    assert.ok(out.bufferViews!.length < json.bufferViews!.length, 'the image of the overlay is gone');
  });

  test('what shares a view with something that is replaced stays, without it', async () => {
    const maker = new GlbMaker();
    const other = ball([0, 0, 5], () => 0.2, 12, 16);
    const both = new Float32Array([...other.positions, ...target.positions]);
    const bufferView = maker.view(new Uint8Array(both.buffer), { target: 34962, byteStride: 12 });
    const part = (positions: Float32Array, indices: Uint32Array, byteOffset: number, isShown: boolean) => {
      const bound = (pick: (...values: number[]) => number) =>
        [0, 1, 2].map((k) =>
          positions.filter((_: number, i: number) => i % 3 === k).reduce((a: number, b: number) => pick(a, b)),
        );
      const POSITION =
        maker.json.accessors.push({
          bufferView,
          byteOffset,
          componentType: 5126,
          count: positions.length / 3,
          type: 'VEC3',
          min: bound(Math.min),
          max: bound(Math.max),
        } as GLTF.IAccessor) - 1;
      const primitives = [{ attributes: { POSITION }, indices: maker.accessor(indices, 'SCALAR') }];
      const node = maker.node({ mesh: maker.json.meshes.push({ primitives }) - 1 }, isShown);
      if (!isShown) maker.json.scenes!.push({ nodes: [node] });
    };
    part(other.positions as Float32Array, other.indices, 0, false); // in another scene
    part(target.positions as Float32Array, target.indices as Uint32Array, 4 * other.positions.length, true);
    writeFileSync(at('joined.glb'), maker.finish());
    const { json, document } = await written('joined.glb');
    const [first, second] = document
      .getRoot()
      .listMeshes()
      .map((mesh) => mesh.listPrimitives()[0]!.getAttribute('POSITION')!);
    assert.deepEqual(first!.getArray(), other.positions);
    assert.ok(second!.getCount() > target.positions.length / 3, 'vertices are split');
    const stored = 12 * (first!.getCount() + second!.getCount());
    const views = json.bufferViews!.filter(
      ({ target, byteLength }) => target === 34962 && byteLength > 4 * first!.getCount(),
    );
    assert.ok(views.reduce((sum, { byteLength }) => sum + byteLength, 0) <= stored + 4 * second!.getCount() * 2);
    assert.equal(
      Math.ceil(json.buffers![0]!.byteLength / 4) * 4,
      json.bufferViews!.reduce((sum, { byteLength }) => sum + Math.ceil(byteLength / 4) * 4, 0),
    );
  });

  test('the overlay has positions and triangles of its own, and nothing else', async () => {
    const { json, document } = await written('target.glb', '--texture', at('paint.png'));
    plain = Promise.resolve(shown(document));
    const [base, overlay] = json.meshes![0]!.primitives as [GLTF.IMeshPrimitive, GLTF.IMeshPrimitive];
    assert.equal(overlay.attributes['TEXCOORD_0'], base.attributes['TEXCOORD_1']);
    assertSamePicture(await plain, computed(), 0.03); // the overlay lies a little above the surface
  });

  test('UVs that 16 bits cannot hold are floats', async () => {
    writeFileSync(at('wide.glb'), glbOf({ ...scene.cage, uvs: scene.cage.uvs!.map((x) => 3 * x) }));
    assert.equal(cagecast('transfer', at('target.glb'), '--cage', at('wide.glb'), '-o', at('wide-out.glb')).status, 0);
    const [primitive] = (await io.read(at('wide-out.glb'))).getRoot().listMeshes()[0]!.listPrimitives();
    assert.equal(primitive!.getAttribute('TEXCOORD_1')!.getArray()!.constructor, Float32Array);
  });

  test('primitives that share vertices go on sharing them, and sparse morph targets stay sparse', async () => {
    const maker = new GlbMaker();
    const { indices, positions } = target;
    const count = positions.length / 3;
    const mesh = maker.mesh({ positions, indices: indices.slice(0, 3 * 500) });
    const primitive = maker.json.meshes[mesh]!.primitives[0]!;
    const moved = Uint16Array.from({ length: 20 }, (_, i) => 10 * i);
    const sparse = () => {
      const values = Float32Array.from({ length: 3 * moved.length }, (_, i) => i / 100);
      return (
        maker.json.accessors.push({
          componentType: 5126,
          count,
          type: 'VEC3',
          min: [0, 0, 0],
          max: [0.57, 0.58, 0.59],
          sparse: {
            count: moved.length,
            indices: { bufferView: maker.view(new Uint8Array(moved.buffer)), componentType: 5123 },
            values: { bufferView: maker.view(new Uint8Array(values.buffer)) },
          },
        } as unknown as GLTF.IAccessor) - 1
      );
    };
    primitive.targets = Array.from({ length: 8 }, () => ({ POSITION: sparse() }));
    const [second, third] = [indices.slice(3 * 500, 3 * 900), indices.slice(3 * 900)].map((own) => ({
      ...primitive,
      indices: maker.accessor(own, 'SCALAR'),
    }));
    maker.json.meshes[mesh]!.primitives.push(second!, third!);
    maker.node({ mesh });
    writeFileSync(at('shared.glb'), maker.finish());
    const { json, document, ratio } = await written('shared.glb');
    assert.ok(ratio < 1.4, `${ratio}`);
    const [a, b, c] = json.meshes![0]!.primitives;
    assert.deepEqual([b!.attributes, c!.attributes], [a!.attributes, a!.attributes]);
    assert.deepEqual([b!.targets, c!.targets], [a!.targets, a!.targets]);
    assert.ok(a!.targets!.every(({ POSITION }) => json.accessors![POSITION!]!.sparse !== undefined));
    // Every corner is where it was, moves as it did, and has the UV and the zone of its own primitive.
    const before = (await io.read(at('shared.glb'))).getRoot().listMeshes()[0]!.listPrimitives();
    document
      .getRoot()
      .listMeshes()[0]!
      .listPrimitives()
      .forEach((primitive, p) => {
        const old = before[p]!.getIndices()!.getArray()!;
        primitive
          .getIndices()!
          .getArray()!
          .forEach((vertex: number, i: number) => {
            const same = (now: Primitive, then: Primitive, semantic: string) =>
              assert.deepEqual(
                now.getAttribute(semantic)!.getElement(vertex, []),
                then.getAttribute(semantic)!.getElement(old[i]!, []),
              );
            same(primitive, before[p]!, 'POSITION');
            const [now, then] = [primitive.listTargets()[5]!, before[p]!.listTargets()[5]!];
            assert.deepEqual(
              now.getAttribute('POSITION')!.getElement(vertex, []),
              then.getAttribute('POSITION')!.getElement(old[i]!, []),
            );
          });
      });
  });

  test('a file that meshopt compressed is compressed again, and shows the same', async () => {
    await converted('meshopt.glb', (document) => document.transform(meshopt({ encoder: MeshoptEncoder })));
    const { json, document, ratio } = await written('meshopt.glb', '--texture', at('paint.png'));
    assert.ok(ratio < 2.4, `${ratio}`);
    const geometry = json.bufferViews!.filter(({ target }) => target !== undefined);
    assert.ok(geometry.length > 5);
    assert.ok(geometry.every(({ extensions }) => extensions?.['EXT_meshopt_compression']));
    assertSamePicture(shown(document), await plainPicture(), 0.01);
  });

  test('lines and small indices that share a view with triangles stay what they are with --compress meshopt', async () => {
    const maker = new GlbMaker();
    const attributes = { POSITION: maker.accessor(target.positions, 'VEC3') };
    const lines = [
      Uint32Array.of(0, 1, 1, 2, 2, 0), // as many as two triangles have
      Uint16Array.of(3, 1, 8, 5),
      Uint8Array.of(6, 2, 5, 0),
    ];
    const all = [Uint32Array.from(target.indices), ...lines];
    const bufferView = maker.view(Buffer.concat(all.map(({ buffer }) => Buffer.from(buffer))), { target: 34963 });
    let byteOffset = 0;
    const primitives = all.map(({ length: count, byteLength, BYTES_PER_ELEMENT }, i) => {
      const componentType = { 1: 5121, 2: 5123, 4: 5125 }[BYTES_PER_ELEMENT]!;
      const accessor = { bufferView, byteOffset, componentType, count, type: 'SCALAR' } as GLTF.IAccessor;
      byteOffset += byteLength;
      return { attributes, indices: maker.json.accessors.push(accessor) - 1, ...(i > 0 && { mode: 1 as const }) };
    });
    maker.node({ mesh: maker.json.meshes.push({ primitives }) - 1 });
    writeFileSync(at('lines.glb'), maker.finish());
    const { document } = await written('lines.glb', '--compress', 'meshopt');
    const kept = document.getRoot().listMeshes()[0]!.listPrimitives().slice(1);
    assert.deepEqual(
      kept.map((primitive) => primitive.getIndices()!.getArray()),
      lines,
    );
  });

  test('a file that Draco compressed is compressed again, and shows the same', async () => {
    await converted('draco.glb', async (document) =>
      document.createExtension(KHRDracoMeshCompression).setRequired(true),
    );
    const { json, document, ratio } = await written('draco.glb', '--texture', at('paint.png'));
    assert.ok(ratio < 3.2, `${ratio}`);
    const primitives = json.meshes![0]!.primitives;
    assert.equal(primitives.length, 2);
    assert.ok(primitives.every(({ extensions }) => extensions?.['KHR_draco_mesh_compression']));
    assert.ok(json.accessors!.every(({ bufferView }) => bufferView === undefined));
    assertSamePicture(shown(document), await plainPicture(), 0.01);
  });

  test('what Draco has rounded before stays where it was, and attributes of an own name keep their values', async () => {
    await converted('draco-ids.glb', async (document) => {
      document.createExtension(KHRDracoMeshCompression).setEncoderOptions({ quantizationBits: { GENERIC: 0 } });
      const [primitive] = document.getRoot().listMeshes()[0]!.listPrimitives();
      const ids = Float32Array.from({ length: target.positions.length / 3 }, (_, i) => 100_003 * i);
      primitive!.setAttribute('_ID', document.createAccessor().setArray(ids));
    });
    const positionsById = (document: Document): Map<number, number[]> => {
      const [primitive] = document.getRoot().listMeshes()[0]!.listPrimitives();
      const [ids, positions] = ['_ID', 'POSITION'].map((semantic) => primitive!.getAttribute(semantic)!);
      return new Map(
        Array.from(ids!.getArray() as Float32Array, (id, i): [number, number[]] => [id, positions!.getElement(i, [])]),
      );
    };
    const before = positionsById(await io.read(at('draco-ids.glb')));
    const after = positionsById((await written('draco-ids.glb')).document);
    assert.deepEqual([...after.keys()].sort(), [...before.keys()].sort());
    for (const [id, position] of after)
      position.forEach((x, k) => {
        const moved = Math.abs(x - before.get(id)![k]!);
        assert.ok(moved < 1e-6, `vertex ${id} moved by ${moved}`);
      });
  });

  test('what Draco cannot compress is stored as it is', async () => {
    const maker = new GlbMaker();
    maker.node({ mesh: maker.mesh(target) });
    const positions = new Float32Array([0, 0, 0.99, 0, 0, 0.99, 0, 0, 0.99]); // a triangle without an area
    maker.node({ mesh: maker.mesh({ positions, indices: new Uint32Array([0, 1, 2]) }) });
    writeFileSync(at('flat.glb'), maker.finish());
    const { json } = await written('flat.glb', '--compress', 'draco', '--texture', at('paint.png'));
    assert.ok(json.meshes![0]!.primitives.every(({ extensions }) => extensions));
    const [flat] = json.meshes![1]!.primitives;
    assert.equal(flat!.extensions, undefined);
    assert.ok(json.accessors![flat!.attributes['POSITION']!]!.bufferView !== undefined);
  });

  test('a quantised file stays quantised, the overlay as well, and shows the same', async () => {
    await converted('quantised.glb', (document) => document.transform(quantize()));
    const { document } = await written('quantised.glb', '--texture', at('paint.png'));
    for (const primitive of document.getRoot().listMeshes()[0]!.listPrimitives())
      for (const [semantic, accessor] of arrays(primitive))
        assert.ok(!(accessor.getArray() instanceof Float32Array), semantic);
    assertSamePicture(shown(document), await plainPicture(), 0.01);
  });
});
