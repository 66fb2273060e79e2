// How calls of cagecast/cages share workers: with workers that answer when they are told to.
import assert from 'node:assert/strict';
import { beforeEach, test } from 'node:test';
import { excludedByName, init, terminate } from 'cagecast/cages';

/** A worker that does nothing by itself. */
class IdleWorker {
  onmessage: (event: { data: object }) => void = () => undefined;
  readonly asked: { id: number; args: unknown[] }[] = [];
  isEnded = false;
  constructor() {
    workers.push(this);
  }
  postMessage(request: { id: number; args: unknown[] }): void {
    this.asked.push(request);
  }
  terminate(): void {
    this.isEnded = true;
  }
  /** Answers its last request. */
  async answer(result: unknown = []): Promise<void> {
    this.onmessage({ data: { id: this.asked.at(-1)!.id, result } });
    await settled();
  }
}

let workers: IdleWorker[] = [];
const settled = () => new Promise((done) => setImmediate(done));
/** What each worker was asked, by the only argument. */
const asked = () => workers.map(({ asked }) => asked.map(({ args }) => (args[0] as string[])[0]).join(''));
const ended = () => workers.map(({ isEnded }) => isEnded);

/** Calls that note when they end, and how. */
function calls(...names: string[]) {
  const log: string[] = [];
  const controllers = names.map(() => new AbortController());
  names.forEach((name, i) => {
    const { signal } = controllers[i]!;
    excludedByName([name], { signal }).then(
      () => log.push(name),
      (error: unknown) => log.push(`${name}: ${error instanceof Error ? (error as { code?: string }).code : error}`),
    );
  });
  return { log, abort: (i: number) => controllers[i]!.abort('enough') };
}

beforeEach(() => {
  terminate();
  workers = [];
  Object.assign(globalThis, { Worker: IdleWorker });
});

/** How many workers there are at most: as many as this machine has cores, within limits. */
const most = await (async () => {
  Object.assign(globalThis, { Worker: IdleWorker });
  const { log } = calls(...'abcdefgh');
  const count = workers.length;
  terminate();
  await settled();
  assert.equal(log.length, 8);
  return count;
})();

test('two to four workers start, each when those before it are busy', async () => {
  assert.ok(most >= 2 && most <= 4, String(most));
  calls('a');
  assert.deepEqual(asked(), ['a']);
  calls('b');
  assert.deepEqual(asked(), ['a', 'b']);
});

test('a call that ends leaves its worker to the next; all but one idle worker end', async () => {
  const names = [...'abcdefgh'].slice(0, most + 1);
  const { log } = calls(...names);
  assert.deepEqual(asked(), names.slice(0, most));
  await workers[1]!.answer();
  assert.deepEqual(log, ['b']);
  assert.deepEqual(asked()[1], `b${names[most]}`);
  for (const worker of workers) await worker.answer();
  assert.equal(log.length, most + 1);
  assert.equal(ended().filter((is) => is).length, most - 1);
  calls('x');
  assert.equal(workers.length, most, 'the idle one takes it');
});

test('to cancel a running call ends its worker only; a waiting one takes its place', async () => {
  const names = [...'abcdefgh'].slice(0, most + 2);
  const { log, abort } = calls(...names);
  abort(most);
  abort(0);
  await settled();
  assert.deepEqual(log, [`${names[most]}: enough`, 'a: enough']);
  assert.deepEqual(ended().slice(0, most), [true, ...Array(most - 1).fill(false)]);
  assert.deepEqual(asked(), [...names.slice(0, most), names[most + 1]]);
});

test('terminate ends all workers and calls', async () => {
  const { log } = calls(...'abcdefgh');
  terminate();
  await settled();
  assert.deepEqual(
    log,
    [...'abcdefgh'].map((name) => `${name}: aborted`),
  );
  assert.ok(ended().every((is) => is));
});

test('init starts as many workers as it is told, which all stay; other numbers are errors', async () => {
  for (const wrong of [0, 65, 1.5, '2', null])
    await assert.rejects(
      init({ workers: wrong as number }),
      /^CagecastError: init: options.workers is .*, not 1 to 64$/,
    );
  await assert.rejects(init(4 as never), /options is 4, not an object/);
  await assert.rejects(
    init({ wokers: 4 } as never),
    /options.wokers is not an option; init takes: workers, worker, mod/,
  );
  await assert.rejects(init({ worker: 4 } as never), /options.worker is 4, not true or false/);
  const started = init({ workers: most + 3 });
  assert.equal(workers.length, most + 3);
  for (const worker of workers) await worker.answer();
  await started;
  assert.ok(ended().every((is) => !is));
  const names = [...'abcdefghij'].slice(0, most + 3);
  calls(...names);
  const last = workers.map(({ asked }) => (asked.at(-1)!.args[0] as string[])[0]);
  assert.deepEqual(last, names);
  for (const worker of workers) await worker.answer();
  const one = init({ workers: 1 });
  await workers.find(({ asked }) => asked.length === 3)!.answer();
  await one;
  assert.equal(ended().filter((is) => !is).length, 1);
});
