// What holds for any sequence of calls, some of which fail, on one instance of the core: each answer is, to the bit, that of an
// instance of its own. A failure prints the calls and a seed; CAGECAST_SEED and CAGECAST_RUNS try others, and more of them.
import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import {
  CagecastError,
  type Classification,
  classify,
  cutBorders,
  init,
  inspect,
  type Locks,
  type Mesh,
  type Projection,
  project,
  splitVertices,
  type TransferResult,
  transfer,
} from 'cagecast';
import fc from 'fast-check';
import { tetrahedron } from '../../support/gltf.js';
import { head } from '../scenes.js';
import { mesh, ofStage, plain, runs, validOptions } from './any.js';

before(init);

/** Throws the instance away, as a call does that finds no memory for its answer. */
function dropInstance(): void {
  Object.defineProperty(Uint32Array.prototype, 'slice', {
    configurable: true,
    value() {
      throw new RangeError('Array buffer allocation failed');
    },
  });
  try {
    assert.throws(() => transfer(tetrahedron(1), tetrahedron(0.9)), { code: 'outOfMemory' });
  } finally {
    delete (Uint32Array.prototype as { slice?: unknown }).slice;
  }
}

/** Two scenes of which little is regular, and one in which every step has something to do. */
const scenes = fc.tuple(mesh, mesh, mesh, mesh).map(([cage, target, cage2, target2]) => {
  const { cage: ofHead, target: face } = head(3, 5);
  const poses = face.positions.map((x, i) => (i % 7 === 0 ? 1.05 * x : x));
  return [
    { cage, target },
    { cage: cage2, target: target2 },
    { cage: ofHead, target: { ...face, poses } },
  ];
});

/** Mostly nothing. */
const seldom = <T>(arbitrary: fc.Arbitrary<T>) =>
  fc.oneof({ weight: 4, arbitrary: fc.constant(undefined) }, { weight: 1, arbitrary });

const lock = fc.constantFrom('keep' as const, 'exclude' as const, 'auto' as const);
/** A segment 9 is seldom there: then the call fails when the projection is there. */
const locks: fc.Arbitrary<Locks | undefined> = seldom(fc.dictionary(fc.constantFrom('0', '0', '9'), lock));
const groups = fc.uniqueArray(fc.constant(0));
const parts = seldom(fc.record({ keep: groups, exclude: groups }));

/** What is wrong with the arguments of a call: found out before the core is called, or by it, early or late. */
const fault = seldom(fc.constantFrom('option', 'index', 'position', 'cage', 'masks', 'memory'));

const step = fc.record({
  fn: fc.oneof(
    { weight: 8, arbitrary: fc.constantFrom('transfer', 'project', 'classify', 'cutBorders', 'splitVertices') },
    { weight: 1, arbitrary: fc.constant('inspect') },
  ),
  scene: fc.nat({ max: 2 }),
  options: validOptions,
  locks,
  parts,
  mask: seldom(fc.integer({ min: -1, max: 1 })),
  reuses: fc.oneof({ weight: 2, arbitrary: fc.constant(true) }, { weight: 1, arbitrary: fc.constant(false) }),
  fault,
});
type Step = typeof step extends fc.Arbitrary<infer S> ? S : never;

/** The answers that later calls may write over, or read. */
interface Kept {
  /** Of the transfer. */
  scene: number;
  transfer?: TransferResult;
  project?: Projection;
  classify?: Classification;
}

/** A call whose arguments are all its own: it can be made again at any time. */
type Call = (reuse?: object) => unknown;

function faulty(cage: Mesh, target: Mesh, fault: Step['fault']): [Mesh, Mesh] {
  const [indices, positions] = [Uint32Array.from(target.indices), Float32Array.from(target.positions)];
  if (fault === 'index') return [cage, { ...target, indices: indices.fill(1e6, 0, 1) }];
  if (fault === 'position') return [cage, { ...target, positions: positions.fill(NaN, 0, 1) }];
  if (fault === 'cage') return [{ ...cage, positions: new Float32Array(cage.positions.length) }, target];
  return [cage, target];
}

function callOf(step: Step, all: { cage: Mesh; target: Mesh }[], kept: Kept): Call {
  const { fn, options, locks, parts, mask, fault } = step;
  // What is done with a transfer fits its scene, mostly.
  const isAfter = step.reuses && (fn === 'cutBorders' || fn === 'splitVertices');
  const scene = all[isAfter ? kept.scene : step.scene]!;
  const [cage, target] = faulty(scene.cage, scene.target, fault);
  const vertices = target.positions.length / 3 + Number(fault === 'masks');
  const masks = mask === undefined ? undefined : { vertices: new Int8Array(vertices).fill(mask, 0, 2) };
  const projecting = ofStage('project', options);
  const own = { ...(fault === 'option' && { threshold: 2 }), locks, parts, masks };
  const classifying = { ...ofStage('classify', options), ...own };
  const whole = { ...options, ...own };
  const [result, projection] = [structuredClone(kept.transfer), structuredClone(kept.project)];
  switch (fn) {
    case 'project':
      return (reuse) => project(cage, target, { ...projecting, reuse: reuse as Projection });
    case 'classify':
      return (reuse) => classify(projection as Projection, { ...classifying, reuse: reuse as Classification });
    case 'cutBorders':
      return () => cutBorders(cage, target, result as TransferResult, options);
    case 'splitVertices':
      return () => splitVertices(target, result?.cornerUvs as Float32Array);
    case 'inspect':
      return () => inspect(cage, target, options);
    default:
      return (reuse) => transfer(cage, target, { ...whole, reuse: reuse as TransferResult });
  }
}

/** What a call comes to: a copy, which calls after it leave alone. */
function outcomeOf(call: () => unknown): unknown {
  try {
    return structuredClone(plain(call() as TransferResult));
  } catch (error) {
    if (!(error instanceof CagecastError)) throw error;
    assert.notEqual(error.code, 'internal', error.message);
    const { code, message, at, argument } = error;
    return { code, message, at, argument };
  }
}

describe('any sequence of calls', () => {
  test('gives what each call gives alone', (t) => {
    const counts = { calls: 0, failed: 0, reused: 0 };
    const property = fc.property(scenes, fc.array(step, { minLength: 2, maxLength: 12 }), (all, steps) => {
      const { cage, target } = all[2]!;
      const kept: Kept = { scene: 2, transfer: transfer(cage, target), project: project(cage, target) };
      const made = steps.map((step) => {
        if (step.fault === 'memory') dropInstance();
        const call = callOf(step, all, kept);
        const fn = step.fn as Exclude<keyof Kept, 'scene'>;
        const reuse = step.reuses ? kept[fn] : undefined;
        const outcome = outcomeOf(() => {
          const answer = call(reuse);
          if (reuse) assert.equal(answer, reuse);
          if (['transfer', 'project', 'classify'].includes(fn)) Object.assign(kept, { [fn]: answer });
          if (fn === 'transfer') kept.scene = step.scene;
          return answer;
        });
        counts.calls += 1;
        counts.reused += Number(reuse !== undefined);
        counts.failed += Number('code' in (outcome as object));
        return { call, outcome };
      });
      for (const { call, outcome } of made) {
        dropInstance();
        assert.deepEqual(outcomeOf(call), outcome);
      }
    });
    fc.assert(property, { ...runs, numRuns: Math.ceil(runs.numRuns / 5) });
    t.diagnostic(`${counts.calls} calls compared; ${counts.failed} of them failed, ${counts.reused} reused an answer`);
    const { calls, failed, reused } = counts;
    assert.ok(failed > 0.05 * calls && failed < 0.6 * calls && reused > 0, 'the test tests little');
  });
});
