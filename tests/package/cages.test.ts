// cagecast/cages, for arrays and for models that glTF-Transform or three.js has loaded.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { Document, NodeIO } from '@gltf-transform/core';
import { KHRONOS_EXTENSIONS } from '@gltf-transform/extensions';
import { type CagecastError, type Code, init, inspect, type Mesh } from 'cagecast';
import {
  type Cage,
  type CageModel,
  cageGlb,
  excludedByName,
  findLandmarks,
  fitCage,
  loadTemplate,
  makeCage,
  type Regions,
  refineCage,
  type Template,
  type TemplateName,
  templateNames,
  terminate,
} from 'cagecast/cages';
import * as gltf from 'cagecast/gltf';
import * as three from 'cagecast/three';
import {
  type Bone,
  BufferGeometry,
  Color,
  CompressedTexture,
  DataTexture,
  Float32BufferAttribute,
  Group,
  Mesh as Mesh3,
  MeshBasicMaterial,
} from 'three';
import { GLTFLoader, type GLTF as Loaded } from 'three/addons/loaders/GLTFLoader.js';
import { cagecast } from '../support/command.js';
import { countingEnds } from '../support/ended-workers.js';
import { GlbMaker, validate } from '../support/gltf.js';
import { printed } from '../support/script.js';
import { temporaryFolder } from '../support/temporary.js';
import { faceAvatar, kFace } from './face-avatars.js';
import { ball, join3d } from './scenes.js';

before(init);

/** On the thread of the tests. */
const here = { worker: false } as const;
const { at } = temporaryFolder('cages');
Object.assign(globalThis, { self: globalThis }); // which GLTFLoader expects

const read = (bytes: Uint8Array): Promise<Document> =>
  new NodeIO().registerExtensions(KHRONOS_EXTENSIONS).readBinary(new Uint8Array(bytes));
const load = (bytes: Uint8Array): Promise<Loaded> => new GLTFLoader().parseAsync(Uint8Array.from(bytes).buffer, '');
const near = (a: ArrayLike<number>, b: readonly number[], what: string) =>
  b.forEach((x, k) => assert.ok(Math.abs(a[k]! - x) < 1e-5, `${what}: ${Array.from(a)}, not ${b}`));

/** An egg with two balls in it that stick out in front: a head, as far as making a cage is concerned. */
function head(detail = 12): CageModel & Mesh {
  const skin = ball([0, 0, 0], (phi, theta) => 1 + 0.1 * Math.cos(theta) + 0.02 * Math.cos(phi), detail, 2 * detail);
  const eyes = [-0.35, 0.35].map((x) => ball([x, -0.85, 0.2], () => 0.18, 8, 16));
  const { positions, indices, groups } = join3d(skin, ...eyes);
  return { positions, indices, groups, names: ['skin', ['Eye.L', 'white'], ['Eye.R', 'white']] };
}

/** A coarse grid: these tests are not about what a good cage is. */
const options = { kind: 'head', triangles: 300, voxels: 60 } as const;
/** Of a cage: one outline. */
const regions: Regions = {
  lips: [
    [
      [0.4, 0.5],
      [0.6, 0.5],
      [0.5, 0.6],
    ],
  ],
};

type Case = [call: () => unknown, code: Code, says: string | RegExp];

/** Asserts that calls fail with a code and a sentence that begins with the function and the argument at fault, if there is one. */
async function assertFailures(fn: string, cases: readonly Case[]): Promise<void> {
  for (const [call, code, says] of cases)
    await assert.rejects(
      async () => call(),
      (error: CagecastError) => {
        assert.deepEqual([error.name, error.code, error.fn], ['CagecastError', code, fn], error.message);
        if (typeof says === 'string') assert.equal(error.reason, says);
        else assert.match(error.reason, says);
        const named = /^(model|template|landmarks|options|cage)\b/.exec(error.reason);
        if (named) assert.equal(error.argument, named[0], error.message);
        return true;
      },
    );
}

const rising = (shares: readonly number[]) => assert.ok(shares.every((share, i) => share >= (shares[i - 1] ?? 0)));

describe('makeCage', () => {
  test('makes a cage that fits, with holes over the parts that are excluded by name; at once, it is the same', async () => {
    const model = head();
    const progress: [number, string][] = [];
    const cage = await makeCage(model, { ...options, onProgress: (...step) => void progress.push(step) });
    assert.equal(cage.uvs.length / 2, cage.positions.length / 3);
    assert.ok(cage.uvs.every((x) => x >= 0 && x <= 1));
    assert.equal(cage.kind, 'head');
    const { verdict, holes } = inspect(cage, model);
    assert.deepEqual([verdict === 'unfit', holes.length], [false, 2]);
    const shares = progress.map(([share]) => share);
    rising(shares);
    assert.ok(shares[0]! < 0.5 && shares.at(-1) === 1, shares.join());
    assert.ok(new Set(progress.map(([, stage]) => stage)).size > 2);
    assert.deepEqual(model, head(), 'the arguments are copied');
    assert.deepEqual(await makeCage(model, { ...options, ...here }), cage);
    assert.equal((await makeCage(model, { ...options, ...here, kind: 'automatic' })).kind, 'head');
  });

  test('takes lists of parts, and marks, beside what names say', async () => {
    const names = ['skin', ['Eye.L', 'white'], 'eyelid'];
    assert.deepEqual(await excludedByName(names), [false, true, false]);
    assert.deepEqual(await excludedByName(names, here), [false, true, false]);
    const model = head();
    const marks = Uint8Array.from({ length: model.indices.length / 3 }, (_, t) =>
      Number(model.groups![model.indices[3 * t]!] === 1),
    );
    for (const [of, holes] of [
      [model, 0],
      [{ ...model, marks }, 1],
    ] as const)
      assert.equal(
        inspect(await makeCage(of, { ...options, ...here, parts: { keep: ['*'] } }), model).holes.length,
        holes,
      );
  });

  test('is cancelled at once by its signal, and the next call starts anew', async () => {
    // At the first report and in the middle of the work, however fast it is.
    for (const from of [0, 0.4])
      await countingEnds(async (ended) => {
        const controller = new AbortController();
        let isSettled = false;
        let wasSettled: boolean | undefined;
        const onProgress = (share: number) => {
          if (share < from || controller.signal.aborted) return;
          controller.abort(new Error('never mind'));
          setImmediate(() => (wasSettled = isSettled));
        };
        const given = { ...options, triangles: 2000, signal: controller.signal, onProgress };
        const call = makeCage(head(40), given).finally(() => (isSettled = true));
        await assert.rejects(call, /never mind/);
        await new Promise((done) => setImmediate(done));
        assert.equal(wasSettled, true, 'before anything else happens');
        assert.equal(ended(), 1, 'its worker is ended');
      });
    await assert.rejects(makeCage(head(), { signal: AbortSignal.abort() }), { name: 'AbortError' });
    // So it is by what onProgress throws, and by `terminate`.
    const own = new Error('of the callback');
    const onProgress = () => {
      throw own;
    };
    await assert.rejects(makeCage(head(), { ...options, onProgress }), own);
    const calls = [makeCage(head(), options), makeCage(head(), options)];
    terminate();
    for (const call of calls) await assert.rejects(call, { code: 'aborted' });
    assert.ok((await makeCage(head(), options)).indices.length > 0);

    await assert.rejects(makeCage(head(), { ...options, ...here, onProgress }), own);
    await assert.rejects(makeCage(head(), { ...here, signal: AbortSignal.abort() }), { name: 'AbortError' });
  });

  test('says in a sentence what is wrong with its arguments', async () => {
    const model = head();
    const nan = model.positions.slice();
    nan[4] = Number.NaN;
    const gone = new Uint8Array(model.indices.length / 3).fill(1, 0, 20);
    structuredClone(gone, { transfer: [gone.buffer] });
    const call = (change: object | null, given?: unknown) => () =>
      makeCage((change && { ...model, ...change }) as CageModel, given as object);
    const joint = (more: object) => ({ joints: [{ name: 'hips', position: [0, 1, 2], ...more }] });
    await assertFailures('makeCage', [
      [call(null), 'badArgument', 'model is null, not a mesh { positions, indices, … }'],
      [
        () => makeCage({ scene: 1 } as never),
        'badArgument',
        'model has no positions; await cageModel() of cagecast/gltf or cagecast/three',
      ],
      [call({ positions: [1] }), 'badArgument', 'model.positions is of type Array, not a Float32Array'],
      [call({ names: 'skin' }), 'badArgument', 'model.names is "skin", not an array'],
      [call({ names: [['a', 1]] }), 'badArgument', 'model.names[0] is of type Array, not a name or an array of names'],
      [call({ parts: ['skin'] }), 'badArgument', /^model\.parts is not there any more; .* as model\.names$/],
      [
        call({ joints: {} }),
        'badArgument',
        'model.joints is of type Object, not an array of joints { name, position, parent }',
      ],
      [call({ joints: [{}] }), 'badArgument', 'model.joints[0].name is undefined, not a name'],
      [
        call(joint({ position: [0, 1] })),
        'badArgument',
        'model.joints[0].position is of type Array, not 3 finite numbers',
      ],
      [call(joint({ parent: 0.5 })), 'badArgument', 'model.joints[0].parent is 0.5, not a whole number'],
      [call({ marks: [1] }), 'badArgument', 'model.marks is of type Array, not a Uint8Array'],
      [
        () => makeCage({ ...model, marks: gone }, here),
        'badArgument',
        /^model\.marks has 0 numbers, not 1 for each of \d+ triangles$/,
      ],
      [call({}, null), 'badOption', 'options is null, not an object'],
      [
        call({}, { size: 1 }),
        'badOption',
        'options.size is unknown; there are: kind, triangles, closing, offset, voxels, parts',
      ],
      [
        call({}, { kind: 'hand' }),
        'badOption',
        'options.kind = "hand" is unknown; there are: "automatic", "head", "body", "prop"',
      ],
      [call({}, { exclude: ['eye*'] }), 'badOption', /^options\.exclude is unknown; there are: .*, parts$/],
      [call({}, { parts: { keep: 'eye*' } }), 'badOption', /^options\.parts\.keep is "eye\*", not an array of numbers/],
      [call({}, { parts: { keep: [3] } }), 'badOption', 'options.parts.keep has group 3, of which there is no vertex'],
      [call({}, { offset: -1 }), 'badOption', 'options.offset is -1, not a number of at least 0'],
      [call({}, { triangles: 0.5 }), 'badOption', 'options.triangles is 0.5, not a whole number'],
      [call({}, { onProgress: 1 }), 'badOption', 'options.onProgress is 1, not a function'],
      [call({}, { worker: 1 }), 'badOption', 'options.worker is 1, not true or false'],
      [call({}, { worker: false, onProgress: 1 }), 'badOption', 'options.onProgress is 1, not a function'],
      [call({}, { worker: false, signal: 1 }), 'badOption', 'options.signal is 1, not an AbortSignal'],
      [call({}, { signal: 1 }), 'badOption', 'options.signal is 1, not an AbortSignal'],
      [call({ indices: new Uint32Array(0) }), 'badModel', 'model has no triangles; at least one is needed'],
      [call({ positions: nan }), 'badModel', 'model.positions[4] = NaN is not a finite number'],
    ]);
    await assertFailures('excludedByName', [
      [() => excludedByName('eye' as never, here), 'badArgument', 'names is "eye", not an array'],
      [() => excludedByName(['eye'], { worker: 1 as never }), 'badOption', 'options.worker is 1, not true or false'],
    ]);
  });

  test('a model that does not fit is outOfMemory, and the next call works', async () => {
    // 2.4 GB of zeros that are never touched: more than a WebAssembly memory can hold.
    const huge = { positions: new Float32Array(6e8), indices: new Uint32Array([0, 1, 2]) };
    const cage = await makeCage(head(), { ...options, ...here });
    for (const [fn, call] of [
      ['makeCage', () => makeCage(huge, here)],
      ['fitCage', () => fitCage(cage, huge, undefined, here)],
      ['findLandmarks', () => findLandmarks(huge, here)],
      ['refineCage', () => refineCage(cage, huge, here)],
    ] as const)
      await assert.rejects(call, { code: 'outOfMemory', message: `${fn}: not enough memory` });
    assert.deepEqual(await makeCage(head(), { ...options, ...here }), cage);
  });

  test('an idle worker does not keep a process alive', () => {
    const script = `
      import { excludedByName } from 'cagecast/cages';
      console.log((await excludedByName(['eye']))[0]);`;
    assert.equal(printed(script), 'true');
  });
});

describe('fitCage', () => {
  let template: Cage;
  let model: CageModel;
  before(async () => {
    template = await loadTemplate('human-head');
    const own = await gltf.cageModel(await new NodeIO().read('examples/samples/human/target.glb'));
    // Another place and size than the template's.
    model = { ...own, positions: own.positions.map((x, i) => 2 * x + (i % 3 === 1 ? 5 : 0)) };
  });

  test('does not wait for another call that is running, and comes to the same', async () => {
    const controller = new AbortController();
    let isRunning = true;
    const fine = { voxels: 400, triangles: 20_000, signal: controller.signal } as const; // half a minute
    const other = makeCage(head(60), fine).catch((error: unknown) => error);
    void other.finally(() => (isRunning = false));
    const fits = await Promise.all([fitCage(template, model), fitCage(template, model)]);
    assert.ok(isRunning);
    controller.abort('enough');
    assert.equal(await other, 'enough');
    const alone = await fitCage(template, model, undefined, here);
    for (const fit of fits) assert.deepEqual(fit, alone);
  });

  test('moves a template onto a model, by the landmarks that are given; triangles, UVs and holes stay', async () => {
    const shares: number[] = [];
    const [x, y, z] = template.landmarks['nose_tip']!;
    const nose = [2 * x, 2 * y + 5, 2 * z] as const;
    const onProgress = (share: number) => void shares.push(share);
    const { cage, used, confidence, missing } = await fitCage(template, model, { nose_tip: nose }, { onProgress });
    assert.deepEqual([cage.uvs, cage.indices], [template.uvs, template.indices]);
    assert.deepEqual([cage.holes, cage.kind, cage.regions], [template.holes, 'head', template.regions]);
    assert.notEqual(inspect(cage, model).verdict, 'unfit');
    rising(shares);
    assert.equal(shares.at(-1), 1);
    near(used['nose_tip']!, nose, 'the nose');
    assert.equal(confidence['nose_tip'], 1);
    const names = Object.keys(template.landmarks);
    assert.ok(Object.keys(used).length > 5);
    for (const name of [...Object.keys(used), ...missing]) assert.ok(names.includes(name), name);
    for (const name of Object.keys(used)) assert.ok(confidence[name]! > 0 && confidence[name]! <= 1);
  });

  test('of a head leaves clothes bare, unless they are kept', async () => {
    const [x, y, z] = template.landmarks['chin']!;
    const [count, group] = [model.positions.length / 3, model.names!.length];
    const shirt = [x, y - 0.1, z, x + 0.1, y - 0.1, z, x, y - 0.2, z].map((v, i) => 2 * v + (i % 3 === 1 ? 5 : 0));
    const dressed = {
      ...model,
      positions: Float32Array.of(...model.positions, ...shirt),
      indices: Uint32Array.of(...model.indices, count, count + 1, count + 2),
      groups: Uint32Array.of(...model.groups!, group, group, group),
      names: [...model.names!, ['Shirt']],
      vertexJoints: undefined,
      uvs: undefined,
      baseColors: undefined,
    };
    for (const keep of [[], ['Shirt']]) {
      const { cage } = await fitCage(template, dressed, {}, { parts: { keep } });
      assert.equal(cage.bare?.includes('Shirt'), keep.length === 0);
    }
  });

  test('finds landmarks', async () => {
    const { landmarks, confidence, kind, rig, missing } = await findLandmarks(model);
    assert.ok(Object.keys(landmarks).length > 5);
    assert.deepEqual(Object.keys(confidence), Object.keys(landmarks));
    assert.deepEqual([kind, rig, missing.includes('nape')], ['head', '', true]);
    for (const name of missing) assert.ok(!(name in landmarks), name);
    assert.deepEqual(await findLandmarks(model, here), { landmarks, confidence, kind, rig, missing });
  });

  test('puts the holes where morph targets say that eyes and mouth are, unless other landmarks are given', async () => {
    const targets = { eyeBlinkLeft: 'left eye', eyeBlinkRight: 'right eye', jawOpen: 'jaw' } as const;
    const [file, cageFile] = [at('avatar.glb'), at('cage.glb')];
    writeFileSync(file, faceAvatar(targets));
    await cagecast('fit', file, '--template', 'human-head', '-o', cageFile);
    const { positions, holes } = gltf.cageTemplate(await new NodeIO().read(cageFile));
    const share = kFace.eye[1] - kFace.mouth[1];
    const [x, y] = kFace.eye;
    for (const [name, [left, up]] of Object.entries({ eye_left: [x, y], eye_right: [-x, y], mouth: kFace.mouth })) {
      const loop = holes![name]!;
      const middle = [0, 1].map((k) => loop.reduce((sum, v) => sum + positions[3 * v + k]! / loop.length, 0));
      assert.ok(Math.hypot(middle[0]! - left!, middle[1]! - up!) < 0.15 * share, `${name}: ${middle}`);
    }
    const avatar = await gltf.cageModel(await new NodeIO().read(file));
    const guessed = async (hints: object) => {
      const { guessed, used, cage } = await fitCage(template, { ...avatar, hints } as CageModel, undefined, here);
      const known = Object.keys(used).filter((name) => !guessed.includes(name));
      assert.deepEqual(Object.keys(cage.landmarks), known, 'a guess is no landmark of the cage');
      return guessed;
    };
    assert.equal((await guessed({}))[0], 'eye_centre_left');
    assert.deepEqual(await guessed(avatar.hints!), []);
    const corner = [0.25, -0.5, 0.68] as const;
    const { used } = await fitCage(template, avatar, { mouth_corner_left: corner }, here);
    near(used['mouth_corner_left']!, corner, 'the corner');
    await assert.rejects(guessed({ mouth: [0] }), {
      message: 'fitCage: model.hints.mouth is of type Array, not 3 finite numbers [x, y, z]',
    });
  });

  test('says in a sentence what is wrong with its arguments', async () => {
    const { uvs: _, ...bare } = template;
    const call =
      (change: object | null, more: object = {}, ...rest: unknown[]) =>
      () =>
        (fitCage as (...args: unknown[]) => unknown)(
          change && { ...template, ...change },
          { ...model, ...more },
          ...rest,
        );
    const none = new Uint32Array(0);
    await assertFailures('fitCage', [
      [call(null), 'badArgument', /^template is null, not a mesh/],
      [call({}, {}, { parts: {} }), 'badArgument', /^landmarks\.parts is an option; options come after landmarks: /],
      [() => fitCage(bare as Template, model), 'missingUvs', /^template\.uvs is missing/],
      [
        call({ landmarks: [1] }),
        'badArgument',
        /^template\.landmarks is of type Array, not an object of names and positions/,
      ],
      [
        call({ landmarks: { chin: [0] } }),
        'badArgument',
        /^template\.landmarks\.chin is of type Array, not 3 finite numbers/,
      ],
      [
        call({ kind: 'hand' }),
        'badArgument',
        /^template\.kind is "hand", not one of "automatic", "head", "body", "prop"/,
      ],
      [call({}, {}, { chin: 'low' }), 'badArgument', /^landmarks\.chin is "low", not 3 finite numbers/],
      [call({}, {}, {}, { triangles: 5 }), 'badOption', /^options\.triangles is unknown; there are: parts$/],
      [call({ indices: none }), 'badTemplate', /template/],
      [call({}, { baseColors: 3 }), 'badArgument', 'model.baseColors is 3, not an array of { factor, image }'],
      [
        call({}, { baseColors: [{ factor: [1] }] }),
        'badArgument',
        /^model\.baseColors\[0\]\.factor is .*, not 3 numbers within 0\.\.1/,
      ],
      [
        call({}, { baseColors: [{ image: { width: 1, height: 1, data: [1, 2, 3, 4] } }] }),
        'badArgument',
        /^model\.baseColors\[0\]\.image is .*, not an image \{ width, height, data \} of bytes/,
      ],
      [
        call({}, { baseColors: [{ image: { width: 1, height: 1, data: new Uint8ClampedArray(3) } }] }),
        'badModel',
        /^model\.baseColors\[0\] has a factor outside 0\.\.1, or an image without 4 bytes per pixel/,
      ],
      [call({}, {}, { antler: [0, 0, 0] }), 'badLandmarks', /^landmarks: antler is .* outside the box/],
    ]);
  });
});

describe('refineCage', () => {
  test('moves a cage that is off into place; triangles, UVs, holes and landmarks stay, and so does a cage in place', async () => {
    const model = head();
    const landmarks = { nose_tip: [0, -1.1, 0] as [number, number, number] };
    const made = { ...(await makeCage(model, { ...options, ...here })), landmarks, holes: { eye: [0, 1, 2] }, regions };
    assert.deepEqual((await refineCage(made, model)).positions, made.positions);
    const moved = (by: number) => ({ ...made, positions: made.positions.map((x, i) => x + (i % 3 === 0 ? by : 0)) });
    const off = moved(0.06);
    const back = await refineCage(off, model, { reach: 0.05 });
    assert.deepEqual([back.uvs, back.indices, back.holes, back.kind], [made.uvs, made.indices, made.holes, 'head']);
    assert.deepEqual(back.regions, regions);
    assert.deepEqual(back.landmarks, landmarks);
    const distance = (cage: Cage) =>
      cage.positions.reduce((sum, x, i) => sum + Math.abs(x - made.positions[i]!), 0) / made.positions.length;
    assert.ok(distance(back) < 0.5 * distance(off), `${distance(back)} of ${distance(off)}`);

    const call =
      (change: object, given = {}) =>
      () =>
        refineCage({ ...off, ...change } as Template, model, given);
    await assertFailures('refineCage', [
      [call({ uvs: undefined }), 'missingUvs', /^cage\.uvs/],
      [call(moved(9)), 'badTemplate', /^cage/],
      [call({}, { reach: -1 }), 'badOption', /^options\.reach/],
      [call({ holes: { mouth: 7 } }), 'badArgument', 'cage.holes.mouth is 7, not an array of vertices'],
      [call({ holes: new Map() }), 'badArgument', /^cage\.holes is .*, not an object/],
      [
        call({ regions: { lips: [[0, 1]] } }),
        'badArgument',
        /^cage\.regions\.lips is .*, not outlines, each of at least 3 corners/,
      ],
      [call({ landmarks: { a: 'x' } }), 'badArgument', /^cage\.landmarks\.a is "x", not 3 finite numbers/],
      [call({ kind: 'bogus' }), 'badArgument', /^cage\.kind is "bogus", not one of "automatic"/],
    ]);
  });

  test('its result shares nothing with what was given', async () => {
    const template = await loadTemplate('human-head');
    const before = structuredClone(template);
    const { indices } = template;
    const model = { positions: template.positions.map((x) => 0.98 * x), indices };
    const cage = await refineCage(template, model, here);
    for (const loop of Object.values(cage.holes)) (loop as number[]).length = 0;
    for (const position of Object.values(cage.landmarks)) (position as unknown as number[])[0] = 99;
    assert.deepEqual(template, before);
  });
});

test('loadTemplate gives what glTF-Transform reads of its file, and refuses other names', async () => {
  for (const name of templateNames) {
    const document = await new NodeIO().read(`examples/samples/templates/${name}.glb`);
    const [loaded, read] = [await loadTemplate(name), gltf.cageTemplate(document)];
    for (const one of [loaded, read]) one.positions.forEach((x, i) => (one.positions[i] = x + 0)); // not -0
    assert.deepEqual(loaded, read);
  }
  await assertFailures('loadTemplate', [
    [() => loadTemplate('dog' as TemplateName), 'badArgument', /^name is "dog", not one of "human-head", "human-body"/],
  ]);
});

/** A matrix that moves. */
const moving = (x: number, y: number, z: number) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1];

/**
 * A figure in centimetres under a node that makes metres of them, with hips at (0, 1, 0) and a head at (0, 1.5, 0.1) in the scene, and
 * a node between the two that is no joint.
 * @param extensions  Of the file.
 */
function figure(extensions: object = {}): Uint8Array {
  const maker = new GlbMaker();
  const body = ball([0, 120, 0], () => 30, 6, 12);
  const vertices = body.positions.length / 3;
  const mesh = maker.mesh(body);
  const hat = maker.mesh(body);
  // Every third vertex is held by the second joint most.
  const weights = Float32Array.from({ length: 4 * vertices }, (_, i) => [0.4, Number(i % 12 === 1), 0, 0][i % 4]!);
  Object.assign(maker.json.meshes[mesh]!.primitives[0]!.attributes, {
    JOINTS_0: maker.accessor(
      Uint8Array.from({ length: 4 * vertices }, (_, i) => Number(i % 4 === 1)),
      'VEC4',
    ),
    WEIGHTS_0: maker.accessor(weights, 'VEC4'),
  });
  const inverses = Float32Array.from([...moving(0, -100, 0), ...moving(0, -150, -10)]);
  const holder = maker.node({ name: 'body', mesh, skin: 0 }, false); // 0
  const neck = maker.node({ name: 'J_Head', translation: [0, 30, 10], children: [4] }, false); // 1
  const spine = maker.node({ name: 'spine', translation: [0, 20, 0], children: [neck] }, false); // 2
  const hips = maker.node({ name: 'J_Hips', translation: [0, 100, 0], children: [spine] }, false); // 3
  maker.node({ name: 'hat', mesh: hat, translation: [0, -150, -10] }, false); // 4
  maker.node({ name: 'Armature', scale: [0.01, 0.01, 0.01], children: [holder, hips] });
  maker.json.skins = [{ joints: [hips, neck], inverseBindMatrices: maker.accessor(inverses, 'MAT4') }];
  Object.assign(maker.json, { extensions, extensionsUsed: Object.keys(extensions) });
  return maker.finish();
}

/** What each source of a model says of it: a document, and a loaded scene. */
const modelsOf = async (bytes: Uint8Array, extensions = {}) =>
  [await gltf.cageModel(await read(bytes), { extensions }), await three.cageModel(await load(bytes))] as const;

describe('cageModel', () => {
  test('gives joints where the extracted mesh has them, in its own space and unit, in the bind pose', async () => {
    const loaded = await load(figure());
    const models = [await gltf.cageModel(await read(figure())), await three.cageModel(loaded)];
    (loaded.scene.getObjectByName('J_Head') as Bone).position.x += 50;
    models.push(await three.cageModel(loaded));
    assert.deepEqual(models[2]!.positions, models[1]!.positions);
    for (const { positions, joints, vertexJoints } of models) {
      const heights = positions.filter((_, i) => i % 3 === 1);
      near([Math.min(...heights), Math.max(...heights)], [0.9, 1.5], 'heights');
      const names = joints!.map(({ name, parent }) => [name, parent]);
      assert.deepEqual(names, [
        ['J_Hips', -1],
        ['J_Head', 0],
      ]);
      near(joints![0]!.position, [0, 1, 0], 'hips');
      near(joints![1]!.position, [0, 1.5, 0.1], 'head');
      const count = positions.length / 6;
      const held = Array.from({ length: 2 * count }, (_, v) => Number(v >= count || v % 3 === 0));
      assert.deepEqual([...vertexJoints!], held);
    }
  });

  test('calls glass what can be looked through', async () => {
    const maker = new GlbMaker();
    const mesh = maker.mesh(ball([0, 0, 0], () => 1, 6, 12));
    const pane = { alphaMode: 'BLEND' as const, pbrMetallicRoughness: { baseColorFactor: [1, 1, 1, 0.4] as never } };
    maker.json.materials = [
      { name: 'Pane', ...pane },
      { name: 'Visor', extensions: { KHR_materials_transmission: { transmissionFactor: 0.9 } } },
      { name: 'Hair', alphaMode: 'BLEND' },
    ];
    maker.json.extensionsUsed = ['KHR_materials_transmission'];
    const { attributes, indices } = maker.json.meshes[mesh]!.primitives[0]!;
    maker.json.meshes[mesh]!.primitives = [0, 1, 2].map((material) => ({ attributes, indices, material }) as never);
    maker.node({ name: 'all', mesh });
    for (const { names } of await modelsOf(maker.finish()))
      assert.deepEqual(
        names!.map((own) => own.includes('glass')),
        [true, true, false],
      );
  });

  test('has base colours, as far as images can be read', async () => {
    const pixels = Uint8Array.of(10, 20, 30, 0, 200, 100, 50, 255);
    const colorOf = { asIs: [...pixels], opaque: [10, 20, 30, 255, 200, 100, 50, 255] };
    const corners = { position: [0, 0, 0, 1, 0, 0, 0, 1, 0], uv: [0, 0, 1, 0, 0, 1] };

    const document = new Document();
    document.createBuffer();
    const accessor = (type: 'VEC2' | 'VEC3', values: number[]) =>
      document.createAccessor().setType(type).setArray(Float32Array.from(values));
    const texture = document.createTexture().setMimeType('image/png').setImage(Uint8Array.of(1));
    const unread = document.createTexture().setMimeType('image/ktx2').setImage(Uint8Array.of(2));
    const scene = document.createScene();
    const materials = [
      document.createMaterial().setBaseColorTexture(texture).setBaseColorFactor([0.5, 2, 1, 1]),
      document.createMaterial().setBaseColorTexture(texture).setAlphaMode('MASK'),
      document.createMaterial().setBaseColorTexture(unread),
      null,
    ];
    for (const material of materials) {
      const primitive = document
        .createPrimitive()
        .setAttribute('POSITION', accessor('VEC3', corners.position))
        .setMaterial(material);
      if (material) primitive.setAttribute('TEXCOORD_0', accessor('VEC2', corners.uv));
      scene.addChild(document.createNode().setMesh(document.createMesh().addPrimitive(primitive)));
    }
    const ofDocument = await gltf.cageModel(document, {
      decode: async ([first]) => {
        if (first === 2) throw new Error('KTX2');
        return { width: 2, height: 1, data: pixels };
      },
    });

    const geometry = new BufferGeometry()
      .setAttribute('position', new Float32BufferAttribute(corners.position, 3))
      .setAttribute('uv', new Float32BufferAttribute(corners.uv, 2));
    const map = new DataTexture(pixels, 2, 1);
    const bare = geometry.clone().deleteAttribute('uv');
    const compressed = new CompressedTexture([], 2, 1);
    const group = new Group().add(
      new Mesh3(geometry, new MeshBasicMaterial({ map, color: new Color(0.5, 2, 1) })),
      new Mesh3(geometry, new MeshBasicMaterial({ map, alphaTest: 0.5 })),
      new Mesh3(geometry, new MeshBasicMaterial({ map: compressed })),
      new Mesh3(bare, new MeshBasicMaterial()),
    );
    const ofScene = await three.cageModel(group);

    for (const { baseColors, uvs } of [ofDocument, ofScene]) {
      assert.deepEqual(
        baseColors!.map(({ image }) => image && [...image.data]),
        [colorOf.opaque, colorOf.asIs, undefined, undefined],
      );
      assert.deepEqual(baseColors![0]!.factor, [0.5, 1, 1]);
      assert.deepEqual([...uvs!.subarray(0, 12)], [...corners.uv, ...corners.uv]);
      assert.deepEqual([...uvs!.subarray(18)], [0, 0, 0, 0, 0, 0]);
    }
    // A picture larger than what shows a face is made smaller, and one that is upside down is turned.
    const rows = new DataTexture(Uint8Array.of(1, 1, 1, 255, 9, 9, 9, 255), 1, 2);
    rows.flipY = true;
    const large = new DataTexture(new Uint8Array(4 * 1024 * 16).fill(7), 1024, 16);
    for (const [texture, size, first] of [
      [rows, [1, 2], 9],
      [large, [512, 8], 7],
    ] as const) {
      const mesh = new Mesh3(geometry, new MeshBasicMaterial({ map: texture }));
      const { width, height, data } = (await three.cageModel(mesh)).baseColors![0]!.image!;
      assert.deepEqual([width, height, data[0]], [...size, first]);
    }
  });

  test('names the joints of a VRM by its bones; damaged tables are no reason to refuse a model', async () => {
    const bones = { hips: { node: 3 }, head: { node: 1 } };
    const list = Object.entries(bones).map(([bone, { node }]) => ({ bone, node }));
    const known = ['hips', 'head'];
    for (const [extensions, names] of [
      [{ VRMC_vrm: { humanoid: { humanBones: bones } } }, known],
      [{ VRM: { humanoid: { humanBones: list } } }, known],
      [{ VRM: 3 }, ['J_Hips', 'J_Head']],
      [{ VRMC_vrm: { humanoid: { humanBones: { hips: null, head: { node: 99 } } } } }, ['J_Hips', 'J_Head']],
    ] as const) {
      for (const { joints } of await modelsOf(figure(extensions), extensions))
        assert.deepEqual(
          joints!.map(({ name }) => name),
          names,
        );
    }
  });

  test('has hints where the face is, by what morph targets do, whatever naming they follow', async () => {
    const vrm0 = [
      { presetName: 'blink', binds: [{ mesh: 0, index: 0, weight: 100 }] },
      { presetName: 'a', binds: [{ mesh: 0, index: 1, weight: 100 }] },
    ];
    const vrm1 = {
      blink: { morphTargetBinds: [{ node: 0, index: 0, weight: 1 }] },
      aa: { morphTargetBinds: [{ node: 0, index: 1, weight: 1 }] },
    };
    const bare = { t0: 'both eyes', t1: 'jaw' } as const;
    const cases: [targets: Parameters<typeof faceAvatar>[0], extensions?: object][] = [
      [{ eyeBlinkLeft: 'left eye', eyeBlinkRight: 'right eye', browInnerUp: 'lips', jawOpen: 'jaw' }],
      [{ eyeBlink_L: 'left eye', eyeBlink_R: 'right eye', viseme_aa: 'jaw' }],
      [{ 'Face.Fcl_EYE_Close_L': 'left eye', 'Face.Fcl_EYE_Close_R': 'right eye', 'Face.Fcl_MTH_A': 'jaw' }],
      [{ まばたき: 'both eyes', ｳｨﾝｸ: 'left eye', あ: 'jaw' }],
      [{ blink: 'both eyes', mouthPucker: 'lips' }],
      [bare, { VRM: { blendShapeMaster: { blendShapeGroups: vrm0 } } }],
      [bare, { VRMC_vrm: { expressions: { preset: vrm1 } } }],
    ];
    const off = (place: readonly number[] | undefined, [x, y]: readonly [number, number]) =>
      Math.hypot(Math.abs(place![0]!) - x, place![1]! - y) / (kFace.eye[1] - kFace.mouth[1]);
    for (const [targets, extensions = {}] of cases) {
      const models = await modelsOf(faceAvatar(targets, extensions), extensions);
      assert.deepEqual(models[1]!.hints, models[0]!.hints);
      const hints = models[0]!.hints!;
      const what = `${Object.keys(targets)} ${JSON.stringify(hints)}`;
      for (const side of ['left', 'right']) {
        const [inner, outer] = [hints[`eye_inner_${side}`]!, hints[`eye_outer_${side}`]!];
        assert.ok(off([(inner[0] + outer[0]) / 2, inner[1]], kFace.eye) < 0.05, what);
      }
      assert.ok(off(hints['mouth'], kFace.mouth) < 0.05, what);
    }
    for (const [targets, extensions = {}] of [
      [bare, { VRM: { blendShapeMaster: { blendShapeGroups: [null, { binds: [null, { mesh: 9 }] }] } } }],
      [{ Fcl_MTH_Angry: 'jaw', eyeLookUpLeft: 'left eye' }],
    ] as typeof cases) {
      for (const { hints } of await modelsOf(faceAvatar(targets, extensions), extensions)) assert.deepEqual(hints, {});
    }
  });

  test('names parts by node, mesh and material', async () => {
    const maker = new GlbMaker();
    maker.json.materials = [{ name: 'skin' }, { name: 'EyeWhite' }];
    const [mesh, eye] = [0, 1].map((material) =>
      maker.mesh(
        ball([0, 0, material], () => 1, 4, 8),
        { material },
      ),
    );
    maker.json.meshes[mesh!]!.primitives.push(maker.json.meshes[eye!]!.primitives[0]!);
    maker.json.meshes[mesh!]!.name = 'Face.mesh';
    maker.node({ name: 'Face', mesh: mesh! });
    const [{ names: own }, { names }] = await modelsOf(maker.finish());
    assert.deepEqual(own, [
      ['Face', 'Face.mesh', 'skin', 'Face/skin'],
      ['Face', 'Face.mesh', 'EyeWhite', 'Face/EyeWhite'],
    ]);
    assert.ok(names!.length === 2 && names![0]!.includes('skin') && names![1]!.includes('EyeWhite'));
  });

  test('makeCage gives the same for a document and a scene', async () => {
    const { positions, indices, groups } = head();
    const maker = new GlbMaker();
    ['skin', 'Eye.L', 'Eye.R'].forEach((name, group) => {
      const corners = Uint32Array.from(indices).filter((_, i, all) => groups![all[i - (i % 3)]!] === group);
      maker.node({ name, mesh: maker.mesh({ positions, indices: corners }) });
    });
    const [document, model] = await modelsOf(maker.finish());
    const expected = await makeCage(document, options);
    assert.deepEqual(expected.bare, ['Eye.L', 'Eye.R']);
    // GLTFLoader takes points out of names.
    const bare = ['EyeL', 'Eye.L', 'EyeR', 'Eye.R'];
    assert.deepEqual(await makeCage(model, options), { ...expected, bare });
  });
});

describe('cageTemplate', () => {
  const { positions, uvs, indices } = ball([0, 0, 0], () => 1, 6, 12) as Mesh &
    Pick<Cage, 'positions' | 'uvs' | 'indices'>;
  const cage = {
    ...{ positions, uvs, indices },
    landmarks: { nose_tip: [0, 0, 1], chin: [0, -1, 0.5] },
    holes: { neck: [1, 2, 3] },
    kind: 'head',
    regions,
    bare: ['Eye.L'],
  } as const;
  const add = () => gltf.addCage(new Document(), cage);

  test('reads what cageGlb and addCage write', async () => {
    const bytes = cageGlb(cage);
    assert.deepEqual(await validate(bytes), []);
    const { document, node } = add();
    assert.equal(node.getName(), 'cage');
    const written = await new NodeIO().writeBinary(document);
    for (const found of [
      gltf.cageTemplate(await read(bytes)),
      gltf.cageTemplate(await read(written)),
      three.cageTemplate(await load(bytes)),
      three.cageTemplate(three.cageGeometry(cage)),
    ])
      assert.deepEqual(found, cage);
    // Indices of any width, and without what is not an array.
    const narrow = cageGlb({ positions, uvs, indices: Uint16Array.from(indices) });
    assert.deepEqual(gltf.cageTemplate(await read(narrow)).indices, indices);
  });

  test('moves landmarks with their node', async () => {
    const { document, node } = add();
    node.setScale([2, 2, 2]).setTranslation([0, 5, 0]);
    const loaded = await load(await new NodeIO().writeBinary(document));
    for (const { landmarks } of [gltf.cageTemplate(document), three.cageTemplate(loaded)])
      near(landmarks!['chin']!, [0, 3, 1], 'chin');
  });

  test('says what is wrong with extras, and with what is no document or cage', async () => {
    for (const [extras, says] of [
      [{ landmarks: [] }, '.extras.landmarks is not an object'],
      [{ landmarks: { chin: [0, 1] } }, '.extras.landmarks.chin is not 3 finite numbers [x, y, z]'],
      [{ holes: { neck: [1, 9999] } }, '.extras.holes.neck is not a list of vertices (0..90)'],
      [
        { regions: { lips: [[0, 1]] } },
        '.extras.regions.lips is not a list of outlines, each of at least 3 corners [u, v]',
      ],
    ] as const) {
      const { document, node } = add();
      node.setExtras(extras as unknown as Record<string, unknown>);
      const geometry = Object.assign(three.cageGeometry(cage), { userData: extras });
      await assertFailures('cageTemplate', [
        [() => gltf.cageTemplate(document), 'badArgument', `template: "cage"${says}`],
        [() => three.cageTemplate(geometry), 'badArgument', `"geometry"${says}`],
      ]);
    }
    const bare = add();
    bare.node.getMesh()!.listPrimitives()[0]!.setAttribute('TEXCOORD_0', null);
    const none = 'is of type Object, not a document of glTF-Transform';
    const document = new Document();
    await assertFailures('cageTemplate', [
      [() => gltf.cageTemplate(bare.document), 'missingUvs', /^template has/],
      [() => three.cageTemplate(three.cageGeometry(cage).deleteAttribute('uv')), 'missingUvs', /^template has/],
    ]);
    await assertFailures('cageModel', [[() => gltf.cageModel({} as never), 'badArgument', `model ${none}`]]);
    await assertFailures('addCage', [
      [() => gltf.addCage({} as never, cage), 'badArgument', `document ${none}`],
      [() => gltf.addCage(document, { cage } as never), 'badArgument', 'cage.positions is undefined, not an array'],
    ]);
    assert.equal(document.getRoot().listBuffers().length, 0, 'nothing is added');
    await assertFailures('cagecast', [
      [() => gltf.cagecast({ cage: {} as never })({} as never), 'badArgument', `target ${none}`],
    ]);
    await assertFailures(
      'cageGlb',
      ['positions', 'uvs', 'indices'].map((field) => [
        () => cageGlb({ ...cage, [field]: undefined }),
        'badArgument',
        new RegExp(`^cage\\.${field} is undefined`),
      ]),
    );
  });
});
