import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { getEventListeners } from 'node:events';
import { before, describe, test } from 'node:test';
import { Worker } from 'node:worker_threads';
import * as direct from 'cagecast';
import { CagecastError, type Mesh } from 'cagecast';
import * as slim from 'cagecast/slim';
import {
  classify,
  cutBorders,
  init,
  presetOptions,
  project,
  splitVertices,
  terminate,
  transfer,
} from 'cagecast/worker';
import { countingEnds } from '../support/ended-workers.js';
import { head } from './scenes.js';

const scene = head(30, 12);
const large = head(31, 200);

async function failure(promise: Promise<unknown>): Promise<unknown> {
  try {
    await promise;
  } catch (error) {
    return error;
  }
  assert.fail('it did not fail');
}

describe('the worker', () => {
  before(() => direct.init());

  test('gives the results of the package, without init', async () => {
    const projection = await project(scene.cage, scene.target);
    const expected = direct.project(scene.cage, scene.target);
    for (const name of [
      'uvs',
      'zones',
      'triangles',
      'distances',
      'segments',
      'indices',
      'segmentStats',
      'cornerUvs',
      'recovery',
      'holeShares',
      'preset',
    ] as const)
      assert.deepEqual(projection[name], expected[name], name);
    assert.deepEqual(await classify(projection, { threshold: 0.3 }), direct.classify(expected, { threshold: 0.3 }));
    const result = await transfer(scene.cage, scene.target, { threshold: 0.3 });
    assert.deepEqual(result.zones, direct.transfer(scene.cage, scene.target, { threshold: 0.3 }).zones);
    const locks = { groups: { 0: 'exclude' } } as const;
    assert.deepEqual(
      (await transfer(scene.cage, scene.target, { locks })).zones,
      direct.transfer(scene.cage, scene.target, { locks }).zones,
    );
    assert.deepEqual(
      await splitVertices(scene.target, result.cornerUvs),
      direct.splitVertices(scene.target, result.cornerUvs),
    );
    assert.deepEqual(
      await cutBorders(scene.cage, scene.target, result),
      direct.cutBorders(scene.cage, scene.target, result),
    );
    assert.deepEqual(await presetOptions('paper'), direct.presetOptions('paper'));
    await init();
  });

  test('carries out calls made at once in order', async () => {
    const order: number[] = [];
    await Promise.all(
      [0, 1, 2, 3].map((i) => transfer(scene.cage, scene.target, { threshold: i / 4 }).then(() => order.push(i))),
    );
    assert.deepEqual(order, [0, 1, 2, 3]);
  });

  test('copies its arguments, or takes them over when told to', async () => {
    const { cage, target } = structuredClone(scene);
    await transfer(cage, target);
    assert.deepEqual({ cage, target }, { cage: scene.cage, target: scene.target });
    await transfer(cage, target, { move: true });
    assert.equal(target.positions.length, 0);
    assert.equal(cage.indices.length, 0);
    const { cornerUvs } = direct.transfer(scene.cage, scene.target);
    await splitVertices(structuredClone(scene.target), cornerUvs, { move: true });
    assert.equal(cornerUvs.length, 0);
    // What was moved away cannot be sent again.
    const error = await failure(transfer(cage, target, { move: true }));
    assert.ok(error instanceof CagecastError, String(error));
  });

  test('calls that wait have the arguments as they were', async () => {
    const scratch = structuredClone(scene.target);
    const sizes = [1, 0.5, 0.25];
    const scaled = (size: number) => scene.target.positions.map((x) => size * x) as Float32Array;
    const calls = sizes.map((size) => {
      (scratch.positions as Float32Array).set(scaled(size));
      return transfer(scene.cage, scratch);
    });
    const moved = structuredClone(scene);
    calls.push(transfer(moved.cage, moved.target, { move: true }));
    assert.equal(moved.target.positions.length, 0, 'moved at once');
    const results = await Promise.all(calls);
    for (const [i, size] of [...sizes, 1].entries()) {
      const expected = direct.transfer(scene.cage, { ...scene.target, positions: scaled(size) });
      assert.deepEqual(results[i]!.distances, expected.distances, `call ${i}`);
    }
  });

  test('sends no more of a buffer than the arrays that are views of it', async () => {
    const { positions } = scene.target;
    const asset = new ArrayBuffer(positions.byteLength + 4096);
    new Float32Array(asset, 1024, positions.length).set(positions);
    const target = { ...scene.target, positions: new Float32Array(asset, 1024, positions.length) };
    const { postMessage } = Worker.prototype;
    const sent: number[] = [];
    Worker.prototype.postMessage = function (this: Worker, message: { args?: Mesh[] }, ...rest) {
      if (message.args) sent.push(message.args[1]!.positions.buffer.byteLength);
      postMessage.call(this, message, ...rest);
    };
    try {
      // The first is sent at once, the second waits.
      const results = await Promise.all([transfer(scene.cage, target), transfer(scene.cage, target)]);
      for (const result of results) assert.deepEqual(result.uvs, direct.transfer(scene.cage, scene.target).uvs);
    } finally {
      Worker.prototype.postMessage = postMessage;
    }
    assert.deepEqual(sent, [positions.byteLength, positions.byteLength]);
    assert.equal(asset.byteLength, positions.byteLength + 4096, 'it is left as it was');
  });

  test('one signal cancels all calls that wait, without a worker for each', async () => {
    await countingEnds(async (ended) => {
      const abort = new AbortController();
      const { signal } = abort;
      const calls = Array.from({ length: 8 }, () => failure(transfer(large.cage, large.target, { signal })));
      abort.abort('enough');
      assert.deepEqual(await Promise.all(calls), Array(8).fill('enough'));
      assert.ok((await transfer(scene.cage, scene.target)).zones.length > 0);
      assert.equal(ended(), 1);
    });
  });

  test('a signal has one listener, however many calls have it', async () => {
    const abort = new AbortController();
    const { signal } = abort;
    const call = () => transfer(scene.cage, scene.target, { signal }).catch((error: unknown) => error);
    const [first, ...others] = Array.from({ length: 12 }, call);
    assert.ok('zones' in ((await first) as object), 'it is carried out');
    others.push(call());
    assert.equal(getEventListeners(signal, 'abort').length, 1);
    abort.abort('enough');
    assert.equal((await Promise.all(others)).at(-1), 'enough');
  });

  test('many calls that cannot be sent are refused one after the other, and the next one works', async () => {
    const unsendable = { ...scene.target, extra: () => 0 } as unknown as typeof scene.target;
    const [first, ...others] = [scene.target, ...Array<typeof unsendable>(6000).fill(unsendable)].map((target) =>
      transfer(scene.cage, target),
    );
    assert.ok((await first)!.zones.length > 0);
    for (const error of await Promise.all(others.map(failure)))
      assert.ok(error instanceof CagecastError && error.code === 'badArgument', String(error));
    assert.ok((await transfer(scene.cage, scene.target)).zones.length > 0);
  });

  test('errors keep their class, code, argument and message', async () => {
    const error = await failure(transfer(scene.cage, { ...scene.target, indices: new Uint32Array([0, 1, 99999]) }));
    assert.ok(error instanceof CagecastError);
    assert.equal(error.code, 'indexOutOfRange');
    assert.equal(error.at, 2);
    assert.equal(error.argument, 'target');
    assert.match(error.message, /^transfer: target\.indices\[2\] = 99999 is out of range/);
    assert.equal(error.message, `transfer: ${error.reason}`);
    const cage = { positions: scene.cage.positions, indices: scene.cage.indices };
    assert.equal(((await failure(transfer(cage, scene.target))) as CagecastError).argument, 'cage');
    const unsendable = await failure(
      transfer(scene.cage, { ...scene.target, extra: () => 0 } as unknown as typeof scene.target),
    );
    assert.ok(unsendable instanceof CagecastError && unsendable.code === 'badArgument');
    const high = (await failure(transfer(scene.cage, scene.target, { threshold: 2 }))) as CagecastError;
    assert.deepEqual([high.code, high.argument], ['badOption', 'options']);
    const untyped = transfer as (...args: unknown[]) => Promise<unknown>;
    for (const [options, says] of [
      [{ signal: {} }, /^transfer: options\.signal is of type Object, not an AbortSignal/],
      [{ move: 'x' }, /^transfer: options\.move is "x", not true or false/],
    ] as const) {
      const wrong = await failure(untyped(scene.cage, scene.target, options));
      assert.ok(wrong instanceof CagecastError && wrong.code === 'badOption');
      assert.match(wrong.message, says);
    }
    await transfer(scene.cage, scene.target);
  });

  test('a running call is cancelled at once, and later ones continue', async () => {
    const controller = new AbortController();
    const first = failure(transfer(large.cage, large.target, { signal: controller.signal }));
    const second = transfer(scene.cage, scene.target);
    setImmediate(() => controller.abort(new Error('never mind'))); // however quick the machine, it is not done by then
    assert.equal(((await first) as Error).message, 'never mind');
    assert.deepEqual((await second).zones, direct.transfer(scene.cage, scene.target).zones);
  });

  test('cutting borders is cancelled at once, and later calls continue', async () => {
    const result = direct.transfer(large.cage, large.target);
    const controller = new AbortController();
    const cut = failure(cutBorders(large.cage, large.target, result, { signal: controller.signal }));
    setImmediate(() => controller.abort(new Error('never mind')));
    assert.equal(((await cut) as Error).message, 'never mind');
    assert.deepEqual((await transfer(scene.cage, scene.target)).zones, direct.transfer(scene.cage, scene.target).zones);
  });

  test('a waiting call is cancelled, and the running one continues', async () => {
    const controller = new AbortController();
    const first = transfer(scene.cage, scene.target);
    const second = failure(transfer(scene.cage, scene.target, { signal: controller.signal }));
    controller.abort();
    assert.equal(((await second) as Error).name, 'AbortError');
    assert.equal((await first).zones.length, scene.target.positions.length / 3);
    assert.equal(
      ((await failure(transfer(scene.cage, scene.target, { signal: controller.signal }))) as Error).name,
      'AbortError',
    );
  });

  test('terminate cancels waiting calls; the next call starts a new worker', async () => {
    const given = failure(transfer(large.cage, large.target));
    terminate();
    const error = await given;
    assert.ok(error instanceof CagecastError && error.code === 'aborted');
    await transfer(scene.cage, scene.target);
  });

  test('an idle worker does not keep a process alive', () => {
    const script = `
      import { init, transfer } from 'cagecast/worker';
      await init();
      const mesh = { positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]), indices: new Uint32Array([0, 1, 2]), uvs: new Float32Array(6) };
      console.log((await transfer(mesh, mesh)).zones.length);`;
    assert.equal(
      execFileSync(process.execPath, ['--input-type=module', '-e', script], {
        encoding: 'utf8',
        timeout: 60000,
      }).trim(),
      '3',
    );
  });

  test('if no worker can be started, the error says so', () => {
    const script = `
      import { init, transfer } from 'cagecast/worker';
      const mesh = { positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]), indices: new Uint32Array([0, 1, 2]), uvs: new Float32Array(6) };
      for (const call of [() => init(), () => transfer(mesh, mesh)]) await call().catch(({ code, message }) => console.log(code, message));`;
    const forbidden = [
      '--experimental-permission',
      '--no-warnings',
      '--allow-fs-read=*',
      '--input-type=module',
      '-e',
      script,
    ];
    const [ofInit, ofTransfer] = execFileSync(process.execPath, forbidden, { encoding: 'utf8', timeout: 60000 }).split(
      '\n',
    );
    assert.match(ofInit!, /^unsupported init: this host cannot start the worker \(.+\)$/);
    assert.match(ofTransfer!, /^unsupported transfer: this host cannot start the worker \(.+\)$/);
  });
});

describe('slim', () => {
  test('gives the same with the WebAssembly in a separate file', async () => {
    await Promise.all([slim.init(), direct.init()]);
    const { timings: _, peakBytes: _expectedBytes, ...expected } = direct.transfer(scene.cage, scene.target);
    const { timings: __, peakBytes: _resultBytes, ...result } = slim.transfer(scene.cage, scene.target);
    assert.deepEqual(result, expected);
  });
});
