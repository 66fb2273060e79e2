import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import {
  CagecastError,
  type Classification,
  classify,
  init,
  type Mesh,
  type Projection,
  project,
  type TransferResult,
  transfer,
} from 'cagecast';
import * as worker from 'cagecast/worker';
import { head, type Scene, smallest, soup } from './scenes.js';

type Answer = TransferResult | Projection | Classification;

/** All of an answer that does not depend on the clock, or on what calls before it left of memory. */
function lasting<A extends Answer>(answer: A): Partial<A> {
  const { timings: _, peakBytes: __, ...rest } = answer as Partial<TransferResult>;
  return rest as Partial<A>;
}

const arraysOf = (answer: Answer): [string, ArrayBufferView][] =>
  Object.entries(answer).filter((entry): entry is [string, ArrayBufferView] => ArrayBuffer.isView(entry[1]));

/** A call in its three kinds, on one scene. */
const calls = {
  transfer: ({ cage, target }: Scene, options: object = {}) => transfer(cage, target, options),
  project: ({ cage, target }: Scene, options: object = {}) => project(cage, target, options),
  classify: ({ cage, target }: Scene, options: object = {}) => classify(project(cage, target), options),
} as const;
const functions = Object.keys(calls) as (keyof typeof calls)[];

function rejects(call: () => unknown, message: RegExp): void {
  assert.throws(call, (error) => {
    assert.ok(error instanceof CagecastError, String(error));
    assert.equal(error.code, 'badOption');
    assert.match(error.message, message);
    return true;
  });
}

/** That a call throws, and `reuse` and all that is in it is as before. */
function leavesAlone(call: (reuse: TransferResult) => unknown, reuse: TransferResult, code: string): void {
  const [shallow, deep] = [{ ...reuse }, structuredClone(reuse)];
  assert.throws(
    () => call(reuse),
    (error) => error instanceof CagecastError && error.code === code,
  );
  assert.deepEqual(reuse, deep);
  for (const [name, array] of arraysOf(shallow as TransferResult))
    assert.equal(reuse[name as keyof TransferResult], array, name);
}

describe('reuse', () => {
  before(init);
  const one = head(40, 8);
  const other = head(41, 11);

  for (const fn of functions) {
    test(`${fn} returns it, reusing arrays of the right length and replacing others`, () => {
      const reuse = calls[fn](one);
      const arrays = { ...reuse };
      Object.assign(reuse, { timings: undefined, peakBytes: undefined });
      const again = calls[fn](one, { reuse });
      assert.equal(again, reuse);
      assert.deepEqual(lasting(again), lasting(calls[fn](one)));
      for (const [name, array] of arraysOf(arrays))
        if (array.byteLength > 0) assert.equal(again[name as keyof Answer], array, name);
      assert.equal(again.segmentStats === arrays.segmentStats, false);

      assert.equal(calls[fn](other, { reuse }), reuse);
      assert.deepEqual(lasting(reuse), lasting(calls[fn](other)));
      for (const [name, array] of arraysOf(arrays)) assert.notEqual(reuse[name as keyof Answer], array, name);
      const whole = arraysOf(reuse).map(([, array]) => array);
      assert.ok(
        whole.every(({ byteOffset, byteLength, buffer }) => byteOffset === 0 && byteLength === buffer.byteLength),
      );
      assert.equal(new Set(whole.map(({ buffer }) => buffer)).size, whole.length);
      if (fn === 'classify') return;
      assert.deepEqual(
        Object.keys((reuse as TransferResult).timings),
        Object.keys(transfer(one.cage, one.target).timings),
      );
      assert.ok((reuse as TransferResult).timings.total > 0 && (reuse as TransferResult).peakBytes > 0);
    });
  }

  test('masks go by the indices of the call, even if the new result is written over them', () => {
    const { cage, target } = smallest();
    const masks = { vertices: Int8Array.of(0, 0, -1) };
    const reuse = transfer(cage, target);
    // As many vertices as corners: one of the arrays can serve as both.
    reuse.segments.set(target.indices);
    const again = transfer(cage, { ...target, indices: reuse.segments }, { masks, reuse });
    assert.deepEqual(again.cosmeticTriangles, transfer(cage, target, { masks }).cosmeticTriangles);
  });

  test('the reused result may share arrays with the arguments', () => {
    // As many corners as vertices, so that the arrays of the answer can hold the input.
    const { cage, target } = soup(44, 80);
    const expected = { project: lasting(project(cage, target)), transfer: lasting(transfer(cage, target)) };
    for (const fn of ['project', 'transfer'] as const) {
      const reuse = calls[fn]({ name: '', cage, target });
      reuse.triangles.set(target.indices);
      reuse.segments.fill(0);
      reuse.uvs.set(cage.uvs!);
      const shared = {
        target: { ...target, indices: reuse.triangles, groups: reuse.segments },
        cage: { ...cage, uvs: reuse.uvs },
      };
      const given =
        fn === 'project'
          ? project(shared.cage, shared.target, { reuse: reuse as Projection })
          : transfer(shared.cage, shared.target, { reuse: reuse as TransferResult });
      assert.deepEqual(lasting(given), expected[fn]);
    }
    const projection = project(one.cage, one.target);
    const again = project(one.cage, { ...one.target, indices: projection.indices }, { reuse: projection });
    assert.deepEqual(lasting(again), lasting(project(one.cage, one.target)));
    // The visibility of a projection, written over by what is decided of it.
    const decided = classify(projection, { threshold: 0.9 });
    const over = classify(projection, {
      threshold: 0.9,
      reuse: { ...structuredClone(decided), zones: projection.visibility },
    });
    assert.deepEqual(over, decided);
    assert.equal(over.zones, projection.visibility);
  });

  test('arrays that were moved away are replaced', () => {
    const reuse = transfer(one.cage, one.target);
    structuredClone(null, { transfer: arraysOf(reuse).map(([, { buffer }]) => buffer as ArrayBuffer) });
    assert.equal(reuse.uvs.length, 0);
    assert.deepEqual(lasting(transfer(one.cage, one.target, { reuse })), lasting(transfer(one.cage, one.target)));
    // Also those of which nothing is needed: they could not be moved once more.
    structuredClone(null, { transfer: arraysOf(reuse).map(([, { buffer }]) => buffer as ArrayBuffer) });
    transfer(one.cage, one.target, { preset: 'paper', reuse });
    structuredClone(null, { transfer: arraysOf(reuse).map(([, { buffer }]) => buffer as ArrayBuffer) });
  });

  test('a call that throws leaves the reused result unchanged', () => {
    const reuse = transfer(one.cage, one.target);
    const { cage, target } = other;
    const call =
      (change: Partial<Mesh>, options: object = {}) =>
      (given: TransferResult) =>
        transfer(cage, { ...target, ...change }, { ...options, reuse: given });
    leavesAlone(call({ indices: new Uint32Array([0, 1, 1e6]) }), reuse, 'indexOutOfRange');
    leavesAlone(call({}, { threshold: 2 }), reuse, 'badOption');
    leavesAlone(call({}, { locks: { 0: 'maybe' } }), reuse, 'badOption');
    leavesAlone(call({}, { threshold: 2, parts: { keep: [0] } }), reuse, 'badOption');
    // Found out when the projection is there.
    leavesAlone(call({}, { parts: { keep: [9] } }), reuse, 'badOption');
    leavesAlone(
      (given) => transfer(one.cage, one.target, { locks: { 999: 'keep' }, reuse: given }),
      reuse,
      'badOption',
    );
    leavesAlone(call({ positions: new Float32Array(6e8), groups: undefined }), reuse, 'outOfMemory');
    assert.deepEqual(lasting(transfer(cage, target, { reuse })), lasting(transfer(cage, target)));
  });

  test('if one new array cannot be allocated, no other is overwritten', () => {
    const reuse = { ...transfer(one.cage, one.target), segments: new Uint32Array(1) };
    const moved = { ...one.target, positions: one.target.positions.map((x) => 1.01 * x) };
    const isHad = (count: number): boolean => {
      let left = count;
      Object.defineProperty(Uint32Array.prototype, 'slice', {
        configurable: true,
        value: function (this: Uint32Array) {
          if (left-- <= 0) throw new RangeError('Array buffer allocation failed');
          return new Uint32Array(this);
        },
      });
      try {
        transfer(one.cage, moved, { reuse });
        return true;
      } catch (error) {
        assert.ok(error instanceof CagecastError && error.code === 'outOfMemory', String(error));
        return false;
      } finally {
        delete (Uint32Array.prototype as { slice?: unknown }).slice;
      }
    };
    const before = structuredClone(reuse);
    let had = 0;
    for (; !isHad(had); ++had) assert.deepEqual(reuse, before, `${had} arrays`);
    assert.ok(had > 0, `${had} arrays`);
    assert.deepEqual(lasting(reuse), lasting(transfer(one.cage, moved)));
    assert.notDeepEqual(reuse.distances, before.distances);
  });

  test('a reused object that is not an earlier result is an error', () => {
    const answers = {
      transfer: transfer(one.cage, one.target),
      project: project(one.cage, one.target),
      classify: classify(project(one.cage, one.target)),
    };
    for (const fn of functions) {
      const from = (reuse: unknown, message: RegExp) => {
        const before = ArrayBuffer.isView(reuse) ? undefined : structuredClone(reuse);
        rejects(() => calls[fn](one, { reuse }), message);
        if (before) assert.deepEqual(structuredClone(reuse), before);
      };
      from(null, new RegExp(`^${fn}: options\\.reuse is null; pass an earlier result of ${fn}\\(\\)$`));
      from(1, /options\.reuse is 1;/);
      from({}, /options\.reuse\.\w+ is undefined, not a \w+Array;/);
      for (const wrong of functions.filter((name) => name !== fn))
        from(
          answers[wrong],
          /options\.reuse\.\w+ is (undefined, not a \w+Array|of type \w+Array, which this function does not return);/,
        );
      const name = fn === 'project' ? 'visibility' : 'zones';
      const bytes = fn === 'project' ? answers.project.visibility : answers[fn].zones;
      from(
        { ...answers[fn], [name]: Array.from(bytes) },
        new RegExp(`options\\.reuse\\.${name} is of type Array, not a Uint8Array;`),
      );
      from({ ...answers[fn], cosmeticTriangles: bytes, recovery: bytes }, /options\.reuse\.\w+ (is|shares) /);
      from(Object.freeze({ ...answers[fn] }), /options\.reuse cannot be written to \(TypeError: /);
      from(
        Object.defineProperty({ ...answers[fn] }, 'segmentStats', { writable: false }),
        /options\.reuse cannot be written to \(TypeError: .*segmentStats/,
      );
    }
    const { triangles } = answers.transfer;
    rejects(
      () => transfer(one.cage, one.target, { reuse: { ...answers.transfer, segments: triangles } }),
      /options\.reuse\.segments shares its memory with another of its arrays;/,
    );
    rejects(
      () =>
        transfer(one.cage, one.target, { reuse: { ...answers.transfer, segments: new Uint32Array(triangles.buffer) } }),
      /shares its memory/,
    );
  });

  test('a worker refuses `reuse`', async () => {
    const reuse = transfer(one.cage, one.target);
    const before = structuredClone(reuse);
    await assert.rejects(worker.transfer(one.cage, one.target, { reuse } as object), (error) => {
      assert.ok(error instanceof CagecastError && error.code === 'badOption');
      assert.equal(error.message, 'transfer: options.reuse is not for the worker, whose results are always new arrays');
      return true;
    });
    assert.deepEqual(reuse, before);
    assert.deepEqual(
      lasting(await worker.transfer(one.cage, one.target, { reuse: undefined } as object)),
      lasting(reuse),
    );
  });
});
