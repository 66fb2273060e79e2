import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { before, describe, test } from 'node:test';
import { CagecastError, type Code, classify, init, type Mesh, project, transfer } from 'cagecast';
import { head, random, smallest } from './scenes.js';

function fails(call: () => unknown, code: Code, message: string | RegExp, at = 0): void {
  assert.throws(call, (error: unknown) => {
    assert.ok(error instanceof CagecastError && error instanceof Error, String(error));
    assert.equal(error.name, 'CagecastError');
    if (typeof message === 'string') assert.equal(error.message, message);
    else assert.match(error.message, message);
    assert.equal(error.code, code);
    assert.equal(error.at, at);
    // The sentence begins with the argument at fault, if there is one.
    assert.equal(error.argument, /^(cage|target|options|projection|preset)\b/.exec(error.reason)?.[0], error.message);
    assert.equal(error.message, `${error.fn}: ${error.reason}`);
    return true;
  });
}

const { cage, target } = smallest();
const worksAgain = () => assert.deepEqual([...transfer(cage, target).zones], [0, 0, 0]);
/** A call with arguments that its types forbid. */
const untyped =
  (...args: unknown[]) =>
  () =>
    (transfer as (...args: unknown[]) => unknown)(...args);

describe('errors', () => {
  before(init);

  test('a call before init says what to do', () => {
    const script = `
      import { transfer, project, classify } from 'cagecast';
      const mesh = { positions: new Float32Array(9), indices: new Uint32Array(3), uvs: new Float32Array(6) };
      const projection = { visibility: new Uint8Array(1), segments: new Uint32Array(1), indices: new Uint32Array(0), preset: 'paper', recovery: new Uint32Array(0), holeShares: [], segmentStats: [{ points: 1, area: 0, exposedArea: 0, coveredArea: 0, depth: 0, group: 0 }] };
      for (const call of [() => transfer(mesh, mesh), () => project(mesh, mesh), () => classify(projection)]) {
        try { call(); } catch (error) { console.log(error.code, error.message); }
      }`;
    assert.equal(
      execFileSync(process.execPath, ['--input-type=module', '-e', script], { encoding: 'utf8' }).trim(),
      ['transfer', 'project', 'classify']
        .map((fn) => `notInitialised ${fn}: Cagecast is not ready; await init() once before the first call`)
        .join('\n'),
    );
  });

  test('of the meshes: every code, with argument, element, value and limit', () => {
    const floats = (...values: number[]) => new Float32Array(values);
    const corners = (...values: number[]) => new Uint32Array(values);
    fails(
      () => transfer(cage, { ...target, positions: floats(), groups: corners() }),
      'emptyMesh',
      'transfer: target has no vertices; at least one is needed',
    );
    fails(
      () => transfer({ ...cage, indices: corners() }, target),
      'emptyMesh',
      'transfer: cage has no triangles; at least one is needed',
    );
    fails(
      () => transfer(cage, { positions: floats(0, 0), indices: corners(0, 0, 0) }),
      'positionsNotTriples',
      'transfer: target.positions has 2 numbers, not 3 per vertex',
      2,
    );
    fails(
      () => transfer(cage, { ...target, indices: corners(0, 1) }),
      'indicesNotTriples',
      'transfer: target.indices has 2 entries, not 3 per triangle',
      2,
    );
    fails(
      () => transfer({ positions: cage.positions, indices: cage.indices }, target),
      'missingUvs',
      /^transfer: cage\.uvs is missing/,
    );
    fails(
      () => transfer({ ...cage, uvs: floats(0, 0) }, target),
      'uvCountMismatch',
      'transfer: cage.uvs has 2 numbers, not 2 for each of 3 vertices',
      2,
    );
    fails(
      () => transfer(cage, { ...target, groups: corners(0) }),
      'groupCountMismatch',
      'transfer: target.groups has 1 entries, not 1 for each of 3 vertices',
      1,
    );
    fails(
      () => transfer(cage, { ...target, groups: corners() }),
      'groupCountMismatch',
      'transfer: target.groups has 0 entries, not 1 for each of 3 vertices',
    );
    fails(
      () => transfer(cage, { ...target, indices: corners(0, 1, 912) }),
      'indexOutOfRange',
      'transfer: target.indices[2] = 912 is out of range (3 vertices)',
      2,
    );
    fails(
      () => project(cage, { ...target, indices: new Uint16Array([0, 3, 1]) }),
      'indexOutOfRange',
      'project: target.indices[1] = 3 is out of range (3 vertices)',
      1,
    );
    fails(
      () => transfer(cage, { ...target, positions: floats(0, 0, 0, 1, NaN, 0, 0, 1, 0) }),
      'nonFinitePosition',
      'transfer: target.positions[4] = NaN is not a finite number',
      4,
    );
    fails(
      () => transfer({ ...cage, positions: floats(0, 0, 0, 1, 0, 0, 0, -Infinity, 0) }, target),
      'nonFinitePosition',
      'transfer: cage.positions[7] = -Infinity is not a finite number',
      7,
    );
    fails(
      () => transfer({ ...cage, uvs: floats(0, 0, 1, 0, 0, Infinity) }, target),
      'nonFiniteUv',
      'transfer: cage.uvs[5] = Infinity is not a finite number',
      5,
    );
    fails(
      () => transfer({ ...cage, positions: new Float32Array(9) }, target),
      'noUsableCageTriangle',
      'transfer: cage has no triangle with an area',
    );
    assert.throws(
      () => transfer({ ...cage, positions: floats(0, 0, 0, 1, 0, 0, 0, 1e30, 0) }, target),
      (error: unknown) =>
        error instanceof CagecastError &&
        error.code === 'tooLarge' &&
        /cage\.positions\[7\] = .* is too far from the origin/.test(error.message),
    );
    worksAgain();
  });

  test('of arguments of the wrong type', () => {
    fails(untyped(), 'badArgument', 'transfer: cage is undefined, not a mesh { positions, indices, … }');
    fails(untyped(cage, null), 'badArgument', 'transfer: target is null, not a mesh { positions, indices, … }');
    fails(
      untyped(cage, { ...target, positions: [0, 0, 0] }),
      'badArgument',
      'transfer: target.positions is of type Array, not a Float32Array',
    );
    fails(
      untyped(cage, { ...target, positions: new Float64Array(9) }),
      'badArgument',
      'transfer: target.positions is of type Float64Array, not a Float32Array',
    );
    fails(
      untyped(cage, { positions: target.positions }),
      'badArgument',
      'transfer: target.indices is undefined, not a Uint32Array, Uint16Array or Uint8Array',
    );
    fails(untyped(cage, { ...target, indices: new Int32Array(3) }), 'badArgument', /indices is of type Int32Array/);
    fails(untyped({ ...cage, uvs: 'uv' }, target), 'badArgument', 'transfer: cage.uvs is "uv", not a Float32Array');
    fails(
      untyped(cage, { ...target, groups: [0, 0, 0] }),
      'badArgument',
      'transfer: target.groups is of type Array, not a Uint32Array',
    );
    worksAgain();
  });

  test('of options', () => {
    fails(
      untyped(cage, target, { locks: { groups: new Map([[0, 'exclude']]) } }),
      'badOption',
      'transfer: options.locks.groups is of type Map, not an object of numbers and locks',
    );
    fails(
      untyped(cage, target, { locks: { segments: { '': 'keep' } } }),
      'badOption',
      'transfer: options.locks.segments has the key "", which is not the number of a segment',
    );
    fails(untyped(cage, target, 0.5), 'badOption', 'transfer: options is 0.5, not an object');
    fails(
      untyped(cage, target, { treshold: 0.5 }),
      'badOption',
      'transfer: options.treshold is not an option; transfer takes: preset, threshold, seams, weldTolerance, occlusionReach, pokeThrough, minCovered, steps, locks, masks, reuse',
    );
    fails(
      untyped(cage, target, { preset: 'deflaut' }),
      'badOption',
      /^transfer: options\.preset = "deflaut" is unknown/,
    );
    fails(
      untyped(cage, target, { steps: { projection: 'nearest' } }),
      'badOption',
      /^transfer: options\.steps\.projection = "nearest" is unknown; there are: "nearestPoint", "nearestVertex"$/,
    );
    fails(
      untyped(cage, target, { threshold: '0.5' }),
      'badOption',
      'transfer: options.threshold = "0.5" is not a number',
    );
    fails(
      untyped(cage, target, { weldTolerance: null }),
      'badOption',
      'transfer: options.weldTolerance = null is not a number',
    );
    for (const threshold of [-0.1, 2, NaN, Infinity]) {
      fails(
        () => transfer(cage, target, { threshold }),
        'badOption',
        `transfer: options.threshold = ${threshold} is not within 0..1`,
      );
    }
    for (const weldTolerance of [-1, 0.02, NaN]) {
      fails(
        () => transfer(cage, target, { weldTolerance }),
        'badOption',
        `transfer: options.weldTolerance = ${weldTolerance} is not within 0..0.01`,
      );
    }
    fails(
      untyped(cage, target, { seams: 'none' }),
      'badOption',
      'transfer: options.seams = "none" is unknown; there are: "vertex", "corner"',
    );
    fails(
      untyped(cage, target, { seams: 1 }),
      'badOption',
      'transfer: options.seams = 1 is unknown; there are: "vertex", "corner"',
    );
    fails(
      untyped(cage, target, { steps: { recheck: 1 } }),
      'badOption',
      'transfer: options.steps.recheck = 1 is not true or false',
    );
    fails(
      untyped(cage, target, { steps: { votes: true } }),
      'badOption',
      /^transfer: options\.steps\.votes is not an option; transfer takes: projection, /,
    );
    fails(untyped(cage, target, { steps: 1 }), 'badOption', 'transfer: options.steps is 1, not an object');
    fails(
      untyped(cage, target, { occlusionReach: '1' }),
      'badOption',
      'transfer: options.occlusionReach = "1" is not a number',
    );
    fails(
      () => transfer(cage, target, { occlusionReach: -1 }),
      'badOption',
      'transfer: options.occlusionReach = -1 is not a number of at least 0',
    );
    fails(
      () => transfer(cage, target, { pokeThrough: 2 }),
      'badOption',
      'transfer: options.pokeThrough = 2 is not within 0..1',
    );
    fails(
      () => transfer(cage, target, { minCovered: NaN }),
      'badOption',
      'transfer: options.minCovered = NaN is not within 0..1',
    );
    assert.throws(
      () => (project as (...args: unknown[]) => unknown)(cage, target, { threshold: 0.5 }),
      /project: options\.threshold is not an option/,
    );
    transfer(cage, target, { threshold: undefined, preset: undefined });
    worksAgain();
  });

  test('of an incomplete projection', () => {
    const projection = project(cage, target);
    const call = (change: object) => () => classify({ ...projection, ...change });
    fails(
      () => (classify as (...args: unknown[]) => unknown)(undefined),
      'badArgument',
      /^classify: projection is undefined/,
    );
    fails(call({ visibility: [0, 0, 0] }), 'badArgument', /projection\.visibility is of type Array/);
    fails(
      call({ segments: new Uint32Array([0, 0, 7]) }),
      'badArgument',
      /projection\.segments\[2\] = 7 is out of range \(1 segments\)/,
      2,
    );
    fails(call({ segments: new Uint32Array(2) }), 'badArgument', /has 3 entries of visibility but 2 of segments/);
    fails(call({ visibility: new Uint8Array([0, 9, 0]) }), 'badArgument', /projection\.visibility\[1\] = 9/, 1);
    fails(
      call({ indices: new Uint32Array([0, 1, 3]) }),
      'badArgument',
      /projection\.indices\[2\] = 3 is out of range/,
      2,
    );
    fails(
      call({ recovery: new Uint32Array([0, 5, 0]) }),
      'badArgument',
      /projection\.recovery\[1\] = 5 is out of range \(\d+ holes\)/,
      1,
    );
    fails(call({ recovery: new Uint32Array(2) }), 'badArgument', /has 3 entries of visibility but 2 of recovery/);
    fails(
      call({ holeShares: [{ hole: 0, segment: 4, exposedArea: 0, uncoveredArea: 0, hiddenArea: 0 }] }),
      'badArgument',
      /projection\.holeShares\[0\]/,
    );
    fails(
      call({ holeShares: [{ hole: 0, segment: 0, exposedArea: 0, uncoveredArea: 0 }] }),
      'badArgument',
      /projection\.holeShares\[0\] is not .* hiddenArea/,
    );
    fails(call({ preset: 'none' }), 'badOption', /options\.preset = "none" is unknown/);
    fails(
      call({ segmentStats: [{ ...projection.segmentStats[0], depth: NaN }] }),
      'badArgument',
      /projection\.segmentStats\[0\]/,
    );
    fails(call({ segmentStats: [null] }), 'badArgument', /projection\.segmentStats\[0\]/);
    fails(
      () => classify(projection, { threshold: 2 }),
      'badOption',
      'classify: options.threshold = 2 is not within 0..1',
    );
    worksAgain();
  });
});

describe('memory', () => {
  before(init);

  test('a mesh that does not fit is outOfMemory, and the next call works', () => {
    // 2.4 GB of zeros that are never touched: more than a WebAssembly memory can hold.
    const huge: Mesh = { positions: new Float32Array(6e8), indices: new Uint32Array([0, 1, 2]) };
    fails(() => transfer(cage, huge), 'outOfMemory', 'transfer: not enough memory');
    worksAgain();
    fails(() => project(cage, huge), 'outOfMemory', 'project: not enough memory');
    worksAgain();
  });

  test('wherever memory runs out the error is outOfMemory, and the next call gives the same bits', () => {
    const scene = head(20, 60);
    const expected = transfer(scene.cage, scene.target);
    const { grow } = WebAssembly.Memory.prototype;
    let failures = 0;
    for (let allowed = 0; allowed < 40; ++allowed) {
      // A fresh instance, whose memory may grow so many times and no more.
      fails(
        () => transfer(cage, { positions: new Float32Array(6e8), indices: new Uint32Array(3) }),
        'outOfMemory',
        /memory/,
      );
      let left = allowed;
      WebAssembly.Memory.prototype.grow = function (pages) {
        if (left-- <= 0) throw new RangeError('no more');
        return grow.call(this, pages);
      };
      try {
        assert.deepEqual(transfer(scene.cage, scene.target).zones, expected.zones);
      } catch (error) {
        assert.ok(error instanceof CagecastError, String(error));
        assert.equal(error.code, 'outOfMemory');
        ++failures;
      } finally {
        WebAssembly.Memory.prototype.grow = grow;
      }
      const again = transfer(scene.cage, scene.target);
      assert.deepEqual(again.uvs, expected.uvs);
      assert.deepEqual(again.zones, expected.zones);
    }
    assert.ok(failures > 0, 'the scene is too small to run out of memory');
  });

  /** Lets a method of typed arrays fail while a function runs. */
  function whileFailing(Type: { prototype: object }, method: 'slice' | 'set', error: Error, run: () => void): void {
    const own = Object.getOwnPropertyDescriptor(Type.prototype, method);
    Object.defineProperty(Type.prototype, method, {
      configurable: true,
      value: () => {
        throw error;
      },
    });
    try {
      run();
    } finally {
      if (own) Object.defineProperty(Type.prototype, method, own);
      else delete (Type.prototype as Record<string, unknown>)[method];
    }
  }

  test('a result that JavaScript cannot hold is outOfMemory, and the next call works', () => {
    whileFailing(Float32Array, 'slice', new RangeError('Array buffer allocation failed'), () =>
      fails(() => transfer(cage, target), 'outOfMemory', 'transfer: not enough memory'),
    );
    worksAgain();
  });

  test('a trap is reported as a defect, and the next call works', () => {
    whileFailing(Uint32Array, 'set', new WebAssembly.RuntimeError('unreachable'), () =>
      fails(() => transfer(cage, target), 'internal', /^transfer: the WebAssembly module failed .*unreachable/),
    );
    worksAgain();
  });

  test('memory is given back and used again: a thousand calls do not grow it', () => {
    const scene = head(21, 12);
    transfer(scene.cage, scene.target);
    const { grow } = WebAssembly.Memory.prototype;
    let grown = 0;
    WebAssembly.Memory.prototype.grow = function (pages) {
      ++grown;
      return grow.call(this, pages);
    };
    try {
      for (let i = 0; i < 1000; ++i) {
        if (i % 3 === 2)
          assert.throws(() => transfer(scene.cage, { ...scene.target, indices: new Uint32Array([0, 1, 1e6]) }));
        else transfer(scene.cage, scene.target);
      }
    } finally {
      WebAssembly.Memory.prototype.grow = grow;
    }
    assert.ok(grown <= 2, `it grew ${grown} times`);
  });

  test('needles around a pole of the cage, whose distances in floats are arbitrary, are no reason to fail', () => {
    // Corners at the pole that differ by rounding only, and points below it.
    const rings = 43;
    const at = (theta: number, phi: number, radius: number) => [
      radius * Math.sin(theta) * Math.cos(phi),
      radius * Math.cos(theta),
      radius * Math.sin(theta) * Math.sin(phi),
    ];
    const grid = (f: (ring: number, sector: number) => number[]) =>
      Array.from({ length: (rings + 1) * 2 * rings }, (_, i) => f(Math.floor(i / (2 * rings)), i % (2 * rings))).flat();
    const cage = {
      positions: new Float32Array(grid((r, s) => at((Math.PI * r) / rings, (Math.PI * s) / rings, 1))),
      uvs: new Float32Array(grid((r, s) => [s / (2 * rings), r / rings])),
      indices: new Uint32Array(
        grid((r, s) => {
          if (r === rings) return [];
          const [a, b] = [2 * rings * r + s, 2 * rings * r + ((s + 1) % (2 * rings))];
          return [a, b, a + 2 * rings, b, b + 2 * rings, a + 2 * rings];
        }),
      ),
    };
    const chance = random(1);
    const points = Array.from({ length: 3000 }, () => at(Math.PI - 0.8 * chance() ** 2, 7 * chance(), 0.97));
    const target = {
      positions: new Float32Array(points.flat()),
      indices: Uint32Array.from({ length: 3 * (points.length - 2) }, (_, i) => Math.floor(i / 3) + (i % 3)),
    };
    const { distances } = transfer(cage, target, { weldTolerance: 0 });
    assert.ok(distances.every((distance) => distance < 0.1));
  });
});
