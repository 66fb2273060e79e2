import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import {
  CagecastError,
  type Classification,
  classify,
  init,
  type Mesh,
  type Preset,
  type Projection,
  project,
  type TransferResult,
  transfer,
} from 'cagecast';
import * as worker from 'cagecast/worker';
import { head, random, type Scene, smallest, soup } from './scenes.js';

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

/** That a call throws, and `into` and all that is in it is as before. */
function leavesAlone(call: (into: TransferResult) => unknown, into: TransferResult, code: string): void {
  const [shallow, deep] = [{ ...into }, structuredClone(into)];
  assert.throws(
    () => call(into),
    (error) => error instanceof CagecastError && error.code === code,
  );
  assert.deepEqual(into, deep);
  for (const [name, array] of arraysOf(shallow as TransferResult))
    assert.equal(into[name as keyof TransferResult], array, name);
}

describe('into', () => {
  before(init);
  const one = head(40, 8);
  const other = head(41, 11);

  for (const fn of functions) {
    test(`${fn} returns it, with its arrays where they are as long as is needed, and new ones where not`, () => {
      const into = calls[fn](one);
      const arrays = { ...into };
      Object.assign(into, { timings: undefined, peakBytes: undefined });
      const again = calls[fn](one, { into });
      assert.equal(again, into);
      assert.deepEqual(lasting(again), lasting(calls[fn](one)));
      for (const [name, array] of arraysOf(arrays))
        if (array.byteLength > 0) assert.equal(again[name as keyof Answer], array, name);
      assert.equal(again.segmentStats === arrays.segmentStats, false);

      assert.equal(calls[fn](other, { into }), into);
      assert.deepEqual(lasting(into), lasting(calls[fn](other)));
      for (const [name, array] of arraysOf(arrays)) assert.notEqual(into[name as keyof Answer], array, name);
      const whole = arraysOf(into).map(([, array]) => array);
      assert.ok(
        whole.every(({ byteOffset, byteLength, buffer }) => byteOffset === 0 && byteLength === buffer.byteLength),
      );
      assert.equal(new Set(whole.map(({ buffer }) => buffer)).size, whole.length);
      if (fn === 'classify') return;
      assert.deepEqual(
        Object.keys((into as TransferResult).timings),
        Object.keys(transfer(one.cage, one.target).timings),
      );
      assert.ok((into as TransferResult).timings.total > 0 && (into as TransferResult).peakBytes > 0);
    });
  }

  test('a long sequence of scenes and options gives in one answer what each gives in one of its own', () => {
    const scenes = [
      one,
      other,
      soup(42),
      soup(43, 60),
      { name: 'smallest', ...smallest() },
      { name: 'without groups', cage: one.cage, target: { ...one.target, groups: undefined } },
    ];
    for (const seed of [1, 2, 3]) {
      const next = random(seed);
      const pick = <T>(all: readonly T[]): T => all[Math.floor(all.length * next())]!;
      const kept: { transfer?: TransferResult; project?: Projection; classify?: Classification } = {};
      for (let step = 0; step < 60; ++step) {
        const { name, cage, target } = pick(scenes);
        const preset = pick<Preset>(['default', 'paper']);
        const seams = pick(['corner', 'vertex'] as const);
        const decide = {
          threshold: next(),
          locks: pick([undefined, { groups: { 0: 'keep' } }, { segments: { 0: 'exclude' } }] as const),
        };
        const message = `seed ${seed}, step ${step}: ${name}, ${preset}, ${seams}, ${JSON.stringify(decide)}`;
        const projection = project(cage, target, { preset, seams });
        kept.transfer = transfer(cage, target, { preset, seams, ...decide, into: kept.transfer });
        assert.deepEqual(
          lasting(kept.transfer),
          lasting(transfer(cage, target, { preset, seams, ...decide })),
          message,
        );
        kept.project = project(cage, target, { preset, seams, into: kept.project });
        assert.deepEqual(lasting(kept.project), lasting(projection), message);
        kept.classify = classify(pick([projection, kept.project]), { ...decide, into: kept.classify });
        assert.deepEqual(kept.classify, classify(projection, decide), message);
        // Locked or not, the three agree.
        assert.deepEqual(kept.classify.zones, kept.transfer.zones, message);
        assert.deepEqual(kept.classify.segmentStats, kept.transfer.segmentStats, message);
      }
    }
  });

  test('it may share its arrays with the arguments', () => {
    // As many corners as vertices, so that the arrays of the answer can hold the input.
    const { cage, target } = soup(44, 80);
    const expected = { project: lasting(project(cage, target)), transfer: lasting(transfer(cage, target)) };
    for (const fn of ['project', 'transfer'] as const) {
      const into = calls[fn]({ name: '', cage, target });
      into.triangles.set(target.indices);
      into.segments.fill(0);
      into.uvs.set(cage.uvs!);
      const shared = {
        target: { ...target, indices: into.triangles, groups: into.segments },
        cage: { ...cage, uvs: into.uvs },
      };
      const given =
        fn === 'project'
          ? project(shared.cage, shared.target, { into: into as Projection })
          : transfer(shared.cage, shared.target, { into: into as TransferResult });
      assert.deepEqual(lasting(given), expected[fn]);
    }
    const projection = project(one.cage, one.target);
    const again = project(one.cage, { ...one.target, indices: projection.indices }, { into: projection });
    assert.deepEqual(lasting(again), lasting(project(one.cage, one.target)));
    // The zones of a projection, written over by what is decided of it.
    const decided = classify(projection, { threshold: 0.9 });
    const over = classify(projection, {
      threshold: 0.9,
      into: { ...structuredClone(decided), zones: projection.zones },
    });
    assert.deepEqual(over, decided);
    assert.equal(over.zones, projection.zones);
  });

  test('arrays that were moved away are replaced', () => {
    const into = transfer(one.cage, one.target);
    structuredClone(null, { transfer: arraysOf(into).map(([, { buffer }]) => buffer as ArrayBuffer) });
    assert.equal(into.uvs.length, 0);
    assert.deepEqual(lasting(transfer(one.cage, one.target, { into })), lasting(transfer(one.cage, one.target)));
    // Also those of which nothing is needed: they could not be moved once more.
    structuredClone(null, { transfer: arraysOf(into).map(([, { buffer }]) => buffer as ArrayBuffer) });
    transfer(one.cage, one.target, { preset: 'paper', into });
    structuredClone(null, { transfer: arraysOf(into).map(([, { buffer }]) => buffer as ArrayBuffer) });
  });

  test('a call that throws leaves it as it was', () => {
    const into = transfer(one.cage, one.target);
    const { cage, target } = other;
    const call =
      (change: Partial<Mesh>, options: object = {}) =>
      (given: TransferResult) =>
        transfer(cage, { ...target, ...change }, { ...options, into: given });
    leavesAlone(call({ indices: new Uint32Array([0, 1, 1e6]) }), into, 'indexOutOfRange');
    leavesAlone(call({}, { threshold: 2 }), into, 'badThreshold');
    leavesAlone(call({}, { locks: { groups: { 0: 'maybe' } } }), into, 'badOption');
    leavesAlone(call({}, { threshold: 2, locks: { groups: { 0: 'keep' } } }), into, 'badThreshold');
    // Found out when the projection is there.
    leavesAlone(call({}, { locks: { groups: { 9: 'keep' } } }), into, 'badOption');
    leavesAlone(
      (given) => transfer(one.cage, one.target, { locks: { segments: { 999: 'keep' } }, into: given }),
      into,
      'badOption',
    );
    leavesAlone(call({ positions: new Float32Array(6e8), groups: undefined }), into, 'outOfMemory');
    assert.deepEqual(lasting(transfer(cage, target, { into })), lasting(transfer(cage, target)));
  });

  test('where one new array cannot be had, no other is written over', () => {
    const into = { ...transfer(one.cage, one.target), segments: new Uint32Array(1) };
    const moved = { ...one.target, positions: one.target.positions.map((x) => 1.01 * x) };
    const Original = globalThis.Uint32Array;
    const failing = (left: number) =>
      new Proxy(Original, {
        construct(type, args, newTarget) {
          if (left-- <= 0) throw new RangeError('Array buffer allocation failed');
          return Reflect.construct(type, args, newTarget) as object;
        },
      });
    const isHad = (count: number): boolean => {
      globalThis.Uint32Array = Original.prototype.constructor = failing(count);
      try {
        transfer(one.cage, moved, { into });
        return true;
      } catch (error) {
        assert.ok(error instanceof CagecastError && error.code === 'outOfMemory', String(error));
        return false;
      } finally {
        globalThis.Uint32Array = Original.prototype.constructor = Original;
      }
    };
    const before = structuredClone(into);
    let had = 0;
    for (; !isHad(had); ++had) assert.deepEqual(into, before, `${had} arrays`);
    assert.ok(had > 5, `${had} arrays`);
    assert.deepEqual(lasting(into), lasting(transfer(one.cage, moved)));
    assert.notDeepEqual(into.distances, before.distances);
  });

  test('what is no earlier answer of the function is said', () => {
    const answers = {
      transfer: transfer(one.cage, one.target),
      project: project(one.cage, one.target),
      classify: classify(project(one.cage, one.target)),
    };
    for (const fn of functions) {
      const from = (into: unknown, message: RegExp) => {
        const before = ArrayBuffer.isView(into) ? undefined : structuredClone(into);
        rejects(() => calls[fn](one, { into }), message);
        if (before) assert.deepEqual(structuredClone(into), before);
      };
      from(null, new RegExp(`^${fn}: options\\.into is null; give an earlier answer of ${fn}\\(\\)$`));
      from(1, /options\.into is 1;/);
      from({}, /options\.into\.\w+ is undefined, not a \w+Array;/);
      for (const wrong of functions.filter((name) => name !== fn))
        from(
          answers[wrong],
          /options\.into\.\w+ is (undefined, not a \w+Array|of type \w+Array, and no answer of this function);/,
        );
      from(
        { ...answers[fn], zones: Array.from(answers[fn].zones) },
        /options\.into\.zones is of type Array, not a Uint8Array;/,
      );
      from(
        { ...answers[fn], cosmeticTriangles: answers[fn].zones, restores: answers[fn].zones },
        /options\.into\.\w+ (is|shares) /,
      );
      from(Object.freeze({ ...answers[fn] }), /options\.into cannot be written to \(TypeError: /);
      from(
        Object.defineProperty({ ...answers[fn] }, 'zones', { writable: false }),
        /options\.into cannot be written to \(TypeError: .*zones/,
      );
    }
    const { triangles } = answers.transfer;
    rejects(
      () => transfer(one.cage, one.target, { into: { ...answers.transfer, segments: triangles } }),
      /options\.into\.segments shares its memory with another of its arrays;/,
    );
    rejects(
      () =>
        transfer(one.cage, one.target, { into: { ...answers.transfer, segments: new Uint32Array(triangles.buffer) } }),
      /shares its memory/,
    );
  });

  test('a worker says that it has no use for it', async () => {
    const into = transfer(one.cage, one.target);
    const before = structuredClone(into);
    await assert.rejects(worker.transfer(one.cage, one.target, { into } as object), (error) => {
      assert.ok(error instanceof CagecastError && error.code === 'badOption');
      assert.equal(
        error.message,
        'transfer: options.into is for calls on one thread; from a worker all arrays are new',
      );
      return true;
    });
    assert.deepEqual(into, before);
    assert.deepEqual(
      lasting(await worker.transfer(one.cage, one.target, { into: undefined } as object)),
      lasting(into),
    );
  });
});
