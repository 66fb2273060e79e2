// How calls of cagecast/cages share workers: with workers that answer when they are told to.
import assert from 'node:assert/strict';
import { beforeEach, test } from 'node:test';
import { matchingParts, terminate } from 'cagecast/cages';

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
const asked = () => workers.map(({ asked }) => asked.map(({ args }) => (args[1] as string[])[0]).join(''));
const ended = () => workers.map(({ isEnded }) => isEnded);

/** Calls that note when they end, and how. */
function calls(...names: string[]) {
  const log: string[] = [];
  const controllers = names.map(() => new AbortController());
  names.forEach((name, i) => {
    const { signal } = controllers[i]!;
    matchingParts([], [name], { signal }).then(
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
