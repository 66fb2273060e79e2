import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { CagecastError, cutBorders, init, type Mesh, transfer } from 'cagecast';
import {
  applySplit,
  applySplitToSkin,
  joinParts,
  type PrepareOptions,
  paintedVertices,
  prepareParts,
} from 'cagecast/engines';
import { prepareParts as prepareInWorker, terminate } from 'cagecast/worker';
import { head } from '../scenes.js';

const { cage, target } = head(5, 24);
const vertices = target.positions.length / 3;
const triangles = target.indices.length / 3;

/** The same surface, mirrored, as a second mesh. */
const mirror = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

describe('prepareParts', () => {
  before(init);

  test('gives every corner the UV of the transfer, and every vertex its zone', () => {
    const { result, parts, cutTriangles } = prepareParts(cage, target, { separatePaint: false });
    assert.deepEqual(result.uvs, transfer(cage, target).uvs);
    assert.equal(cutTriangles, 0);
    const [part] = parts;
    assert.ok(part && parts.length === 1 && part.copies > 0 && part.cut === undefined);
    assert.equal(part.sources.length, vertices + part.copies);
    part.indices.forEach((vertex, corner) => {
      const source = part.sources[vertex]!;
      assert.equal(source, target.indices[corner]);
      assert.equal(part.zones[vertex], result.zones[source]);
      assert.deepEqual(part.uvs.slice(2 * vertex, 2 * vertex + 2), result.cornerUvs.slice(2 * corner, 2 * corner + 2));
    });
    assert.deepEqual(part.cosmeticTriangles, result.cosmeticTriangles);
  });

  for (const borders of ['triangle', 'cut'] as const)
    test(`separates paint, so that its vertices tell a painted triangle: ${borders}`, () => {
      const part = prepareParts(cage, target, { borders }).parts[0]!;
      const isPainted = paintedVertices(part);
      assert.equal(isPainted.length, part.sources.length);
      for (let t = 0; t < part.cosmeticTriangles.length; ++t) {
        const corners = part.indices.subarray(3 * t, 3 * t + 3);
        assert.equal(Number(corners.every((v) => isPainted[v] === 1)), part.cosmeticTriangles[t]);
      }
    });

  test('cuts borders as cutBorders does', () => {
    const { result, parts, cutTriangles } = prepareParts(cage, target, { borders: 'cut', separatePaint: false });
    const cut = cutBorders(cage, target, result);
    const part = parts[0]!;
    assert.ok(cutTriangles > 0);
    assert.equal(part.indices.length / 3, triangles + cutTriangles);
    assert.deepEqual(part.cut?.sources, cut.sources);
    assert.deepEqual(part.cut?.triangles, cut.triangles);
    const positions = applySplit(target.positions, 3, part);
    part.indices.forEach((vertex, corner) => {
      const source = cut.indices[corner]! - vertices;
      if (source < 0) return;
      for (let k = 0; k < 3; ++k) {
        let mean = 0;
        for (let i = 3 * source; i < 3 * source + 3; ++i)
          mean += cut.weights[i]! * target.positions[3 * cut.sources[i]! + k]!;
        assert.equal(positions[3 * vertex + k], Math.fround(mean));
      }
    });
  });

  test('takes a result that is known, and then no cage', () => {
    const result = transfer(cage, target, { threshold: 0.3 });
    const expected = prepareParts(cage, target, { threshold: 0.3 });
    assert.deepEqual(prepareParts(undefined, target, { result }).parts, expected.parts);
  });

  test('gives the same in the worker', async () => {
    const ranges = [{ firstVertex: 0, vertexCount: vertices, firstTriangle: 0, triangleCount: triangles }];
    const options: PrepareOptions = { borders: 'cut', ranges, parts: { keep: [0] } };
    const there = await prepareInWorker(cage, target, options);
    assert.deepEqual(there.parts, prepareParts(cage, target, options).parts);
    await terminate();
  });

  test('keeps the numbers and the winding of a mirrored part', () => {
    const { positions, indices } = target;
    const joined = joinParts([
      { positions, indices },
      { positions, indices, matrix: mirror },
    ]);
    const { mesh, parts } = joined;
    assert.deepEqual(
      parts.map(({ mirrored }) => mirrored),
      [false, true],
    );
    assert.deepEqual([mesh.groups![0], mesh.groups![vertices]], [0, 1]);
    assert.ok(mesh.positions[3 * vertices] === -positions[0]!);
    assert.deepEqual(
      [...mesh.indices.subarray(3 * triangles, 3 * triangles + 3)],
      [0, 2, 1].map((k) => vertices + indices[k]!),
    );
    const [own, other] = prepareParts(cage, mesh, { ranges: parts }).parts;
    for (const { indices: corners, sources } of [own!, other!])
      assert.deepEqual(
        Array.from(corners, (v) => sources[v]),
        [...indices],
      );
    const cut = prepareParts(cage, mesh, { ranges: parts, borders: 'cut' }).parts[1]!;
    assert.ok(cut.cut!.triangles.every((t) => t >= triangles));
    // Pieces face as the triangles do that they are cut from.
    const at = (v: number) => applied.subarray(3 * v, 3 * v + 3);
    const applied = applySplit(positions, 3, cut);
    const normal = (all: ArrayLike<number>, of: (v: number) => Float32Array, t: number) => {
      const [a, b, c] = [0, 1, 2].map((k) => of(all[3 * t + k]!)) as [Float32Array, Float32Array, Float32Array];
      const [u, v] = [b.map((x, k) => x - a[k]!), c.map((x, k) => x - a[k]!)];
      return [0, 1, 2].map((k) => u[(k + 1) % 3]! * v[(k + 2) % 3]! - u[(k + 2) % 3]! * v[(k + 1) % 3]!);
    };
    cut.cut!.triangles.forEach((t, piece) => {
      const whole = normal(indices, (v) => positions.subarray(3 * v, 3 * v + 3), t - triangles);
      const facing = normal(cut.indices, at, piece).reduce((sum, x, k) => sum + x * whole[k]!, 0);
      assert.ok(facing > -1e-9, `${facing}`);
    });
  });
});

describe('applySplit', () => {
  // Three vertices, one in the middle of an edge of theirs, and a copy of it.
  const cut = {
    sources: Uint32Array.of(0, 1, 1),
    weights: Float32Array.of(0.75, 0.25, 0),
    triangles: new Uint32Array(1),
  };
  const split = { sources: Uint32Array.of(0, 1, 2, 3, 3), copies: 1, cut };

  test('blends, copies, and keeps the type', () => {
    assert.deepEqual(applySplit(Float64Array.of(1, 5, 9), 1, split), Float64Array.of(1, 5, 9, 2, 2));
    assert.deepEqual(applySplit(Uint8ClampedArray.of(0, 255, 9), 1, split), Uint8ClampedArray.of(0, 255, 9, 64, 64));
    assert.deepEqual(applySplit(Int32Array.of(7, 3, 9), 1, split, 'heaviest'), Int32Array.of(7, 3, 9, 7, 7));
  });

  test('gives directions their length, and tangents their sign', () => {
    const tangents = applySplit(Float32Array.of(4, 0, 0, -1, 0, 12, 0, -1, 0, 0, 1, 1), 4, split, 'direction');
    assert.deepEqual([...tangents.slice(12)], [...tangents.slice(16), ...tangents.slice(16)].slice(0, 8));
    assert.deepEqual([...tangents.slice(12, 16)], [Math.SQRT1_2, Math.SQRT1_2, 0, -1].map(Math.fround));
    const normals = applySplit(Int8Array.of(127, 0, 0, 127, 0, 0, 0, 0, 127), 3, split, 'direction');
    assert.deepEqual([...normals.slice(9, 12)], [127, 0, 0]);
  });

  test('adds up the weights of joints to 1', () => {
    const joints = [Uint16Array.of(1, 2, 0, 0, 2, 3, 0, 0, 0, 0, 0, 0)];
    const weights = [Uint8Array.of(200, 55, 0, 0, 128, 127, 0, 0, 255, 0, 0, 0)];
    const skin = applySplitToSkin({ joints, weights }, split);
    assert.deepEqual([...skin.joints[0]!.slice(12)], [1, 2, 3, 0, 1, 2, 3, 0]);
    const own = skin.weights[0]!.slice(12, 16);
    assert.equal(
      own.reduce((sum, weight) => sum + weight, 0),
      255,
    );
    assert.ok(own[0]! > own[1]! && own[1]! > own[2]!);
  });

  test('a wrong argument is named with its value and what is needed', () => {
    const [values, apply] = [new Float32Array(9), applySplit as (...args: unknown[]) => unknown];
    const join = joinParts as (parts: unknown) => unknown;
    const prepare = (options: unknown, of: unknown = target) =>
      prepareParts(cage, of as Mesh, options as PrepareOptions);
    const whole = { firstVertex: 0, vertexCount: vertices, firstTriangle: 0, triangleCount: triangles };
    const part = { positions: new Float32Array(9) };
    const result = transfer(cage, target);
    const rows: [call: () => unknown, message: string | RegExp, at?: number][] = [
      [() => apply([1, 2, 3], 1, split), 'applySplit: values is of type Array, not a typed array of numbers'],
      [() => apply(new DataView(new ArrayBuffer(9)), 1, split), /values is of type DataView, not/],
      [() => apply(new BigInt64Array(3), 1, split), /values is of type BigInt64Array, not/],
      [() => apply(values, 2, split), 'applySplit: values has 9 numbers, not 2 for each of 3 vertices', 9],
      [() => apply(values, 0, split), 'applySplit: itemSize is 0, not a whole number of at least 1'],
      [() => apply(values, 3, undefined), 'applySplit: split is undefined, not a part that prepareParts returned'],
      [
        () => apply(values, 3, split, 'median'),
        /rule = "median" is unknown; there are: "mean", "direction", "heaviest"/,
      ],
      [() => apply(new Float32Array(6), 2, split, 'direction'), /itemSize is 2, but a direction has 3 numbers, or 4/],
      [
        () => applySplitToSkin({ joints: [values], weights: [] }, split),
        /skin has 1 arrays of joints, and 0 of weights/,
      ],
      [
        () => applySplitToSkin({ joints: [values], weights: [values] }, split),
        /skin\.joints\[0\] has 9 numbers, not 4/,
        9,
      ],
      [() => join({}), 'joinParts: parts is of type Object, not an array'],
      [() => join([null]), 'joinParts: parts[0] is null, not an object'],
      [() => join([part, { positions: 'abc' }]), 'joinParts: parts[1].positions is "abc", not an array', 1],
      [() => join([{ positions: new Float32Array(4) }]), /parts\[0\]\.positions has 4 numbers, not 3 per vertex/, 4],
      [() => join([{ ...part, indices: [0, 1] }]), /parts\[0\] has 2 indices, not 3 per triangle/, 2],
      [() => join([{ ...part, indices: [0, 1, 3] }]), /parts\[0\]\.indices\[2\] = 3 is out of range \(3 vertices\)/, 2],
      [() => join([part, { ...part, uvs: new Float32Array(6) }]), /parts\[1\] has uvs, unlike parts\[0\]/, 1],
      [() => join([{ ...part, uvs: new Float32Array(5) }]), /parts\[0\]\.uvs has 5 numbers, not 2 for each of 3 v/, 5],
      [() => join([{ ...part, matrix: [1] }]), 'joinParts: parts[0].matrix has 1 numbers, not 16', 1],
      [
        () => prepare({ border: 'cut' }),
        /^prepareParts: options\.border is not an option; prepareParts takes: ranges, borders, /,
      ],
      [() => prepare({ borders: 'cutt' }), /^prepareParts: options\.borders = "cutt" is unknown; there are: /],
      [() => prepare({ separatePaint: 1 }), 'prepareParts: options.separatePaint = 1 is not true or false'],
      [() => prepare({ ranges: whole }), 'prepareParts: options.ranges is of type Object, not an array'],
      [
        () => prepare({ ranges: [{}] }),
        /options\.ranges\[0\]\.firstVertex = undefined is not a whole number within 0\.\./,
      ],
      [
        () => prepare({ ranges: [whole, { ...whole, triangleCount: 1e9 }] }),
        /ranges\[1\]\.triangleCount = 1000000000 is/,
        1,
      ],
      [
        () => prepare({ ranges: [{ ...whole, vertexCount: 1 }] }),
        /target\.indices\[\d+\] = \d+ is not a vertex of .*\[0\]/,
      ],
      [
        () => prepare({ result: { ...result, uvs: result.zones } }),
        /options\.result\.uvs is of type Uint8Array, not a/,
      ],
      [
        () => prepare({ result: { ...result, zones: new Uint8Array(2) } }),
        /options\.result\.zones has 2 entries, the t/,
        2,
      ],
      [() => prepare({}, null), 'prepareParts: target.positions is undefined, not a Float32Array'],
      [() => prepare({}, { ...target, indices: [0] }), /target\.indices is of type Array, not a Uint32Array, Uint16/],
    ];
    for (const [call, message, at] of rows)
      assert.throws(call, (error: unknown) => {
        assert.ok(error instanceof CagecastError, String(error));
        if (typeof message === 'string') assert.equal(error.message, message);
        else assert.match(error.message, message);
        if (at !== undefined) assert.equal(error.at, at, error.message);
        assert.ok(error.argument, error.message);
        return true;
      });
  });
});
