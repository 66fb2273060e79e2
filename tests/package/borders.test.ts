import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import {
  CagecastError,
  type CutTarget,
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
  Triangle,
  Vector3,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { glbOf } from '../support/gltf.js';
import { richFile } from '../support/rich-files.js';
import { head, readPlain } from './scenes.js';

before(init);

/** The target as it was cut. */
function meshOf(target: Mesh, { sources, weights, indices }: CutTarget): Mesh {
  const own = target.positions.length;
  const positions = new Float32Array(own + sources.length);
  positions.set(target.positions);
  for (let i = 0; i < sources.length; i += 3) {
    for (let k = 0; k < 3; ++k)
      positions[own + i + k] = [0, 1, 2].reduce(
        (sum, j) => sum + weights[i + j]! * target.positions[3 * sources[i + j]! + k]!,
        0,
      );
  }
  return { positions, indices };
}

const vertex = ({ positions }: Mesh, v: number) => new Vector3(...positions.subarray(3 * v, 3 * v + 3));
const corners = (mesh: Mesh, t: number) =>
  new Triangle(...([0, 1, 2].map((k) => vertex(mesh, mesh.indices[3 * t + k]!)) as [Vector3, Vector3, Vector3]));
const cross = (a: Vector3, b: Vector3) => new Vector3().crossVectors(a, b);

/** Tells of places whether they are beyond the rims of a cage: nearest to an open edge of it. */
function beyond(cage: Mesh, places: Vector3[], diagonal: number): boolean[] {
  const name = (v: number) => cage.positions.subarray(3 * v, 3 * v + 3).join();
  const key = (a: number, b: number) => [name(a), name(b)].sort().join(';');
  const uses = new Map<string, number>();
  const ends = (t: number, k: number) => [cage.indices[3 * t + k]!, cage.indices[3 * t + ((k + 1) % 3)]!] as const;
  for (let i = 0; i < cage.indices.length; ++i) {
    const edge = key(...ends(Math.floor(i / 3), i % 3));
    uses.set(edge, (uses.get(edge) ?? 0) + 1);
  }
  const probes = {
    positions: Float32Array.from(places.flatMap(({ x, y, z }) => [x, y, z])),
    indices: Uint32Array.from({ length: 3 * Math.ceil(places.length / 3) }, (_, i) => Math.min(i, places.length - 1)),
  };
  const { triangles } = project(cage, probes, { preset: 'paper' });
  return places.map((place, i) => {
    const nearest = corners(cage, triangles[i]!).closestPointToPoint(place, new Vector3());
    return [0, 1, 2].some((k) => {
      const [a, b] = ends(triangles[i]!, k);
      if (uses.get(key(a, b)) !== 1) return false;
      const [from, to] = [vertex(cage, a), vertex(cage, b)];
      const along = to.clone().sub(from);
      return cross(along, nearest.clone().sub(from)).length() <= 1e-6 * diagonal * along.length();
    });
  });
}

/**
 * Of the places in the middle of edges where paint ends at a hole, the share that has, nearer than 0.1 % of the diagonal, one
 * on the other side of the projected rim; and how many there are.
 */
function straightness(cage: Mesh, mesh: Mesh, painted: Uint8Array, diagonal: number): { share: number; count: number } {
  const edges = new Map<string, number[]>();
  for (let i = 0; i < mesh.indices.length; ++i) {
    const ends = [i, i - (i % 3) + ((i + 1) % 3)].map((c) =>
      mesh.positions.subarray(3 * mesh.indices[c]!, 3 * mesh.indices[c]! + 3).join(),
    );
    const list = edges.get(ends.sort().join(';')) ?? [];
    edges.set(ends.join(';'), [...list, i]);
  }
  const borders = [...edges.values()].flatMap((list) => {
    const [outer, inner] = [0, 1].map((isPainted) => list.find((i) => painted[Math.floor(i / 3)] === isPainted));
    return outer === undefined || inner === undefined ? [] : [[outer, inner]];
  });
  const middles = borders.map(([outer]) => corners(mesh, Math.floor(outer! / 3)).getMidpoint(new Vector3()));
  const isAtHole = beyond(cage, middles, diagonal);
  const atHoles = borders.filter((_, i) => isAtHole[i]);
  const places = atHoles.flatMap((both) => {
    const [a, b] = [0, 1].map((k) => vertex(mesh, mesh.indices[both[0]! - (both[0]! % 3) + ((both[0]! + k) % 3)]!));
    const middle = a!.clone().add(b!).divideScalar(2);
    const along = b!.clone().sub(a!).normalize();
    const around = both.flatMap((i) => {
      const across = cross(corners(mesh, Math.floor(i / 3)).getNormal(new Vector3()), along).normalize();
      const at = (r: number, angle: number) =>
        middle
          .clone()
          .addScaledVector(along, r * diagonal * Math.cos(angle))
          .addScaledVector(across, r * diagonal * Math.sin(angle));
      return Array.from({ length: 20 }, (_, n) => (n + 1) * 5e-5).flatMap((r) =>
        Array.from({ length: 32 }, (_, n) => at(r, (n * Math.PI) / 16)),
      );
    });
    return [middle, ...around];
  });
  const sides = beyond(cage, places, diagonal);
  const each = places.length / atHoles.length;
  const near = atHoles.filter((_, i) =>
    sides.slice(each * i + 1, each * (i + 1)).some((side) => side !== sides[each * i]),
  );
  return { share: near.length / atHoles.length, count: atHoles.length };
}

function diagonalOf({ positions }: Mesh): number {
  const range = (k: number) => {
    const values = Array.from(positions.filter((_, i) => i % 3 === k));
    return values.reduce((a, b) => Math.max(a, b)) - values.reduce((a, b) => Math.min(a, b));
  };
  return Math.hypot(range(0), range(1), range(2));
}

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
      assert.ok(cut.indices.every((v) => v < vertices) && cut.sources.every((v) => v < target.positions.length / 3));
      for (let i = 0; i < cut.weights.length; i += 3)
        assert.equal(cut.weights[i]! + cut.weights[i + 1]! + cut.weights[i + 2]!, 1);
      assert.ok(
        cut.triangles.every((t, i) => t < target.indices.length / 3 && (i === 0 || t >= cut.triangles[i - 1]!)),
      );
      assert.ok(cut.zones.every((zone) => zone <= Zone.Culled) && cut.cosmeticTriangles.some((one) => one === 1));
    });
  }

  test('paint on the lizard ends at the projected boundary loops of the cage, within 0.1 % of the diagonal', async (context) => {
    const [lizardCage, lizard] = (await Promise.all(
      ['cage', 'target'].map((name) => readPlain(`examples/samples/lizard/${name}.glb`)),
    )) as [Mesh, Mesh];
    const result = transfer(lizardCage, lizard);
    const cut = cutBorders(lizardCage, lizard, result);
    const diagonal = diagonalOf(lizard);
    const before = straightness(lizardCage, lizard, result.cosmeticTriangles, diagonal);
    const after = straightness(lizardCage, meshOf(lizard, cut), cut.cosmeticTriangles, diagonal);
    context.diagnostic(
      `of ${after.count} places ${after.share}; of ${before.count} uncut ${before.share}; ${cut.indices.length / 3 - lizard.indices.length / 3} triangles more`,
    );
    assert.ok(after.count > 100);
    assert.equal(after.share, 1);
    assert.ok(before.share < 0.5);
  });

  test('what transfer excluded by a lock stays excluded', async () => {
    const locks = { groups: { 0: 'exclude' } } as const;
    const result = transfer(cage, target, { locks });
    const cut = cutBorders(cage, target, result, { locks });
    const isOfLocked = (t: number) => target.groups![target.indices[3 * t]!] === 0;
    assert.equal(cut.triangles.filter((t, i) => isOfLocked(t) && cut.cosmeticTriangles[i] === 1).length, 0);
    assert.ok(transfer(cage, target).cosmeticTriangles.some((one, t) => isOfLocked(t) && one === 1));
  });

  test('a result of another target, or none, is an error', () => {
    const result = transfer(cage, target);
    const code = (given: unknown, expected: string, message: RegExp) =>
      assert.throws(
        () => cutBorders(cage, target, given as TransferResult),
        (error: unknown) => error instanceof CagecastError && error.code === expected && message.test(error.message),
      );
    code(undefined, 'badArgument', /^cutBorders: result is undefined; pass what transfer\(\) returned$/);
    code({ ...result, zones: [] }, 'badArgument', /result\.zones is of type Array, not a Uint8Array/);
    code(
      { ...result, zones: result.zones.slice(1) },
      'resultMismatch',
      /result\.zones has \d+ entries, not 1 for each of \d+ vertices of target/,
    );
    code(
      { ...result, zones: result.zones.map((zone, v) => (v === 7 ? 200 : zone)) },
      'resultMismatch',
      /result\.zones\[7\] = 200 is not a zone \(0\.\.3\)/,
    );
    code({ ...result, segmentStats: [] }, 'resultMismatch', /result\.segments\[0\] = 0 is out of range \(0 segments\)/);
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
      const { overlays, parts, cutTriangles } = applyTransfer(scene!, around!, { material, borders: 'cut' });
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
    const { result, cutTriangles } = applyTransfer(geometry, geometryOf(cage), { borders: 'cut' });
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
    const { result, overlays, update } = applyTransfer(mesh, geometryOf(cage), { material, borders: 'cut' });
    const shown = () => overlays[0]!.geometry.index!.count / 3;
    const painted = count(cutBorders(cage, plain, result).cosmeticTriangles);
    assert.equal(shown(), painted);
    const [skin, eye] = [result.segments[0]!, result.segments[vertices - 1]!];
    assert.ok(!result.segmentStats[skin]!.culled && result.segmentStats[eye]!.culled);
    update(classify(projection, { locks: { segments: { [skin]: 'exclude' } } }));
    assert.equal(shown(), 0);
    assert.notEqual(mesh.geometry.getAttribute('_ncz').getX(0), Zone.Cosmetic);
    update(classify(projection));
    assert.equal(shown(), painted);
    const segments = Object.fromEntries(result.segmentStats.map((_, s) => [s, 'keep' as const]));
    const kept = classify(projection, { locks: { segments } });
    update(kept);
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
    const bare = { segments: only('exclude') };
    const shownAfter = (locks: TransferOptions['locks'], later: TransferOptions['locks']) => {
      const mesh = new ThreeMesh(geometryOf(plain), material);
      const { overlays, update } = applyTransfer(mesh, geometryOf(cage), { material, borders: 'cut', locks });
      update(classify(projection, { locks: later }));
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
    assert.throws(() => applyTransfer(geometry, new BufferGeometry(), { borders: 'cut' }), { code: 'emptyMesh' });
    assert.deepEqual(Object.keys(geometry.attributes), ['position', 'uv']);
  });
});
