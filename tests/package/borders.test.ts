import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import {
  classify,
  cutBorders,
  init,
  type Mesh,
  project,
  type TransferOptions,
  type TransferResult,
  transfer,
  Zone,
} from 'cagecast';
import { cagecast } from 'cagecast/gltf';
import { applyTransfer } from 'cagecast/three';
import {
  BufferAttribute,
  BufferGeometry,
  DataUtils,
  Float16BufferAttribute,
  MeshStandardMaterial,
  Mesh as ThreeMesh,
  Vector3,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { richFile } from '../support/files/rich.js';
import { glbOf } from '../support/gltf.js';
import { head } from './scenes.js';

before(init);

describe('cutBorders', () => {
  const { cage, target } = head(1);

  for (const seams of ['vertex', 'corner'] as const) {
    test(`gives every array its documented type and length: ${seams}`, async () => {
      const cut = cutBorders(cage, target, transfer(cage, target, { seams }), { seams });
      const vertices = target.positions.length / 3 + cut.sources.length / 3;
      const triangles = cut.indices.length / 3;
      assert.ok(triangles > target.indices.length / 3);
      const lengths = {
        sources: cut.weights.length,
        weights: cut.sources.length,
        indices: 3 * triangles,
        triangles,
        uvs: 2 * vertices,
        cornerUvs: seams === 'corner' ? 6 * triangles : 0,
        zones: vertices,
        cosmeticTriangles: triangles,
      };
      assert.deepEqual(Object.fromEntries(Object.entries(cut).map(([name, { length }]) => [name, length])), lengths);
      for (const name of ['sources', 'indices', 'triangles'] as const) assert.ok(cut[name] instanceof Uint32Array);
      for (const name of ['weights', 'uvs', 'cornerUvs'] as const) assert.ok(cut[name] instanceof Float32Array);
      assert.ok(
        cut.triangles.every((t, i) => t < target.indices.length / 3 && (i === 0 || t >= cut.triangles[i - 1]!)),
      );
      assert.ok(cut.zones.every((zone) => zone <= Zone.Culled) && cut.cosmeticTriangles.some((one) => one === 1));
    });
  }

  test('what transfer excluded by a lock stays excluded', async () => {
    const parts = { exclude: [0] };
    const result = transfer(cage, target, { parts });
    const cut = cutBorders(cage, target, result, { parts });
    const isOfLocked = (t: number) => target.groups![target.indices[3 * t]!] === 0;
    assert.equal(cut.triangles.filter((t, i) => isOfLocked(t) && cut.cosmeticTriangles[i] === 1).length, 0);
    assert.ok(transfer(cage, target).cosmeticTriangles.some((one, t) => isOfLocked(t) && one === 1));
  });

  test('a result of another target, or none, is an error', () => {
    const result = transfer(cage, target);
    const whole = 'resultMismatch';
    for (const [given, code, message] of [
      [undefined, 'badArgument', /^cutBorders: result is undefined; pass what transfer\(\) returned$/],
      [{ ...result, zones: [] }, 'badArgument', /result\.zones is of type Array, not a Uint8Array/],
      [{ ...result, zones: result.zones.slice(1) }, whole, /result\.zones has \d+ entries, not 1 for each of \d+ vert/],
      [{ ...result, zones: result.zones.map(() => 200) }, whole, /result\.zones\[0\] = 200 is not a zone \(0\.\.3\)/],
      [{ ...result, segmentStats: [] }, whole, /result\.segments\[0\] = 0 is out of range \(0 segments\)/],
    ] as const)
      assert.throws(() => cutBorders(cage, target, given as TransferResult), { name: 'CagecastError', code, message });
    assert.throws(
      () => cutBorders({ ...cage, positions: cage.positions.map((x, i) => (i === 0 ? NaN : x)) }, target, result),
      /cutBorders: cage\.positions\[0\] = NaN is not a finite number/,
    );
    assert.throws(
      () => cutBorders(cage, target, result, { threshold: 2 }),
      /cutBorders: options\.threshold = 2 is not within 0\.\.1/,
    );
    // @ts-expect-error no such option
    assert.throws(() => cutBorders(cage, target, result, { treshold: 1 }), { code: 'badOption' });
  });
});

Object.assign(globalThis, { self: globalThis }); // which GLTFLoader expects

describe('geometries of three.js with borders: cut', () => {
  const { cage, target } = head(2, 10);
  const vertices = target.positions.length / 3;
  const plain = { ...target, groups: undefined };
  const material = new MeshStandardMaterial();
  const geometryOf = ({ positions, indices, uvs }: Mesh) => {
    const geometry = new BufferGeometry()
      .setIndex(new BufferAttribute(Uint32Array.from(indices), 1))
      .setAttribute('position', new BufferAttribute(positions.slice(), 3));
    return uvs ? geometry.setAttribute('uv', new BufferAttribute(uvs.slice(), 2)) : geometry;
  };
  const count = (flags: Uint8Array) => flags.filter((one) => one === 1).length;

  /** glTF's attributes by three's names. */
  const semantics: Record<string, string> = {
    position: 'POSITION',
    normal: 'NORMAL',
    tangent: 'TANGENT',
    color: 'COLOR_0',
    uv: 'TEXCOORD_0',
    uv1: 'TEXCOORD_1',
    skinIndex: 'JOINTS_0',
    skinWeight: 'WEIGHTS_0',
    _heat: '_HEAT',
    _ncz: '_NCZ',
  };
  const close = (a: ArrayLike<number>, b: ArrayLike<number>, what: string) => {
    assert.equal(a.length, b.length, what);
    // UVs are in 16 bits in files.
    const [unit, most] = b instanceof Uint16Array && what.startsWith('uv') ? [65535, 0.501 / 65535] : [1, 1e-6];
    for (let i = 0; i < a.length; ++i)
      assert.ok(Math.abs(a[i]! - b[i]! / unit) <= most, `${what}[${i}]: ${a[i]} is not ${b[i]}`);
  };

  for (const kind of ['skinned', 'mirrored'] as const) {
    test(`become what a document of the same file becomes: ${kind}`, async () => {
      const glb = richFile(target, kind);
      const load = async (bytes: Uint8Array) =>
        (await new GLTFLoader().parseAsync(Uint8Array.from(bytes).buffer, '')).scene;
      const [scene, around] = await Promise.all([glb, glbOf(cage)].map(load));
      const document = await new NodeIO().readBinary(glb);
      await document.transform(cagecast({ cage, borders: 'cut' }));
      const [base] = document.getRoot().listMeshes()[0]!.listPrimitives();
      const { overlays, parts, cutTriangles } = applyTransfer(scene!, { cage: around!, material, borders: 'cut' });
      const { geometry } = parts[0]!;
      assert.ok(cutTriangles > 20);
      assert.equal(geometry.index!.count, target.indices.length + 3 * cutTriangles);
      assert.deepEqual([...geometry.index!.array], [...base!.getIndices()!.getArray()!]);
      for (const [name, attribute] of Object.entries(geometry.attributes))
        close(attribute.array, base!.getAttribute(semantics[name]!)!.getArray()!, name);
      const deltas = base!.listTargets()[0]!;
      for (const name of ['position', 'normal'] as const)
        close(
          geometry.morphAttributes[name]![0]!.array,
          deltas.getAttribute(semantics[name]!)!.getArray()!,
          `delta of ${name}`,
        );
      assert.equal(overlays[0]!.geometry.getAttribute('position'), geometry.getAttribute('position'));
    });
  }

  test('are blended in half floats and in morphs that are no deltas; groups and the range that is drawn follow', () => {
    const corners = target.indices.length;
    const geometry = geometryOf(target);
    const heat = Float32Array.from({ length: vertices }, (_, v) => v / vertices);
    geometry.setAttribute('heat', new Float16BufferAttribute(Uint16Array.from(heat, DataUtils.toHalfFloat), 1));
    const normals = Float32Array.from(target.positions);
    for (let v = 0; v < vertices; ++v)
      new Vector3()
        .fromArray(normals, 3 * v)
        .normalize()
        .toArray(normals, 3 * v);
    geometry.setAttribute('normal', new BufferAttribute(normals.slice(), 3));
    const twice = target.positions.map((x) => 2 * x);
    geometry.morphAttributes = {
      normal: [new BufferAttribute(normals.slice(), 3)],
      position: [new BufferAttribute(twice, 3)],
    };
    const middle = 3 * Math.floor(corners / 6);
    geometry.addGroup(0, middle, 0);
    geometry.addGroup(middle, Infinity, 1);
    geometry.setDrawRange(middle, corners - middle);
    const { result, cutTriangles } = applyTransfer(geometry, { cage: geometryOf(cage), borders: 'cut' });
    const cut = cutBorders(cage, plain, result);
    assert.equal(cutTriangles, cut.triangles.length - corners / 3);
    const pieces = cut.triangles.findIndex((t) => t >= middle / 3);
    const rest = { start: 3 * pieces, count: cut.indices.length - 3 * pieces };
    assert.deepEqual(geometry.groups, [
      { start: 0, count: 3 * pieces, materialIndex: 0 },
      { ...rest, materialIndex: 1 },
    ]);
    assert.deepEqual(geometry.drawRange, rest);
    const vectorAt = (attribute: unknown, v: number) =>
      new Vector3().fromBufferAttribute(attribute as BufferAttribute, v);
    for (let n = 0; n < cut.sources.length / 3; ++n) {
      const expected = [0, 1, 2].reduce((sum, j) => sum + cut.weights[3 * n + j]! * heat[cut.sources[3 * n + j]!]!, 0);
      assert.ok(Math.abs(geometry.getAttribute('heat').getX(vertices + n) - expected) < 1e-3);
      const { normal, position } = geometry.morphAttributes;
      assert.ok(Math.abs(vectorAt(normal![0], vertices + n).length() - 1) < 1e-6);
      const at = vectorAt(geometry.getAttribute('position'), vertices + n);
      assert.ok(at.multiplyScalar(2).distanceTo(vectorAt(position![0], vertices + n)) < 1e-6);
    }
  });

  test('show another classification on the pieces, and on whole triangles in segments with another verdict', () => {
    const mesh = new ThreeMesh(geometryOf(target), material);
    const projection = project(cage, plain);
    const { result, overlays, setClassification } = applyTransfer(mesh, {
      cage: geometryOf(cage),
      material,
      borders: 'cut',
    });
    const shown = () => overlays[0]!.geometry.index!.count / 3;
    const painted = count(cutBorders(cage, plain, result).cosmeticTriangles);
    assert.equal(shown(), painted);
    const [skin, eye] = [result.segments[0]!, result.segments[vertices - 1]!];
    assert.ok(!result.segmentStats[skin]!.culled && result.segmentStats[eye]!.culled);
    setClassification(classify(projection, { locks: { [skin]: 'exclude' } }));
    assert.equal(shown(), 0);
    assert.notEqual(mesh.geometry.getAttribute('_ncz').getX(0), Zone.Cosmetic);
    setClassification(classify(projection));
    assert.equal(shown(), painted);
    const locks = Object.fromEntries(result.segmentStats.map((_, s) => [s, 'keep' as const]));
    const kept = classify(projection, { locks });
    setClassification(kept);
    const isMore = (one: number, t: number) =>
      one === 1 && result.segmentStats[result.segments[target.indices[3 * t]!]!]!.culled;
    const more = kept.cosmeticTriangles.filter(isMore).length;
    assert.ok(more > 0);
    assert.equal(shown(), painted + more);
  });

  test('segments excluded later have no painted piece, segments kept later no bare one', () => {
    // Points that are hidden or uncovered never change to or from "culled".
    const projection = project(cage, plain);
    const only = (lock: 'exclude' | 'keep') => Object.fromEntries(projection.segmentStats.map((_, s) => [s, lock]));
    const bare = only('exclude');
    const shownAfter = (locks: TransferOptions['locks'], later: TransferOptions['locks']) => {
      const mesh = new ThreeMesh(geometryOf(plain), material);
      const { overlays, setClassification } = applyTransfer(mesh, {
        cage: geometryOf(cage),
        material,
        borders: 'cut',
        locks,
      });
      setClassification(classify(projection, { locks: later }));
      const zones = mesh.geometry.getAttribute('_ncz').array;
      return {
        triangles: overlays[0]!.geometry.index!.count / 3,
        vertices: zones.filter((zone) => zone === Zone.Cosmetic).length,
      };
    };
    assert.deepEqual(shownAfter({}, bare), { triangles: 0, vertices: 0 });
    assert.equal(shownAfter(bare, {}).triangles, count(classify(projection).cosmeticTriangles));
  });

  test('a cage that cannot be used is an error, and nothing is changed', () => {
    const geometry = geometryOf(target);
    assert.throws(() => applyTransfer(geometry, { cage: new BufferGeometry(), borders: 'cut' }), { code: 'emptyMesh' });
    assert.deepEqual(Object.keys(geometry.attributes), ['position', 'uv']);
  });
});
