import assert from 'node:assert/strict';
import { getEventListeners } from 'node:events';
import { before, describe, test } from 'node:test';
import { Worker } from 'node:worker_threads';
import type { CagecastError, Mesh } from 'cagecast';
import * as direct from 'cagecast';
import { classify, cutBorders, init, inspect, project, splitVertices, terminate, transfer } from 'cagecast/worker';
import { countingEnds } from '../support/ended-workers.js';
import { printed } from '../support/script.js';
import { head } from './scenes.js';

const { cage, target } = head(30, 12);
const large = head(31, 200);
const failure = (promise: Promise<unknown>): Promise<unknown> =>
  promise.then(
    () => assert.fail('it did not fail'),
    (error: unknown) => error,
  );
/** A result without what is measured. */
const plain = <Result extends object>({
  timings: _,
  peakBytes: __,
  ...rest
}: Result & { timings?: unknown; peakBytes?: unknown }) => rest;
/** That the worker works. */
const works = async () => assert.deepEqual((await transfer(cage, target)).zones, direct.transfer(cage, target).zones);

describe('the worker', () => {
  before(() => direct.init());

  test('gives the results of the package, without init', async () => {
    const [projection, expected] = [await project(cage, target), direct.project(cage, target)];
    assert.deepEqual(plain(projection), plain(expected));
    for (const options of [{ threshold: 0.3 }, { parts: { exclude: [0] } }]) {
      assert.deepEqual(await classify(projection, options), direct.classify(expected, options));
      const [here, there] = [direct.transfer(cage, target, options), await transfer(cage, target, options)];
      assert.deepEqual(plain(there), plain(here));
    }
    const result = direct.transfer(cage, target);
    assert.deepEqual(await splitVertices(target, result.cornerUvs), direct.splitVertices(target, result.cornerUvs));
    assert.deepEqual(await cutBorders(cage, target, result), direct.cutBorders(cage, target, result));
    await init();
  });

  test('inspects as on this thread', async () => {
    const turned = { ...cage, indices: cage.indices.slice().reverse() };
    for (const [around, options] of [
      [cage, { parts: { keep: ['skin'] } }],
      [turned, { threshold: 0.7 }],
    ] as const) {
      const named = { ...target, names: ['skin'] };
      assert.deepEqual(await inspect(around, named, options), direct.inspect(around, named, options));
    }
    await assert.rejects(inspect(cage, target, { result: {} as never }), /^CagecastError: inspect: /);
  });

  test('carries out calls made at once in order', async () => {
    const order: number[] = [];
    const call = (i: number) => transfer(cage, target, { threshold: i / 4 }).then(() => order.push(i));
    await Promise.all([0, 1, 2, 3].map(call));
    assert.deepEqual(order, [0, 1, 2, 3]);
  });

  test('copies its arguments, or takes them over when told to', async () => {
    const own = structuredClone({ cage, target });
    await transfer(own.cage, own.target);
    assert.deepEqual(own, { cage, target });
    await transfer(own.cage, own.target, { move: true });
    assert.deepEqual([own.target.positions.length, own.cage.indices.length], [0, 0]);
    const { cornerUvs } = direct.transfer(cage, target);
    await splitVertices(structuredClone(target), cornerUvs, { move: true });
    assert.equal(cornerUvs.length, 0);
    // What was moved away cannot be sent again.
    await assert.rejects(transfer(own.cage, own.target, { move: true }), { name: 'CagecastError' });
  });

  test('calls that wait have the arguments as they were', async () => {
    const scratch = structuredClone(target);
    const sizes = [1, 0.5, 0.25];
    const scaled = (size: number) => target.positions.map((x) => size * x) as Float32Array;
    const calls = sizes.map((size) => {
      (scratch.positions as Float32Array).set(scaled(size));
      return transfer(cage, scratch);
    });
    const moved = structuredClone({ cage, target });
    calls.push(transfer(moved.cage, moved.target, { move: true }));
    assert.equal(moved.target.positions.length, 0, 'moved at once');
    const results = await Promise.all(calls);
    for (const [i, size] of [...sizes, 1].entries()) {
      const expected = direct.transfer(cage, { ...target, positions: scaled(size) });
      assert.deepEqual(results[i]!.distances, expected.distances, `call ${i}`);
    }
  });

  test('sends no more of a buffer than the arrays that are views of it', async () => {
    const { byteLength, length } = target.positions;
    const asset = new ArrayBuffer(byteLength + 4096);
    const positions = new Float32Array(asset, 1024, length);
    positions.set(target.positions);
    const { postMessage } = Worker.prototype;
    const sent: number[] = [];
    Worker.prototype.postMessage = function (this: Worker, message: { args?: Mesh[] }, ...rest) {
      if (message.args) sent.push(message.args[1]!.positions.buffer.byteLength);
      postMessage.call(this, message, ...rest);
    };
    try {
      // The first is sent at once, the second waits.
      const results = await Promise.all([0, 1].map(() => transfer(cage, { ...target, positions })));
      for (const result of results) assert.deepEqual(result.uvs, direct.transfer(cage, target).uvs);
    } finally {
      Worker.prototype.postMessage = postMessage;
    }
    assert.deepEqual(sent, [byteLength, byteLength]);
    assert.equal(asset.byteLength, byteLength + 4096, 'it is left as it was');
  });

  test('one signal cancels all calls that wait, without a worker for each, by one listener', async () => {
    const abort = new AbortController();
    const { signal } = abort;
    assert.ok((await transfer(cage, target, { signal })).zones.length > 0);
    await countingEnds(async (ended) => {
      const calls = Array.from({ length: 12 }, () => failure(transfer(large.cage, large.target, { signal })));
      assert.equal(getEventListeners(signal, 'abort').length, 1);
      abort.abort('enough');
      assert.deepEqual(await Promise.all(calls), Array(12).fill('enough'));
      await works();
      assert.equal(ended(), 1);
    });
    await assert.rejects(transfer(cage, target, { signal }), /enough/);
  });

  test('a running call is cancelled at once, a waiting one leaves the running one, and later ones continue', async () => {
    const result = direct.transfer(large.cage, large.target);
    for (const run of [
      (signal: AbortSignal) => transfer(large.cage, large.target, { signal }),
      (signal: AbortSignal) => cutBorders(large.cage, large.target, result, { signal }),
    ]) {
      const controller = new AbortController();
      const [first, second] = [failure(run(controller.signal)), works()];
      setImmediate(() => controller.abort(new Error('never mind'))); // however quick the machine, it is not done by then
      assert.equal(((await first) as Error).message, 'never mind');
      await second;
    }
    const controller = new AbortController();
    const [first, second] = [works(), failure(transfer(cage, target, { signal: controller.signal }))];
    controller.abort();
    assert.equal(((await second) as Error).name, 'AbortError');
    await first;
    const given = failure(transfer(large.cage, large.target));
    terminate();
    assert.equal(((await given) as CagecastError).code, 'aborted');
    await works();
  });

  test('many calls that cannot be sent are refused one after the other, and the next one works', async () => {
    const unsendable = { ...target, extra: () => 0 } as Mesh;
    const first = transfer(cage, target);
    const others = Array.from({ length: 6000 }, () => failure(transfer(cage, unsendable)));
    assert.ok((await first).zones.length > 0);
    for (const error of await Promise.all(others)) assert.equal((error as CagecastError).code, 'badArgument');
    await works();
  });

  test('errors keep their class, code, argument and message', async () => {
    const stray = { ...target, indices: new Uint32Array([0, 1, 99999]) };
    const { uvs: _, ...bare } = cage;
    const untyped = transfer as (...args: unknown[]) => Promise<unknown>;
    const reason = /^target\.indices\[2\] = 99999 is out of range/;
    const cases: [unknown[], object][] = [
      [[cage, stray], { code: 'indexOutOfRange', at: 2, argument: 'target', fn: 'transfer', reason }],
      [[bare, target], { argument: 'cage' }],
      [[cage, { ...target, extra: () => 0 }], { code: 'badArgument' }],
      [[cage, target, { threshold: 2 }], { code: 'badOption', argument: 'options' }],
      [
        [cage, target, { signal: {} }],
        { code: 'badOption', message: /^transfer: options\.signal is of type Object, not an/ },
      ],
      [
        [cage, target, { move: 'x' }],
        { code: 'badOption', message: /^transfer: options\.move is "x", not true or false/ },
      ],
      [
        [cage, target, { reuse: {} }],
        { code: 'badOption', message: /^transfer: options\.reuse is not for the worker/ },
      ],
    ];
    for (const [args, expected] of cases)
      await assert.rejects(untyped(...args), { name: 'CagecastError', ...expected });
    await works();
  });

  const mesh = `{ positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]), indices: new Uint32Array([0, 1, 2]), uvs: new Float32Array(6) }`;
  const answered = (script: string, ...flags: string[]) =>
    printed(`import { init, transfer } from 'cagecast/worker'; const mesh = ${mesh}; ${script}`, ...flags);

  test('an idle worker does not keep a process alive', () => {
    assert.equal(answered('await init(); console.log((await transfer(mesh, mesh)).zones.length);'), '3');
  });

  test('where there are no workers, as in edge functions, the error says what needs none', () => {
    const script = `process.getBuiltinModule = undefined;
      await transfer(mesh, mesh).catch(({ message }) => console.log(message));`;
    assert.match(
      answered(script),
      /^transfer: .* it has no workers,.* and cagecast\/cages with worker: false, need none\)$/,
    );
  });

  test('if no worker can be started, the error says so', () => {
    const script = `for (const call of [() => init(), () => transfer(mesh, mesh)])
      await call().catch(({ code, message }) => console.log(code, message));`;
    const forbidden = ['--experimental-permission', '--no-warnings', '--allow-fs-read=*'];
    const cannot = (fn: string) => `unsupported ${fn}: this host cannot start the worker \\(.+\\)`;
    assert.match(answered(script, ...forbidden), new RegExp(`^${cannot('init')}\\n${cannot('transfer')}$`));
  });
});
