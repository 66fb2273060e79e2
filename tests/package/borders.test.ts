import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { NodeIO, type Primitive } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import {
  CagecastError,
  type Classification,
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
import { cagecast as cagecastTransform } from 'cagecast/gltf';
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
import { assertNear, cagecast, GlbMaker, glbOf, storedUv, validate } from '../support/gltf.js';
import { head, modelFolders, random, readPlain } from './scenes.js';

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

describe('with borders: cut', () => {
  const folder = mkdtempSync(join(tmpdir(), 'cagecast-borders-'));
  after(() => rmSync(folder, { recursive: true, force: true }));
  const at = (name: string) => join(folder, name);
  const { cage, target } = head(2, 10);
  const vertices = target.positions.length / 3;

  /** A target with attributes of all kinds, each its own at every vertex, skinned and morphing; mirrored, it is turned on the way. */
  function rich(scale: [number, number, number]): Uint8Array {
    const next = random(7);
    const maker = new GlbMaker();
    const local = { ...target, positions: target.positions.map((x, i) => x / scale[i % 3]!) };
    const mesh = maker.mesh(local);
    const primitive = maker.json.meshes[mesh]!.primitives[0]!;
    const units = new Float32Array(3 * vertices);
    const tangents = new Float32Array(4 * vertices);
    const weights = new Float32Array(4 * vertices);
    for (let v = 0; v < vertices; ++v) {
      const normal = new Vector3(next() + 0.1, next(), next()).normalize();
      units.set(normal.toArray(), 3 * v);
      tangents.set([normal.y, normal.z, normal.x, -1], 4 * v);
      const all = Array.from({ length: 4 }, next);
      weights.set(
        all.map((x) => x / all.reduce((a, b) => a + b)),
        4 * v,
      );
    }
    primitive.attributes['NORMAL'] = maker.accessor(units, 'VEC3');
    primitive.attributes['TANGENT'] = maker.accessor(tangents, 'VEC4');
    primitive.attributes['COLOR_0'] = maker.accessor(
      Uint8Array.from({ length: 4 * vertices }, () => 256 * next()),
      'VEC4',
      { normalized: true },
    );
    primitive.attributes['JOINTS_0'] = maker.accessor(
      Uint8Array.from({ length: 4 * vertices }, (_, i) => 4 * (Math.floor(i / 4) % 3) + (i % 4)),
      'VEC4',
    );
    primitive.attributes['WEIGHTS_0'] = maker.accessor(weights, 'VEC4');
    primitive.attributes['_HEAT'] = maker.accessor(Float32Array.from({ length: vertices }, next), 'SCALAR');
    primitive.targets = [
      {
        POSITION: maker.accessor(
          Float32Array.from({ length: 3 * vertices }, () => next() - 0.5),
          'VEC3',
        ),
        NORMAL: maker.accessor(
          Float32Array.from({ length: 3 * vertices }, () => next() - 0.5),
          'VEC3',
        ),
      },
    ];
    const joints = Array.from({ length: 12 }, (_, j) => maker.node({ name: `joint ${j}` }, false));
    maker.node({ name: 'joints', children: joints });
    const node = { mesh, name: 'head', scale };
    if (scale[0] > 0) {
      maker.json.skins = [{ joints }];
      maker.node({ ...node, skin: 0 });
    } else {
      delete primitive.attributes['JOINTS_0'];
      delete primitive.attributes['WEIGHTS_0'];
      maker.node(node);
    }
    return maker.finish();
  }

  for (const [name, scale] of Object.entries({ 'skinned and morphing': [1, 1, 1], mirrored: [-1, 1, 1] } as Record<
    string,
    [number, number, number]
  >)) {
    test(`the command gives new vertices all attributes of those around them, in proportion: ${name}`, async () => {
      writeFileSync(at('rich.glb'), rich(scale));
      writeFileSync(at('cage.glb'), glbOf(cage));
      writeFileSync(at('paint.png'), readFileSync('examples/samples/lizard/paint-tiger.png'));
      const { status, stdout, stderr } = cagecast(
        'transfer',
        at('rich.glb'),
        '--cage',
        at('cage.glb'),
        '--texture',
        at('paint.png'),
        '--borders',
        'cut',
        '-o',
        at('out.glb'),
        '--report',
        at('report.json'),
      );
      assert.equal(status, 0, stderr);
      assert.deepEqual(await validate(at('out.glb')), []);

      const read = async (file: string) =>
        (await new NodeIO().read(at(file))).getRoot().listMeshes()[0]!.listPrimitives();
      const [[was], [is, overlay]] = await Promise.all([read('rich.glb'), read('out.glb')]);
      const plain = {
        positions: target.positions,
        indices:
          scale[0] < 0
            ? target.indices.map((_, i) => target.indices[i % 3 === 0 ? i : i % 3 === 1 ? i + 1 : i - 1]!)
            : target.indices,
      };
      const result = transfer(cage, plain);
      const cut = cutBorders(cage, plain, result);
      const [triangles, added] = [cut.indices.length / 3, cut.sources.length / 3];
      assert.ok(added > 20);
      const painted = (cosmetic: Uint8Array) => ({
        total: cosmetic.length,
        cosmetic: cosmetic.filter((one) => one === 1).length,
      });
      const counts = (zones: Uint8Array) =>
        Object.fromEntries(
          ['cosmetic', 'occluded', 'uncovered', 'culled'].map((name, zone) => [
            name,
            zones.filter((one) => one === zone).length,
          ]),
        );
      const report = JSON.parse(readFileSync(at('report.json'), 'utf8')) as {
        target: object;
        counts: object;
        triangles: object;
        cut: object;
        parts: { cutTriangles: number }[];
      };
      assert.deepEqual([report.counts, report.triangles], [counts(result.zones), painted(result.cosmeticTriangles)]);
      assert.deepEqual(report.cut, {
        vertices: vertices + added,
        counts: counts(cut.zones),
        triangles: painted(cut.cosmeticTriangles),
      });
      assert.equal(report.parts[0]!.cutTriangles, triangles - target.indices.length / 3);
      assert.match(stdout, /triangles may be painted; cut along borders, [\d,]+ of [\d,]+;/);
      assert.equal(overlay!.getIndices()!.getCount(), 3 * cut.cosmeticTriangles.reduce((sum, one) => sum + one, 0));

      // Each corner is where cutBorders has it, in the winding of the file, and has its UV.
      const corners = is!.getIndices()!.getArray()!;
      assert.equal(corners.length, cut.indices.length);
      const uvs = is!.getAttribute('TEXCOORD_1')!;
      const vertexOf = new Map<number, number>();
      corners.forEach((vertex: number, i: number) => {
        const from = scale[0] < 0 && i % 3 > 0 ? i + (i % 3 === 1 ? 1 : -1) : i;
        const known = vertexOf.get(vertex) ?? cut.indices[from]!;
        assert.equal(known, cut.indices[from]);
        vertexOf.set(vertex, known);
        assertNear(storedUv(uvs, vertex), cut.cornerUvs.subarray(2 * from, 2 * from + 2), `corner ${i}`);
      });
      const zones = is!.getAttribute('_NCZ')!.getArray()!;
      for (const [vertex, v] of vertexOf) assert.equal(zones[vertex], cut.zones[v]);

      const sourcesOf = (v: number) =>
        v < vertices
          ? [[v, 1] as const]
          : [0, 1, 2].map((j) => [cut.sources[3 * (v - vertices) + j]!, cut.weights[3 * (v - vertices) + j]!] as const);
      const mean = (values: ArrayLike<number>, size: number, v: number) =>
        Array.from({ length: size }, (_, k) =>
          sourcesOf(v).reduce((sum, [u, weight]) => sum + weight * values[size * u + k]!, 0),
        );
      const near = (a: readonly number[], b: readonly number[], most: number, what: string) =>
        assert.ok(
          a.every((x, k) => Math.abs(x - b[k]!) <= most),
          `${what}: ${a.join()} is not ${b.join()}`,
        );
      const values = (primitive: typeof was, semantic: string) => primitive!.getAttribute(semantic)!.getArray()!;
      const row = (list: ArrayLike<number>, size: number, v: number) =>
        Array.from({ length: size }, (_, k) => list[size * v + k]!);
      for (const [vertex, v] of vertexOf) {
        for (const [semantic, size, most] of [
          ['POSITION', 3, 1e-6],
          ['COLOR_0', 4, 0.51],
          ['TEXCOORD_0', 2, 1e-6],
          ['_HEAT', 1, 1e-6],
        ] as const) {
          near(row(values(is, semantic), size, vertex), mean(values(was, semantic), size, v), most, semantic);
        }
        const direction = new Vector3(...mean(values(was, 'NORMAL'), 3, v)).normalize();
        near(row(values(is, 'NORMAL'), 3, vertex), direction.toArray(), 1e-6, 'NORMAL');
        const tangent = new Vector3(
          ...(mean(values(was, 'TANGENT'), 4, v).slice(0, 3) as [number, number, number]),
        ).normalize();
        near(row(values(is, 'TANGENT'), 4, vertex), [...tangent.toArray(), -1], 1e-6, 'TANGENT');
        for (const semantic of ['POSITION', 'NORMAL']) {
          const deltas = (primitive: typeof was) => primitive!.listTargets()[0]!.getAttribute(semantic)!.getArray()!;
          near(row(deltas(is), 3, vertex), mean(deltas(was), 3, v), 1e-6, `delta of ${semantic}`);
        }
        if (scale[0] < 0) continue;
        const pulls = (primitive: typeof was, u: number) => {
          const all = new Array<number>(12).fill(0);
          for (let k = 0; k < 4; ++k)
            all[values(primitive, 'JOINTS_0')[4 * u + k]!]! += values(primitive, 'WEIGHTS_0')[4 * u + k]!;
          return all;
        };
        const blended = sourcesOf(v)
          .map(([u, weight]) => pulls(was, u).map((pull) => weight * pull))
          .reduce((a, b) => a.map((pull, k) => pull + b[k]!));
        const least = [...blended].sort((a, b) => b - a)[3]!;
        const kept = blended.map((pull) => (pull >= least ? pull : 0));
        const sum = kept.reduce((a, b) => a + b);
        near(
          pulls(is, vertex),
          kept.map((pull) => pull / sum),
          1e-6,
          'skin',
        );
      }
    });
  }

  const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
  const primitivesOf = async (path: string): Promise<Primitive[]> =>
    (await io.read(path))
      .getRoot()
      .listMeshes()
      .flatMap((mesh) => mesh.listPrimitives());
  const richScales: [number, number, number][] = [
    [1, 1, 1],
    [-1, 1, 1],
  ];

  /** What the command makes of two files. @returns its file. */
  function commanded(targetFile: string, cageFile: string): string {
    writeFileSync(at('paint.png'), readFileSync('examples/samples/lizard/paint-tiger.png'));
    const { status, stderr } = cagecast(
      'transfer',
      targetFile,
      '--cage',
      cageFile,
      '--texture',
      at('paint.png'),
      '--borders',
      'cut',
      '-o',
      at('command.glb'),
    );
    assert.equal(status, 0, stderr);
    return at('command.glb');
  }

  const saved = (name: string, bytes: Uint8Array) => {
    writeFileSync(at(name), bytes);
    return at(name);
  };
  const richFiles = richScales.map((scale, i) => ({
    name: i === 0 ? 'skinned and morphing' : 'mirrored',
    target: () => saved('rich.glb', rich(scale)),
    cage: () => saved('cage.glb', glbOf(cage)),
  }));
  const modelFiles = modelFolders().map((model) => ({
    name: model,
    target: () => join(model, 'target.glb'),
    cage: () => join(model, 'cage.glb'),
  }));

  for (const files of [...richFiles, ...modelFiles]) {
    test(`the glTF function makes what the command does, and it is valid: ${files.name}`, async () => {
      const [targetFile, cageFile] = [files.target(), files.cage()];
      const theirs = await primitivesOf(commanded(targetFile, cageFile));
      const document = await io.read(targetFile);
      await document.transform(
        cagecastTransform({ cage: await io.read(cageFile), texture: readFileSync(at('paint.png')), borders: 'cut' }),
      );
      await io.write(at('function.glb'), document);
      assert.deepEqual(await validate(at('function.glb')), []);
      const ours = await primitivesOf(at('function.glb'));
      assert.equal(ours.length, theirs.length);
      ours.forEach((primitive, p) => {
        assert.deepEqual(primitive.listSemantics().sort(), theirs[p]!.listSemantics().sort());
        for (const semantic of primitive.listSemantics())
          assert.deepEqual(
            primitive.getAttribute(semantic)!.getArray(),
            theirs[p]!.getAttribute(semantic)!.getArray(),
            semantic,
          );
        assert.deepEqual([...primitive.getIndices()!.getArray()!], [...theirs[p]!.getIndices()!.getArray()!]);
        primitive.listTargets().forEach((morph, m) => {
          for (const semantic of morph.listSemantics())
            assert.deepEqual(
              morph.getAttribute(semantic)!.getArray(),
              theirs[p]!.listTargets()[m]!.getAttribute(semantic)!.getArray(),
              `delta of ${semantic}`,
            );
        });
      });
    });
  }

  /** glTF's attributes by three's names. */
  const threeNames = {
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

  for (const files of richFiles) {
    test(`a scene of three.js becomes what the command makes of its file: ${files.name}`, async () => {
      const [was, cageScene] = await Promise.all(
        [files.target(), files.cage()].map(
          async (path) => (await new GLTFLoader().parseAsync(Uint8Array.from(readFileSync(path)).buffer, '')).scene,
        ),
      );
      const [base, theirOverlay] = await primitivesOf(commanded(at('rich.glb'), at('cage.glb')));
      const { overlays, parts, cutTriangles } = await applyTransfer(was!, cageScene!, {
        material: new MeshStandardMaterial(),
        borders: 'cut',
      });
      const { geometry } = parts[0]!;
      assert.ok(cutTriangles > 20);
      assert.equal(geometry.index!.count, 3 * (target.indices.length / 3 + cutTriangles));
      assert.deepEqual([...geometry.index!.array], [...base!.getIndices()!.getArray()!]);
      for (const [name, attribute] of Object.entries(geometry.attributes))
        close(attribute.array, base!.getAttribute(threeNames[name as keyof typeof threeNames])!.getArray()!, name);
      for (const name of ['position', 'normal'] as const)
        close(
          geometry.morphAttributes[name]![0]!.array,
          base!.listTargets()[0]!.getAttribute(threeNames[name])!.getArray()!,
          `delta of ${name}`,
        );
      assert.deepEqual([...overlays[0]!.geometry.index!.array], [...theirOverlay!.getIndices()!.getArray()!]);
      assert.equal(overlays[0]!.geometry.getAttribute('position'), geometry.getAttribute('position'));
    });
  }

  const plainGeometry = ({ positions, indices, uvs }: Mesh) => {
    const geometry = new BufferGeometry()
      .setIndex(new BufferAttribute(Uint32Array.from(indices), 1))
      .setAttribute('position', new BufferAttribute(positions.slice(), 3));
    return uvs ? geometry.setAttribute('uv', new BufferAttribute(uvs.slice(), 2)) : geometry;
  };

  test("three's own kinds of values are blended: half floats, morphs that are no deltas; groups and the range that is drawn follow", async () => {
    const count = target.indices.length;
    const geometry = plainGeometry(target);
    const heat = Float32Array.from({ length: vertices }, (_, v) => v / vertices);
    geometry.setAttribute('heat', new Float16BufferAttribute(Uint16Array.from(heat, DataUtils.toHalfFloat), 1));
    const normals = Float32Array.from(
      target.positions,
      (x, i) => x / Math.hypot(...target.positions.subarray(i - (i % 3), i - (i % 3) + 3)),
    );
    geometry.setAttribute('normal', new BufferAttribute(normals.slice(), 3));
    geometry.morphAttributes['normal'] = [new BufferAttribute(normals.slice(), 3)];
    geometry.morphAttributes['position'] = [
      new BufferAttribute(
        target.positions.map((x) => 2 * x),
        3,
      ),
    ];
    geometry.morphTargetsRelative = false;
    const middle = 3 * Math.floor(count / 6);
    geometry.addGroup(0, middle, 0);
    geometry.addGroup(middle, Infinity, 1);
    geometry.setDrawRange(middle, count - middle);
    const { result, cutTriangles } = await applyTransfer(geometry, plainGeometry(cage), { borders: 'cut' });
    const cut = cutBorders(cage, { ...target, groups: undefined }, result);
    assert.equal(cutTriangles, cut.triangles.length - count / 3);
    const pieces = cut.triangles.findIndex((t) => t >= middle / 3);
    assert.deepEqual(geometry.groups, [
      { start: 0, count: 3 * pieces, materialIndex: 0 },
      { start: 3 * pieces, count: cut.indices.length - 3 * pieces, materialIndex: 1 },
    ]);
    assert.deepEqual(geometry.drawRange, { start: 3 * pieces, count: cut.indices.length - 3 * pieces });
    const of = (name: string) => geometry.getAttribute(name);
    for (let n = 0; n < cut.sources.length / 3; ++n) {
      const expected = [0, 1, 2].reduce((sum, j) => sum + cut.weights[3 * n + j]! * heat[cut.sources[3 * n + j]!]!, 0);
      assert.ok(Math.abs(of('heat').getX(vertices + n) - expected) < 1e-3);
      const normal = new Vector3().fromBufferAttribute(geometry.morphAttributes['normal']![0]!, vertices + n);
      assert.ok(Math.abs(normal.length() - 1) < 1e-6);
      const [at, twice] = [of('position'), geometry.morphAttributes['position']![0]!].map((attribute) =>
        new Vector3().fromBufferAttribute(attribute!, vertices + n),
      );
      assert.ok(at!.multiplyScalar(2).distanceTo(twice!) < 1e-6);
    }
  });

  test('another classification is shown on the pieces, and on whole triangles in segments with another verdict', async () => {
    const mesh = new ThreeMesh(plainGeometry(target), new MeshStandardMaterial());
    const plain = { ...target, groups: undefined };
    const projection = project(cage, plain);
    const { result, overlays, update } = await applyTransfer(mesh, plainGeometry(cage), {
      material: new MeshStandardMaterial(),
      borders: 'cut',
    });
    const cut = cutBorders(cage, plain, result);
    const shown = () => overlays[0]!.geometry.index!.count / 3;
    const painted = cut.cosmeticTriangles.reduce((sum, one) => sum + one, 0);
    assert.equal(shown(), painted);
    const [skin, eye] = [result.segments[0]!, result.segments[vertices - 1]!];
    assert.ok(!result.segmentStats[skin]!.culled && result.segmentStats[eye]!.culled);
    update(classify(projection, { locks: { segments: { [skin]: 'exclude' } } }));
    assert.equal(shown(), 0);
    assert.ok(!mesh.geometry.getAttribute('_ncz').array.subarray(0, 1).includes(Zone.Cosmetic));
    update(classify(projection));
    assert.equal(shown(), painted);
    const kept = classify(projection, {
      locks: { segments: Object.fromEntries(result.segmentStats.map((_, s) => [s, 'keep'])) },
    });
    update(kept);
    const more = kept.cosmeticTriangles.filter(
      (one, t) => one === 1 && result.segmentStats[result.segments[target.indices[3 * t]!]!]!.culled,
    ).length;
    assert.ok(more > 0);
    assert.equal(shown(), painted + more);
  });

  test('segments excluded later have no painted piece, segments kept later no bare one', async () => {
    // Points that are hidden or uncovered never change to or from "culled".
    const [cage, mesh] = (await Promise.all(
      ['cage', 'target'].map((name) => readPlain(`examples/samples/lizard/${name}.glb`)),
    )) as [Mesh, Mesh];
    const plain = { ...mesh, groups: undefined };
    const projection = project(cage, plain);
    const [bare, free] = [classify(projection, { locks: { groups: { 0: 'exclude' } } }), classify(projection)];
    const shownAfter = async (locks: TransferOptions['locks'], now: Classification) => {
      const mesh = new ThreeMesh(plainGeometry(plain), new MeshStandardMaterial());
      const { overlays, update } = await applyTransfer(mesh, plainGeometry(cage), {
        material: new MeshStandardMaterial(),
        borders: 'cut',
        locks,
      });
      update(now);
      const zones = mesh.geometry.getAttribute('_ncz').array;
      return {
        triangles: overlays[0]!.geometry.index!.count / 3,
        vertices: zones.filter((zone) => zone === Zone.Cosmetic).length,
      };
    };
    assert.deepEqual(await shownAfter({}, bare), { triangles: 0, vertices: 0 });
    const { triangles } = await shownAfter({ groups: { 0: 'exclude' } }, free);
    assert.equal(
      triangles,
      free.cosmeticTriangles.reduce((sum, one) => sum + one, 0),
    );
  });

  test('an unknown value of borders is an error, and nothing is changed', async () => {
    const geometry = plainGeometry(target);
    assert.throws(
      // @ts-expect-error no such borders
      () => applyTransfer(geometry, plainGeometry(cage), { borders: 'straight' }),
      (error) =>
        error instanceof CagecastError &&
        error.code === 'badOption' &&
        /applyTransfer: options\.borders = "straight" is unknown; there are: "triangle", "cut"/.test(error.message),
    );
    assert.throws(() => applyTransfer(geometry, new BufferGeometry(), { borders: 'cut' }), { code: 'emptyMesh' });
    assert.deepEqual(Object.keys(geometry.attributes), ['position', 'uv']);
    const document = await io.readBinary(glbOf(target));
    await assert.rejects(
      // @ts-expect-error no such borders
      document.transform(cagecastTransform({ cage, borders: 'straight' })),
      /cagecast: options\.borders = "straight" is unknown/,
    );
    await assert.rejects(document.transform(cagecastTransform({ cage, borders: 'cut', threshold: 2 })), {
      code: 'badOption',
    });
    assert.equal(document.getRoot().listMeshes()[0]!.listPrimitives()[0]!.getAttribute('_NCZ'), null);
  });

  test('an error while borders are cut names the file, and nothing is written', () => {
    // The transfer copies three such arrays out of WebAssembly memory; what is cut cannot be had.
    writeFileSync(
      at('full.mjs'),
      `const { slice } = Float32Array.prototype;
      let left = 3;
      Float32Array.prototype.slice = function (...range) {
        if (this.byteOffset > 0 && this.buffer.byteLength >= 2 ** 20 && left-- <= 0) throw new RangeError('no memory');
        return slice.apply(this, range);
      };`,
    );
    writeFileSync(at('target.glb'), glbOf(target));
    writeFileSync(at('cage.glb'), glbOf(cage));
    const { status, stderr } = spawnSync(
      process.execPath,
      [
        '--import',
        pathToFileURL(at('full.mjs')).href,
        'dist/cli.js',
        'transfer',
        at('target.glb'),
        '--cage',
        at('cage.glb'),
        '--borders',
        'cut',
        '-o',
        at('never.glb'),
        '--report',
        at('never.json'),
      ],
      { encoding: 'utf8' },
    );
    assert.deepEqual([status, stderr], [1, `cagecast: ${at('target.glb')}: not enough memory\n`]);
    assert.deepEqual([existsSync(at('never.glb')), existsSync(at('never.json'))], [false, false]);
  });

  test('without -o it is wrong usage', () => {
    const { status, stderr } = cagecast('transfer', at('rich.glb'), '--cage', at('cage.glb'), '--borders', 'cut');
    assert.equal(status, 2);
    assert.match(stderr, /--borders cut needs -o OUT\.glb/);
  });
});
