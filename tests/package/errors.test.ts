import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { CagecastError, type Code, classify, init, type Mesh, project, transfer } from 'cagecast';
import { optionValues } from '../../wasm/src/generated/options.js';
import { printed } from '../support/script.js';
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
      const projection = { visibility: new Uint8Array(1), segments: new Uint32Array(1), indices: new Uint32Array(0), preset: 'paper', recovery: new Uint32Array(0), hiddenBy: new Uint32Array(0), hiders: new Uint32Array(0), holeShares: [], segmentStats: [{ points: 1, area: 0, beyondArea: 0, exposedArea: 0, coveredArea: 0, depth: 0, group: 0 }] };
      for (const call of [() => transfer(mesh, mesh), () => project(mesh, mesh), () => classify(projection)]) {
        try { call(); } catch (error) { console.log(error.code, error.message); }
      }`;
    assert.equal(
      printed(script),
      ['transfer', 'project', 'classify']
        .map((fn) => `notInitialised ${fn}: Cagecast is not ready; await init() once before the first call`)
        .join('\n'),
    );
  });

  const floats = (...values: number[]) => new Float32Array(values);
  const corners = (...values: number[]) => new Uint32Array(values);
  /** The arguments of `transfer` with something wrong in the mesh; what is wrong; its code; and its place. */
  type Row = [args: unknown[], sentence: string | RegExp, code?: Code, at?: number];
  const inCage = (change: object): unknown[] => [{ ...cage, ...change }, target];
  const inTarget = (change: object): unknown[] => [cage, { ...target, ...change }];
  const withOptions = (options: unknown): unknown[] => [cage, target, options];

  // Each code is tested in tests/core/errors.test.cpp: here, that all of an error comes through.
  const ofMeshes: Row[] = [
    [
      inTarget({ positions: floats(), groups: corners() }),
      'target has no vertices; at least one is needed',
      'emptyMesh',
    ],
    [
      inTarget({ positions: floats(0, 0) }),
      'target.positions has 2 numbers, not 3 per vertex',
      'positionsNotTriples',
      2,
    ],
    [inCage({ uvs: undefined }), /cage\.uvs is missing/, 'missingUvs'],
    [
      inTarget({ groups: corners() }),
      'target.groups has 0 entries, not 1 for each of 3 vertices',
      'groupCountMismatch',
    ],
    [
      inTarget({ indices: corners(0, 1, 912) }),
      'target.indices[2] = 912 is out of range (3 vertices)',
      'indexOutOfRange',
      2,
    ],
    [
      inTarget({ positions: floats(0, 0, 0, 1, NaN, 0, 0, 1, 0) }),
      'target.positions[4] = NaN is not a finite number',
      'nonFinitePosition',
      4,
    ],
    [
      inCage({ positions: floats(0, 0, 0, 1, 0, 0, 0, -Infinity, 0) }),
      'cage.positions[7] = -Infinity is not a finite number',
      'nonFinitePosition',
      7,
    ],
    [
      inCage({ uvs: floats(0, 0, 1, 0, 0, Infinity) }),
      'cage.uvs[5] = Infinity is not a finite number',
      'nonFiniteUv',
      5,
    ],
    [inCage({ positions: new Float32Array(9) }), 'cage has no triangle with an area', 'noUsableCageTriangle'],
  ];
  const ofTypes: Row[] = [
    [[], 'cage is undefined, not a mesh { positions, indices, … }'],
    [[cage, null], 'target is null, not a mesh { positions, indices, … }'],
    [inTarget({ positions: [0, 0, 0] }), 'target.positions is of type Array, not a Float32Array'],
    [inTarget({ positions: new Float64Array(9) }), 'target.positions is of type Float64Array, not a Float32Array'],
    [inTarget({ indices: undefined }), 'target.indices is undefined, not a Uint32Array, Uint16Array or Uint8Array'],
    [inTarget({ indices: new Int32Array(3) }), /indices is of type Int32Array/],
    [inCage({ uvs: 'uv' }), 'cage.uvs is "uv", not a Float32Array'],
    [inTarget({ groups: [0, 0, 0] }), 'target.groups is of type Array, not a Uint32Array'],
  ];
  const all = ['preset', ...optionValues.map(({ name }) => name), 'steps', 'parts', 'locks', 'masks', 'reuse'].join(
    ', ',
  );
  const ofOptions: [options: unknown, sentence: string | RegExp, at?: number][] = [
    [0.5, 'options is 0.5, not an object'],
    [{ treshold: 0.5 }, `options.treshold is not an option; transfer takes: ${all}`],
    [{ preset: 'deflaut' }, /options\.preset = "deflaut" is unknown/],
    [{ threshold: '0.5' }, 'options.threshold = "0.5" is not a number'],
    [{ weldTolerance: null }, 'options.weldTolerance = null is not a number'],
    ...[-0.1, 2, NaN, Infinity].map((threshold): [object, string] => [
      { threshold },
      `options.threshold = ${threshold} is not within 0..1`,
    ]),
    [{ weldTolerance: 0.02 }, 'options.weldTolerance = 0.02 is not within 0..0.01'],
    [{ occlusionReach: -1 }, 'options.occlusionReach = -1 is not a number of at least 0'],
    [{ seams: 'none' }, 'options.seams = "none" is unknown; there are: "vertex", "corner"'],
    [{ seams: 1 }, 'options.seams = 1 is unknown; there are: "vertex", "corner"'],
    [{ steps: 1 }, 'options.steps is 1, not an object'],
    [{ steps: { recheck: 1 } }, 'options.steps.recheck = 1 is not true or false'],
    [{ steps: { votes: true } }, /options\.steps\.votes is not an option; transfer takes: projection, /],
    [
      { steps: { projection: 'nearest' } },
      'options.steps.projection = "nearest" is unknown; there are: "nearestPoint", "nearestVertex"',
    ],
    [{ locks: 'keep' }, 'options.locks is "keep", not an object of numbers and locks'],
    [{ locks: new Map([[0, 'exclude']]) }, /options\.locks is .*, not an object/],
    [
      { locks: { segments: { 0: 'keep' } } },
      'options.locks has the key "segments", which is not the number of a segment',
    ],
    [
      { locks: { groups: { 0: 'keep' } } },
      /options\.locks\.groups is not there any more; give .* as options\.parts\.keep/,
    ],
    [{ locks: { '': 'keep' } }, 'options.locks has the key "", which is not the number of a segment'],
    [{ locks: { 0: 'maybe' } }, 'options.locks[0] = "maybe" is unknown; there are: "auto", "keep", "exclude"'],
    [{ locks: { 99: 'exclude' } }, 'options.locks[99] is given, but there is no segment 99', 99],
    [{ parts: 'hair' }, 'options.parts is "hair", not an object'],
    [{ parts: { leave: [] } }, 'options.parts.leave is not an option; transfer takes: ignore, keep, exclude'],
    [{ parts: { keep: 'hair' } }, 'options.parts.keep is "hair", not an array of numbers and names'],
    [{ parts: { keep: [-1] } }, 'options.parts.keep[0] = -1 is neither the number of a group nor a name'],
    [{ parts: { keep: ['hair'] } }, 'options.parts.keep[0]: nothing is named "hair"; no part has a name'],
    [{ parts: { keep: [7] } }, 'options.parts.keep has group 7, of which there is no vertex', 7],
    [{ parts: { exclude: [7] } }, 'options.parts.exclude has group 7, of which there is no vertex', 7],
    [{ parts: { ignore: [7] } }, 'options.parts.ignore has group 7, of which there is no vertex', 7],
    [{ parts: { ignore: [0] } }, 'options.parts.ignore has all groups of target: nothing is left'],
  ];
  for (const [of, rows, standard] of [
    ['meshes', ofMeshes, undefined],
    ['types', ofTypes, 'badArgument'],
    [
      'options',
      ofOptions.map(([options, sentence, at]): Row => [withOptions(options), sentence, 'badOption', at ?? 0]),
      'badOption',
    ],
  ] as const)
    test(`of ${of}: code, argument, element, value and limit`, () => {
      for (const [args, sentence, code = standard!, at = 0] of rows)
        fails(untyped(...args), code, typeof sentence === 'string' ? `transfer: ${sentence}` : sentence, at);
      worksAgain();
    });

  test('each function takes its own options and says its name', () => {
    assert.throws(
      () => (project as (...args: unknown[]) => unknown)(cage, target, { threshold: 0.5 }),
      /project: options\.threshold is not an option/,
    );
    const indices = new Uint16Array([0, 3, 1]);
    const sentence = 'project: target.indices[1] = 3 is out of range (3 vertices)';
    fails(() => project(cage, { ...target, indices }), 'indexOutOfRange', sentence, 1);
    transfer(cage, target, { threshold: undefined, preset: undefined });
  });

  test('of an incomplete projection', () => {
    const projection = project(cage, target);
    const share = { hole: 0, segment: 0, exposedArea: 0, uncoveredArea: 0, hiddenArea: 0 };
    const [stats] = projection.segmentStats;
    const rows: [change: object, message: RegExp, at?: number][] = [
      [{ visibility: [0, 0, 0] }, /projection\.visibility is of type Array/],
      [{ visibility: new Uint8Array([0, 9, 0]) }, /projection\.visibility\[1\] = 9/, 1],
      [{ segments: corners(0, 0, 7) }, /projection\.segments\[2\] = 7 is out of range \(1 segments\)/, 2],
      [{ segments: corners(0, 0) }, /has 3 entries of visibility but 2 of segments/],
      [{ indices: corners(0, 1, 3) }, /projection\.indices\[2\] = 3 is out of range/, 2],
      [{ recovery: corners(0, 5, 0) }, /projection\.recovery\[1\] = 5 is out of range \(\d+ holes\)/, 1],
      [{ recovery: corners(0, 0) }, /has 3 entries of visibility but 2 of recovery/],
      [{ hiddenBy: corners(0, 0) }, /has 3 entries of visibility but 2 of hiddenBy/],
      ...[[0], [0, 0, 1, 1], [0, 0, 1, 1, 2, 0], [0, 0, 1, 1, 1, 99], [0, 0, 1, 2, 0], [0, 1, 1, 0]].map(
        (hiders): [object, RegExp, number] => {
          const change = { hiddenBy: corners(0, 1, 0), hiders: corners(...hiders) };
          return [change, /hiddenBy\[1\] = 1 is no record of hiders/, 1];
        },
      ),
      [{ holeShares: [{ ...share, segment: 4 }] }, /projection\.holeShares\[0\]/],
      [{ holeShares: [{ ...share, hiddenArea: undefined }] }, /projection\.holeShares\[0\] is not .* hiddenArea/],
      [{ segmentStats: [{ ...stats, depth: NaN }] }, /projection\.segmentStats\[0\]/],
      [{ segmentStats: [null] }, /projection\.segmentStats\[0\]/],
    ];
    for (const [change, message, at] of rows)
      fails(() => classify({ ...projection, ...change }), 'badArgument', message, at);
    fails(() => classify(undefined as never), 'badArgument', /^classify: projection is undefined/);
    fails(
      () => classify({ ...projection, preset: 'none' as never }),
      'badOption',
      /options\.preset = "none" is unknown/,
    );
    const sentence = 'classify: options.threshold = 2 is not within 0..1';
    fails(() => classify(projection, { threshold: 2 }), 'badOption', sentence);
    const locks = { 99: 'exclude' } as const;
    fails(() => classify(projection, { locks }), 'badOption', /locks\[99\] is given, but there is no segment 99/, 99);
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
    let hasRunOut = true;
    for (let allowed = 0; hasRunOut; ++allowed) {
      hasRunOut = false;
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
        hasRunOut = true;
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

test('there is one class of errors: no script has its own but those that need no other', () => {
  const alone = ['error.js', 'slim.js', 'cages-sync.js', 'cages-thread.js', 'cli.js', 'command.js'];
  const scripts = readdirSync('dist').filter((name) => name.endsWith('.js') && !alone.includes(name));
  assert.ok(scripts.length > 9);
  for (const name of scripts)
    assert.doesNotMatch(readFileSync(`dist/${name}`, 'utf8'), /name\s*=\s*["']CagecastError["']/, name);
});
