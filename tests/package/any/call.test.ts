// What holds for any call at all: a clear error or a consistent result, and the next call works. A failure prints the call and a
// seed; CAGECAST_SEED and CAGECAST_RUNS try others, and more of them.
import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import {
  CagecastError,
  classify,
  cutBorders,
  init,
  inspect,
  type Mesh,
  project,
  splitVertices,
  transfer,
} from 'cagecast';
import fc from 'fast-check';
import { optionValues } from '../../../wasm/src/generated/options.js';
import { tetrahedron } from '../../support/gltf.js';
import { mesh, ofStage, resultOf, runs, validOptions } from './any.js';

const [cage, target] = [tetrahedron(1), tetrahedron(0.9)];
const usual = () => [...transfer(cage, target).zones];

before(init);

/** What someone may put where a number, an array or an object belongs. */
const junk = fc.oneof(
  fc.constantFrom(undefined, null, NaN, -1, 1e9, Infinity, 2 ** 32, 'vertex', '', true, 5n, Symbol('s'), () => 1),
  fc.constantFrom({}, [], [1, 2, 3], { length: 3 }, new ArrayBuffer(12), new DataView(new ArrayBuffer(12)), new Date()),
  fc.uint8Array({ maxLength: 12 }),
  fc.float32Array({ maxLength: 12 }),
  fc.array(fc.double(), { maxLength: 12 }),
  fc.anything({ maxDepth: 2 }),
);

/** The names that mean something in an object, each with anything for a value. */
const anyOf = (...names: string[]) =>
  fc.record(Object.fromEntries(names.map((name) => [name, junk])), { requiredKeys: [] });
const anyOptions = fc.oneof(
  anyOf('preset', ...optionValues.map(({ name }) => name)),
  anyOf('steps', 'locks', 'reuse', 'result', 'parts'),
  anyOf('interiorSamples', 'floor', 'projection', 'nothing').map((steps) => ({ steps })),
  anyOf('segments', 'groups').map((locks) => ({ locks })),
  junk,
);

/** The result, or undefined if the call fails as calls may: by one line of `CagecastError`. */
function outcomeOf<T>(call: () => T): T | undefined {
  try {
    return call();
  } catch (error) {
    assert.ok(error instanceof CagecastError, `not a CagecastError: ${(error as Error)?.stack ?? String(error)}`);
    assert.notEqual(error.code, 'internal', error.message);
    assert.match(error.message, /^[^\n]{10,400}$/);
    assert.ok(Number.isInteger(error.at) && error.at >= 0);
    return undefined;
  }
}

describe('for any valid scene and options', () => {
  test('a transfer is consistent', () => {
    fc.assert(
      fc.property(mesh, mesh, validOptions, (cage, target, options) => {
        const result = resultOf(() => transfer(cage, target, options));
        if (!result) return;
        const vertices = target.positions.length / 3;
        assert.equal(result.zones.length, vertices);
        assert.equal(result.cosmeticTriangles.length, target.indices.length / 3);
        assert.ok(result.zones.every((zone) => zone <= 3));
        assert.ok(result.uvs.every(Number.isFinite) && result.cornerUvs.every(Number.isFinite));
        assert.ok(result.distances.every((distance) => Number.isFinite(distance) && distance >= 0));
        assert.ok(result.triangles.every((triangle) => 3 * triangle < cage.indices.length));
        assert.ok(result.segments.every((segment) => segment < result.segmentStats.length));
        for (const { area, exposedArea, coveredArea } of result.segmentStats)
          assert.ok(coveredArea <= exposedArea && exposedArea <= area * (1 + 1e-9));
      }),
      runs,
    );
  });

  test('projecting and classifying is transferring, with locks too', () => {
    const lock = fc.constantFrom(undefined, 'keep' as const, 'exclude' as const);
    fc.assert(
      fc.property(mesh, mesh, validOptions, lock, (cage, target, options, lock) => {
        const locks = lock && { 0: lock };
        const result = resultOf(() => transfer(cage, target, { ...options, locks }));
        if (!result) return;
        const projection = project(cage, target, ofStage('project', options));
        const classified = classify(projection, { ...ofStage('classify', options), locks });
        assert.deepEqual(classified.zones, result.zones);
        assert.deepEqual(classified.cosmeticTriangles, result.cosmeticTriangles);
        assert.deepEqual(classified.segmentStats, result.segmentStats);
      }),
      runs,
    );
  });

  test('cut triangles blend corners of the triangle that they were cut from', () => {
    fc.assert(
      fc.property(mesh, mesh, validOptions, (cage, target, options) => {
        const result = resultOf(() => transfer(cage, target, options));
        if (!result) return;
        const cut = cutBorders(cage, target, result, options);
        const vertices = target.positions.length / 3;
        const added = cut.sources.length / 3;
        for (let n = 0; n < added; ++n) {
          const weights = [...cut.weights.subarray(3 * n, 3 * n + 3)];
          assert.equal(weights[0]! + weights[1]! + weights[2]!, 1);
          assert.ok(weights.every((weight) => weight >= 0));
        }
        assert.ok(cut.sources.every((vertex) => vertex < vertices));
        assert.ok(cut.indices.every((vertex) => vertex < vertices + added));
        cut.indices.forEach((vertex, i) => {
          const of = [...target.indices.subarray(3 * cut.triangles[Math.floor(i / 3)]!).subarray(0, 3)];
          const blended =
            vertex < vertices
              ? [vertex]
              : [0, 1, 2]
                  .filter((k) => cut.weights[3 * (vertex - vertices) + k]! > 0)
                  .map((k) => cut.sources[3 * (vertex - vertices) + k]!);
          const positionOf = (v: number) => String(target.positions.subarray(3 * v, 3 * v + 3));
          const corners = of.map(positionOf);
          assert.ok(blended.every((v) => corners.includes(positionOf(v))));
        });
      }),
      runs,
    );
  });

  test('split vertices have the UVs of their corners', () => {
    fc.assert(
      fc.property(mesh, mesh, (cage, target) => {
        const result = resultOf(() => transfer(cage, target, { seams: 'corner' }));
        if (!result) return;
        const { indices, sources, uvs } = splitVertices(target, result.cornerUvs);
        indices.forEach((vertex, corner) => {
          assert.equal(sources[vertex], target.indices[corner]);
          assert.deepEqual(
            [...uvs.subarray(2 * vertex, 2 * vertex + 2)],
            [...result.cornerUvs.subarray(2 * corner, 2 * corner + 2)],
          );
        });
      }),
      runs,
    );
  });

  test('inspect gives plain data, the most severe finding first, and locks that transfer takes', () => {
    fc.assert(
      fc.property(mesh, mesh, validOptions, (cage, target, options) => {
        const found = resultOf(() => inspect(cage, target, options));
        if (!found) return;
        assert.ok(['good', 'usable', 'unfit'].includes(found.verdict), found.verdict);
        const { findings, segments } = found;
        for (let i = 1; i < findings.length; ++i) assert.ok(findings[i - 1]!.weight >= findings[i]!.weight);
        for (const { sentence, advice, locks } of findings) {
          assert.match(sentence, /^[^\n]+$/);
          assert.match(advice, /^[^\n]*$/);
          if (locks) transfer(cage, target, { ...options, locks });
        }
        const { segmentStats } = transfer(cage, target, options);
        assert.deepEqual(
          segments.map(({ segment }) => segment),
          segmentStats.flatMap(({ area }, s) => (area > 0 ? [s] : [])),
        );
        assert.deepEqual(JSON.parse(JSON.stringify(found)).verdict, found.verdict);
        assert.doesNotMatch(JSON.stringify(found), /NaN/);
      }),
      { ...runs, numRuns: Math.ceil(runs.numRuns / 3) },
    );
  });
});

describe('for any arguments at all: a clear error, or a result, and the next call works', () => {
  const expected: number[] = [];
  before(() => expected.push(...usual()));
  const calls: [string, (mesh: Mesh, options: object) => unknown][] = [
    ['transfer', (mesh, options) => transfer(cage, mesh, options)],
    ['transfer with a cage', (mesh, options) => transfer(mesh as Mesh & { uvs: Float32Array }, target, options)],
    ['project', (mesh, options) => project(cage, mesh, options)],
    ['inspect', (mesh, options) => inspect(cage, mesh, options)],
    ['cutBorders', (mesh, options) => cutBorders(cage, target, mesh as never, options)],
    ['splitVertices', (mesh, options) => splitVertices(mesh, options as never)],
    ['classify', (mesh, options) => classify(mesh as never, options)],
  ];
  const anyMesh = fc.oneof(
    junk,
    anyOf('positions', 'indices', 'uvs', 'groups'),
    mesh.chain((good) => anyOf('positions', 'indices', 'uvs', 'groups').map((bad) => ({ ...good, ...bad }))),
    mesh.chain((good) =>
      anyOf('zones', 'segments', 'segmentStats', 'recovery', 'hiddenBy', 'hiders').map((bad) => ({ ...good, ...bad })),
    ),
  );
  for (const [name, call] of calls) {
    test(name, () => {
      fc.assert(
        fc.property(fc.oneof(anyMesh, fc.constant(target)), anyOptions, (given, options) => {
          outcomeOf(() => call(given as Mesh, options as object));
          assert.deepEqual(usual(), expected);
        }),
        runs,
      );
    });
  }
});
