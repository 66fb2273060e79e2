import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { before, describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { type Code, init, type Mesh } from 'cagecast';
import {
  type Cage,
  CagecastError,
  type CageModel,
  cageGlb,
  defaultExclusions,
  findLandmarks,
  fitCage,
  loadTemplate,
  makeCage,
  matchingParts,
  refineCage,
  type Template,
  terminate,
} from 'cagecast/cages';
import * as sync from 'cagecast/cages/sync';
import { cageModel } from 'cagecast/gltf';
import { inspect } from 'cagecast/inspect';
import { countingEnds } from '../support/ended-workers.js';
import { ball, join3d } from './scenes.js';

/** An egg with two balls in it that stick out in front: a head, as far as making a cage is concerned. */
function head(detail = 12): CageModel & Mesh {
  const skin = ball([0, 0, 0], (phi, theta) => 1 + 0.1 * Math.cos(theta) + 0.02 * Math.cos(phi), detail, 2 * detail);
  const eyes = [-0.35, 0.35].map((x) => ball([x, -0.85, 0.2], () => 0.18, 8, 16));
  const { positions, indices, groups } = join3d(skin, ...eyes);
  return { positions, indices, groups, parts: ['skin', ['Eye.L', 'white'], ['Eye.R', 'white']] };
}

/** A coarse grid: these tests are not about what a good cage is. */
const options = { kind: 'head', triangles: 300, voxels: 60 } as const;

async function failure(call: () => Promise<unknown>): Promise<CagecastError> {
  try {
    await call();
  } catch (error) {
    assert.ok(error instanceof CagecastError, String(error));
    // The sentence begins with the argument at fault, if there is one.
    const named = /^(model|template|landmarks|options|cage)\b/.exec(error.reason);
    if (named) assert.equal(error.argument, named[0], error.message);
    return error;
  }
  assert.fail('it did not fail');
}

describe('makeCage', () => {
  before(() => Promise.all([init(), sync.init()]));

  test('makes a cage that fits, with holes over the parts that are excluded by name, and tells how far it is', async () => {
    const model = head();
    const told: [number, string][] = [];
    const cage = await makeCage(model, { ...options, onProgress: (...progress) => told.push(progress) });
    assert.equal(cage.uvs.length / 2, cage.positions.length / 3);
    assert.ok(cage.uvs.every((x) => x >= 0 && x <= 1));
    assert.equal(cage.kind, 'head');
    assert.equal((await makeCage(model, { ...options, kind: 'automatic' })).kind, 'head');
    const { verdict, holes } = inspect(cage, model);
    assert.notEqual(verdict, 'unfit');
    assert.equal(holes.length, 2);

    const shares = told.map(([share]) => share);
    assert.deepEqual(
      shares,
      [...shares].sort((a, b) => a - b),
    );
    assert.ok(shares[0]! < 0.5 && shares.at(-1) === 1, shares.join());
    assert.ok(new Set(told.map(([, stage]) => stage)).size > 2);
    // The arguments are copied.
    assert.deepEqual(model, head());
  });

  test('is the same at once, on the thread of the caller', async () => {
    const there = await makeCage(head(), options);
    assert.deepEqual(sync.makeCage(head(), options), there);
    assert.deepEqual(sync.defaultExclusions(), await defaultExclusions());
  });

  test('tells which parts patterns match', async () => {
    assert.deepEqual(await matchingParts(['eye', 'lid'], ['eye']), [true, false]);
    assert.deepEqual(sync.matchingParts(['skin', ['Eye.L', 'white'], 'eyelid'], ['eye', 'sk*']), [true, true, false]);
    assert.throws(() => sync.matchingParts(['skin'], 'eye' as never), {
      message: 'matchingParts: patterns is "eye", not an array of patterns',
    });
  });

  test('takes patterns and marks in the place of the default list', async () => {
    const model = head();
    const none = await makeCage(model, { ...options, exclude: [] });
    assert.equal(inspect(none, model).holes.length, 0);
    const marks = Uint8Array.from({ length: model.indices.length / 3 }, (_, t) =>
      Number(model.groups![model.indices[3 * t]!] === 1),
    );
    const one = await makeCage({ ...model, marks }, { ...options, exclude: [] });
    assert.equal(inspect(one, model).holes.length, 1);
  });

  test('is cancelled at once by its signal, and the next call starts anew', async () => {
    // At the first report and in the middle of the work, however fast it is.
    for (const from of [0, 0.4])
      await countingEnds(async (ended) => {
        const controller = new AbortController();
        let isSettled = false;
        let wasSettled: boolean | undefined;
        const call = makeCage(head(40), {
          ...options,
          triangles: 2000,
          signal: controller.signal,
          onProgress: (share) => {
            if (share < from || controller.signal.aborted) return;
            controller.abort(new Error('never mind'));
            setImmediate(() => (wasSettled = isSettled));
          },
        }).finally(() => (isSettled = true));
        await assert.rejects(call, /never mind/);
        await new Promise((done) => setImmediate(done));
        assert.equal(wasSettled, true, 'before anything else happens');
        assert.equal(ended(), 1, 'its worker is ended');
      });
    assert.ok((await makeCage(head(), options)).indices.length > 0);
    await assert.rejects(makeCage(head(), { signal: AbortSignal.abort() }), { name: 'AbortError' });
  });

  test('rejects with what onProgress throws, and the next call starts anew', async () => {
    const own = new Error('of the callback');
    const call = makeCage(head(), {
      ...options,
      onProgress: () => {
        throw own;
      },
    });
    await assert.rejects(call, own);
    assert.ok((await makeCage(head(), options)).indices.length > 0);
  });

  test('is cancelled by its own callback where it runs at once', () => {
    let calls = 0;
    assert.throws(() => sync.makeCage(head(), { ...options, onProgress: () => ++calls < 3 }), {
      code: 'aborted',
      message: 'makeCage: cancelled by onProgress',
    });
    assert.equal(calls, 3);
    const own = new Error('of the callback');
    assert.throws(
      () =>
        sync.makeCage(head(), {
          ...options,
          onProgress: () => {
            throw own;
          },
        }),
      own,
    );
  });

  test('takes marks that were moved away before for a mistake', async () => {
    const model = head();
    const marks = new Uint8Array(model.indices.length / 3).fill(1, 0, 20);
    structuredClone(marks, { transfer: [marks.buffer] });
    await sync.init();
    assert.throws(
      () => sync.makeCage({ ...model, marks }, options),
      /makeCage: model\.marks has 0 numbers, not 1 for each of \d+ triangles$/,
    );
  });

  test('says in a sentence what is wrong with its arguments', async () => {
    const model = head();
    const bad = (change: object) => ({ ...model, ...change }) as CageModel;
    const nan = model.positions.slice();
    nan[4] = Number.NaN;
    const untyped = makeCage as (...args: unknown[]) => Promise<unknown>;
    for (const [call, code, says] of [
      [() => untyped(null), 'badArgument', 'model is null, not a mesh { positions, indices, … }'],
      [
        () => untyped({ scene: () => {} }),
        'badArgument',
        'model has no positions; see cageModel of cagecast/gltf and cagecast/three',
      ],
      [() => untyped(bad({ positions: [1] })), 'badArgument', 'model.positions is of type Array, not a Float32Array'],
      [() => untyped(bad({ parts: 'skin' })), 'badArgument', 'model.parts is "skin", not an array of names'],
      [
        () => untyped(bad({ parts: [['a', 1]] })),
        'badArgument',
        'model.parts[0] is 1, not a name, or an array of names',
      ],
      [
        () => untyped(bad({ joints: {} })),
        'badArgument',
        'model.joints is of type Object, not an array of joints { name, position, parent }',
      ],
      [() => untyped(bad({ joints: [{}] })), 'badArgument', 'model.joints[0].name is undefined, not a name'],
      [
        () => untyped(bad({ joints: [{ name: 'hips', position: [0, 1] }] })),
        'badArgument',
        'model.joints[0].position is of type Array, not 3 finite numbers',
      ],
      [
        () => untyped(bad({ joints: [{ name: 'hips', position: [0, 1, 2], parent: 0.5 }] })),
        'badArgument',
        'model.joints[0].parent is 0.5, not a whole number',
      ],
      [() => untyped(bad({ marks: [1] })), 'badArgument', 'model.marks is of type Array, not a Uint8Array'],
      [() => untyped(model, null), 'badOption', 'options is null, not an object'],
      [
        () => untyped(model, { size: 1 }),
        'badOption',
        'options.size is unknown; there are: kind, exclude, triangles, closing, offset, voxels',
      ],
      [
        () => untyped(model, { kind: 'hand' }),
        'badOption',
        'options.kind = "hand" is unknown; there are: "automatic", "head", "body", "prop"',
      ],
      [() => untyped(model, { exclude: 'eye*' }), 'badOption', 'options.exclude is "eye*", not an array of patterns'],
      [() => untyped(model, { offset: -1 }), 'badOption', 'options.offset is -1, not a number of at least 0'],
      [() => untyped(model, { triangles: 0.5 }), 'badOption', 'options.triangles is 0.5, not a whole number'],
      [() => untyped(model, { onProgress: 1 }), 'badOption', 'options.onProgress is 1, not a function'],
      [() => untyped(model, { signal: 1 }), 'badOption', 'options.signal is 1, not an AbortSignal'],
      [() => makeCage(bad({ indices: new Uint32Array(0) })), 'badModel', 'model has no triangles; at least one is needed'],
      [() => makeCage(bad({ positions: nan })), 'badModel', 'model.positions[4] = NaN is not a finite number'],
      [
        () => makeCage(bad({ parts: ['skin'] })),
        'badModel',
        /^makeCage: model\.groups\[\d+\] = 1, but there are 1 parts$/,
      ],
    ] satisfies [() => Promise<unknown>, Code, string | RegExp][]) {
      const error = await failure(call);
      assert.equal(error.code, code, error.message);
      if (typeof says === 'string') assert.equal(error.message, `makeCage: ${says}`);
      else assert.match(error.message, says);
    }
  });

  test('a model that does not fit is outOfMemory, and the next call works', async () => {
    // 2.4 GB of zeros that are never touched: more than a WebAssembly memory can hold.
    const huge = { positions: new Float32Array(6e8), indices: new Uint32Array([0, 1, 2]) };
    const cage = await makeCage(head(), options);
    for (const [fn, call] of [
      ['makeCage', () => sync.makeCage(huge)],
      ['fitCage', () => sync.fitCage(cage, huge)],
      ['findLandmarks', () => sync.findLandmarks(huge)],
      ['refineCage', () => sync.refineCage(cage, huge)],
    ] as const)
      assert.throws(call, { code: 'outOfMemory', message: `${fn}: not enough memory` });
    assert.deepEqual(sync.makeCage(head(), options), cage);
  });

  test('terminate cancels waiting calls', async () => {
    const calls = [makeCage(head(), options), makeCage(head(), options)].map((call) => failure(() => call));
    terminate();
    for (const error of await Promise.all(calls)) assert.equal(error.code, 'aborted');
  });

  test('an idle worker does not keep a process alive, and nothing is loaded before the first call', () => {
    const script = `
      import { defaultExclusions } from 'cagecast/cages';
      console.log((await defaultExclusions()).length > 0);`;
    const run = (text: string) =>
      execFileSync(process.execPath, ['--input-type=module', '-e', text], { encoding: 'utf8', timeout: 60000 }).trim();
    assert.equal(run(script), 'true');
    assert.throws(() => sync.makeCage.call(undefined, null as never), { code: 'badArgument' });
    assert.equal(
      run(
        `import { makeCage } from 'cagecast/cages/sync'; try { makeCage({}); } catch ({ code }) { console.log(code); }`,
      ),
      'notInitialised',
    );
  });
});

describe('fitCage', () => {
  let template: Template;
  let model: CageModel;
  before(async () => {
    template = await loadTemplate('human-head');
    const own = cageModel(await new NodeIO().read('examples/samples/human/target.glb'));
    // Another place and size than the template's.
    model = { ...own, positions: own.positions.map((x, i) => 2 * x + (i % 3 === 1 ? 5 : 0)) };
  });

  test('moves a template onto a model; triangles, UVs and holes stay', async () => {
    const shares: number[] = [];
    const fit = await fitCage(template, model, undefined, { onProgress: (share) => shares.push(share) });
    const { cage, used, confidence, missing } = fit;
    assert.deepEqual(cage.uvs, template.uvs);
    assert.deepEqual(cage.indices, template.indices);
    assert.deepEqual([cage.holes, cage.kind], [template.holes, 'head']);
    assert.notEqual(inspect(cage, model).verdict, 'unfit');
    assert.deepEqual(
      shares,
      [...shares].sort((a, b) => a - b),
    );
    assert.equal(shares.at(-1), 1);
    const names = Object.keys(template.landmarks);
    assert.ok(Object.keys(used).length > 5);
    for (const name of [...Object.keys(used), ...missing]) assert.ok(names.includes(name), name);
    for (const name of Object.keys(used)) assert.ok(confidence[name]! > 0 && confidence[name]! <= 1);
    assert.deepEqual(sync.fitCage(template, model), fit);
  });

  test('uses the landmarks that are given', async () => {
    const at = template.landmarks['nose_tip']!;
    const nose = [2 * at[0], 2 * at[1] + 5, 2 * at[2]] as const;
    const { used, confidence } = await fitCage(template, model, { nose_tip: nose });
    for (const [k, x] of nose.entries()) assert.ok(Math.abs(used['nose_tip']![k]! - x) < 1e-5);
    assert.equal(confidence['nose_tip'], 1);
  });

  test('finds landmarks', async () => {
    const { landmarks, confidence, kind, rig, missing } = await findLandmarks(model);
    assert.ok(Object.keys(landmarks).length > 5);
    assert.deepEqual(Object.keys(confidence), Object.keys(landmarks));
    assert.equal(kind, 'head');
    assert.equal(rig, '');
    assert.ok(missing.includes('nape'));
    for (const name of missing) assert.ok(!(name in landmarks), name);
  });

  test('finds no landmarks that are not finite, however the model is turned', async () => {
    for (const [y, z] of [
      [1, 1],
      [1, -1],
      [-1, 1],
      [-1, -1],
    ] as const) {
      for (const swaps of [false, true]) {
        const positions = model.positions.map((x, i) => {
          if (i % 3 === 0) return x;
          const other = model.positions[i % 3 === 1 ? i + 1 : i - 1]!;
          return (i % 3 === 1 ? y : z) * (swaps ? other : x);
        });
        const { landmarks } = await findLandmarks({ ...model, positions });
        for (const [name, at] of Object.entries(landmarks)) assert.ok(at.every(Number.isFinite), name);
      }
    }
  });

  test('is less certain of the crown of a head that is taller than others, and asks for it', async () => {
    const { landmarks, confidence } = await findLandmarks(model);
    const [low, top] = [landmarks['glabella']![1], landmarks['crown']![1]];
    const stretched = (by: number) => ({
      ...model,
      positions: model.positions.map((x, i) => (i % 3 === 1 && x > low ? x + by * (x - low) : x)),
    });
    assert.ok(top > low && confidence['crown']! < confidence['nose_tip']!);
    const tall = await findLandmarks(stretched(0.3));
    assert.ok((tall.confidence['crown'] ?? 0) < confidence['crown']!);
    const hat = await findLandmarks(stretched(0.8));
    for (const name of ['crown', 'forehead']) {
      assert.ok(!(name in hat.landmarks), name);
      assert.ok(hat.missing.includes(name), name);
    }
  });

  test('says in a sentence what is wrong with its arguments', async () => {
    const untyped = fitCage as (...args: unknown[]) => Promise<unknown>;
    const { uvs: _, ...bare } = template;
    for (const [args, code, says] of [
      [[null, model], 'badArgument', /^fitCage: template is null, not a mesh/],
      [[bare, model], 'missingUvs', /^fitCage: template\.uvs is missing/],
      [
        [{ ...template, landmarks: [1] }, model],
        'badArgument',
        /template\.landmarks is of type Array, not an object of names and positions/,
      ],
      [
        [{ ...template, landmarks: { chin: [0] } }, model],
        'badArgument',
        /template\.landmarks\.chin is of type Array, not 3 finite numbers/,
      ],
      [
        [{ ...template, kind: 'hand' }, model],
        'badArgument',
        /template\.kind is "hand", not one of "automatic", "head", "body", "prop"/,
      ],
      [[template, model, { chin: 'low' }], 'badArgument', /^fitCage: landmarks\.chin is "low", not 3 finite numbers/],
      [[template, model, {}, { triangles: 5 }], 'badOption', /options\.triangles is unknown; there are: exclude$/],
      [[{ ...template, indices: new Uint32Array(0) }, model], 'badTemplate', /template/],
      [[template, { ...model, indices: new Uint32Array(0) }], 'badModel', /model has no triangles/],
      [[template, model, { antler: [0, 0, 0] }], 'badLandmarks', /^fitCage: landmarks: antler is .* outside the box/],
    ] satisfies [unknown[], Code, RegExp][]) {
      const error = await failure(() => untyped(...args));
      assert.equal(error.code, code, error.message);
      assert.match(error.message, says);
    }
  });
});

describe('refineCage', () => {
  test('moves a cage that is off into place; triangles, UVs, holes and landmarks stay, and so does a cage in place', async () => {
    const model = head();
    const landmarks = { nose_tip: [0, -1.1, 0] as [number, number, number] };
    const made = { ...(await makeCage(model, options)), landmarks, holes: { eye: [0, 1, 2] } };
    const still = await refineCage(made, model);
    assert.deepEqual(still.positions, made.positions);
    const off = { ...made, positions: made.positions.map((x, i) => x + (i % 3 === 0 ? 0.06 : 0)) };
    const back = await refineCage(off, model, { reach: 0.05 });
    assert.deepEqual([back.uvs, back.indices, back.holes, back.kind], [made.uvs, made.indices, made.holes, 'head']);
    assert.deepEqual(back.landmarks, landmarks);
    const distance = (cage: Cage) =>
      cage.positions.reduce((sum, x, i) => sum + Math.abs(x - made.positions[i]!), 0) / made.positions.length;
    assert.ok(distance(back) < 0.5 * distance(off), `${distance(back)} of ${distance(off)}`);
    assert.equal((await failure(() => refineCage({ ...off, uvs: undefined }, model))).code, 'missingUvs');
    const far = await failure(() => refineCage({ ...off, positions: made.positions.map((x) => x + 9) }, model));
    assert.deepEqual([far.code, far.argument], ['badTemplate', 'cage'], far.message);
    assert.equal((await failure(() => refineCage(off, model, { reach: -1 }))).code, 'badOption');
  });
});

describe('results', () => {
  test('share nothing with what was given', async () => {
    await sync.init();
    const template = await loadTemplate('human-head');
    const before = structuredClone(template);
    const { indices } = template;
    const positions = template.positions.map((x) => 0.98 * x);
    const cage = sync.refineCage(template, { positions, indices });
    for (const loop of Object.values(cage.holes)) (loop as number[]).length = 0;
    for (const position of Object.values(cage.landmarks)) (position as unknown as number[])[0] = 99;
    assert.deepEqual(template, before);
  });

  test('of cages whose holes, landmarks or kind are wrong are errors', async () => {
    await sync.init();
    const template = await loadTemplate('human-head');
    const { positions, indices, groups } = head();
    for (const [wrong, message] of [
      [{ holes: { mouth: 7 } }, /^refineCage: cage\.holes\.mouth is 7, not an array of vertices$/],
      [{ holes: new Map() }, /^refineCage: cage\.holes is .*, not an object/],
      [{ landmarks: { a: 'x' } }, /^refineCage: cage\.landmarks\.a is "x", not 3 finite numbers/],
      [{ kind: 'bogus' }, /^refineCage: cage\.kind is "bogus", not one of "automatic"/],
    ] as const)
      assert.throws(
        () => sync.refineCage({ ...template, ...(wrong as object) }, { positions, indices, groups }),
        (error) => error instanceof sync.CagecastError && error.code === 'badArgument' && message.test(error.message),
        String(message),
      );
  });
});

describe('cageGlb', () => {
  test('needs only the arrays', async () => {
    const { positions, uvs, indices } = await loadTemplate('car');
    assert.equal(new TextDecoder().decode(cageGlb({ positions, uvs, indices }).subarray(0, 4)), 'glTF');
  });

  test('takes indices of any width, and refuses what is missing', async () => {
    const template = await loadTemplate('car');
    const narrow = Uint16Array.from(template.indices);
    const [primitive] = (await new NodeIO().readBinary(cageGlb({ ...template, indices: narrow })))
      .getRoot()
      .listMeshes()[0]!
      .listPrimitives();
    assert.deepEqual([...primitive!.getIndices()!.getArray()!], [...template.indices]);
    for (const field of ['positions', 'uvs', 'indices'])
      assert.throws(
        () => cageGlb({ ...template, [field]: undefined }),
        (error) =>
          error instanceof CagecastError &&
          new RegExp(`^cageGlb: cage\\.${field} is (undefined|missing)`).test(error.message),
      );
  });
});
