// Files of other formats that strangers may send: each is refused with one clear line, or read, at a cost in proportion to its size.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { describe, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { CagecastError } from 'cagecast';
import { type Companions, toGlb } from 'cagecast/gltf';
import { run } from '../../support/command.js';
import { countingEnds } from '../../support/ended-workers.js';
import { costlyFormats, inheritedNames, kInherited } from '../../support/files/costly-formats.js';
import { validate } from '../../support/gltf.js';
import { temporaryFolder } from '../../support/temporary.js';

const { folder, at } = temporaryFolder('hostile-formats');
process.chdir(folder);

await validate(Buffer.from('{}')); // it adds to what all objects have

/** What all objects of this thread have. */
const shared = () => [Object.prototype, Array.prototype, Function.prototype].map((one) => Reflect.ownKeys(one));
const untouched = shared();

const good = Buffer.from('v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n');
/** Takes a loader hours; the clock is what ends it. */
const endless = costlyFormats['a line that is matched over and over']!.bytes();

const kMaxSeconds = 4; // of CPU; all take less than 2
const kMaxMemory = 500e6; // bytes

/** Does something. @returns the CPU that it took, in seconds, and the memory that the process had more meanwhile. */
async function costOf(work: () => Promise<unknown>): Promise<{ seconds: number; memory: number }> {
  const before = process.memoryUsage.rss();
  let most = before;
  const watch = setInterval(() => (most = Math.max(most, process.memoryUsage.rss())), 20);
  const began = process.cpuUsage();
  await work().finally(() => clearInterval(watch));
  const { user, system } = process.cpuUsage(began);
  return { seconds: (user + system) / 1e6, memory: most - before };
}

describe('what costs much', () => {
  for (const [title, { name, bytes, beside, refusal }] of Object.entries(costlyFormats))
    test(`${title}, in ${name}`, async () => {
      const file = bytes();
      const { seconds, memory } = await costOf(async () => {
        const made = toGlb(file, { read: async (name) => beside?.(name) });
        if (refusal) await assert.rejects(made, { name: 'CagecastError', code: 'badArgument', message: refusal });
        else assert.deepEqual(await validate(await made), []);
      });
      assert.ok(seconds < kMaxSeconds, `${seconds} s`);
      assert.ok(memory < kMaxMemory, `${Math.round(memory / 1e6)} MB`);
      assert.deepEqual(shared(), untouched);
    });

  test('the command says the same, and a file that is sound is read beside it', async () => {
    writeFileSync('good.obj', good);
    for (const [i, title] of ['comments before nothing', 'elements without properties', 'a deflated layer'].entries()) {
      const { name, bytes, refusal } = costlyFormats[title]!;
      const path = `${i}-${name}`;
      writeFileSync(path, bytes());
      const { status, stderr } = await run(`thumbnail ${path} -o never.png`);
      assert.equal(status, 1);
      assert.match(stderr, refusal!);
      assert.equal((await run('thumbnail good.obj -o good.png')).status, 0);
    }
    const { name, bytes } = costlyFormats['a line that is matched over and over']!;
    writeFileSync(name, bytes());
    assert.match((await run(`thumbnail ${name} -o never.png --limit seconds=1`)).stderr, /limit "seconds" is 1\)/);
    assert.match(
      (await run(`thumbnail good.obj -o good.png --limit second=1`)).stderr,
      /There are the limits .*seconds/,
    );
    assert.ok(at('good.png'));
  });
});

describe('names that all objects have', () => {
  for (const [file, make] of Object.entries(inheritedNames))
    for (const name of kInherited)
      test(`${name} in ${file}`, async () => {
        const library = Buffer.from(`newmtl ${name}\nKd 1 0 0\nmap_Kd ${name}\n${name} 5\n`);
        const made = toGlb(make(name), { read: async () => library });
        const glb = await made.catch((error: unknown) => assert.ok(error instanceof CagecastError, String(error)));
        if (glb) assert.deepEqual(await validate(glb), []);
        // Of these, nothing is beyond its loader.
        assert.equal(glb !== undefined, !/fbx|root/.test(file), String(await made.catch((error) => error)));
        assert.deepEqual(shared(), untouched);
      });
});

describe('the thread of a file', () => {
  const refused = (code: string, message: RegExp) => ({ name: 'CagecastError', code, message });

  test('ends with it, whatever came of it, and whatever others do', async () => {
    await countingEnds(async (ended) => {
      const bad = costlyFormats['a layer that shows itself']!.bytes();
      const calls = [good, bad, good, endless, good].map((bytes) => toGlb(bytes, { limits: { seconds: 1 } }));
      const results = await Promise.allSettled(calls);
      assert.deepEqual(
        results.map(({ status }) => status),
        ['fulfilled', 'rejected', 'fulfilled', 'rejected', 'fulfilled'],
      );
      assert.equal(ended(), calls.length);
    });
  });

  test('has its seconds for itself, however many others run', { skip: process.platform !== 'linux' }, async () => {
    const seconds = 0.4;
    const count = 4 * availableParallelism();
    const began = process.cpuUsage();
    const calls = Array.from({ length: count }, () => toGlb(endless, { limits: { seconds } }));
    const all = Promise.allSettled(calls);
    await assert.rejects(Promise.race(calls), /takes more than 0\.4 seconds/);
    const { user, system } = process.cpuUsage(began);
    await all;
    // Were the time of all threads counted, the first would end when each processor has worked for so long.
    assert.ok((user + system) / 1e6 > (count * seconds) / 2, `${user + system} µs for ${count}`);
  });

  test('ends at once with a signal, while its loader runs or it waits for a file', async () => {
    const never: Companions = { read: () => new Promise(() => {}) };
    const cases: [Uint8Array, Companions][] = [
      [endless, { limits: { seconds: 1e6 } }],
      [Buffer.concat([Buffer.from('mtllib a\n'), good]), never],
    ];
    for (const [bytes, options] of cases)
      await countingEnds(async (ended) => {
        const abort = new AbortController();
        const made = toGlb(bytes, { ...options, signal: abort.signal });
        const reason = new Error('enough');
        const rejected = assert.rejects(made, (error) => error === reason);
        await sleep(500);
        abort.abort(reason);
        await rejected;
        assert.equal(ended(), 1);
        await sleep(100);
        const began = process.cpuUsage().user;
        await sleep(500);
        assert.ok(process.cpuUsage().user - began < 250_000, 'it goes on');
      });
    const gone = AbortSignal.abort(new Error('before'));
    await assert.rejects(toGlb(good, { signal: gone }), /before/);
  });

  test('has the limits that the caller sets', async () => {
    const named = (names: number) =>
      Buffer.concat([Buffer.from(Array.from({ length: names }, (_, i) => `mtllib ${i}\n`).join('')), good]);
    const read = async () => Buffer.alloc(1000, 10);
    const cases: [Uint8Array, Companions, RegExp][] = [
      [endless, { limits: { seconds: 0.5 } }, /takes more than 0\.5 seconds; the limit "seconds" is 0\.5/],
      [good, { limits: { memory: 1000 } }, /takes more than 1,000 bytes of memory; the limit "memory" is 1,000/],
      [good, { limits: { bytes: 10 } }, /has 32 bytes; the limit "bytes" is 10/],
      [named(5), { read, limits: { files: 4 } }, /names more than 4 files beside it; the limit "files" is 4/],
      [named(5), { read, limits: { bytes: 4500 } }, /files beside it have more than 4,500 bytes; the limit "bytes"/],
      [good, { limits: { parts: 0 } }, /^$/],
    ];
    for (const [bytes, options, message] of cases.slice(0, -1))
      await assert.rejects(toGlb(bytes, options), refused('badArgument', message));
    await toGlb(named(4), { read, limits: { files: 4, bytes: 4500 } });
    for (const limits of [{ seconds: -1 }, { memory: Number.NaN }, { files: '3' }, 5] as never[])
      await assert.rejects(toGlb(good, { limits }), refused('badOption', /^toGlb: limits/));
  });

  test('asks for a file once, and takes one that cannot be read for one that is not there', async () => {
    const asked: string[] = [];
    const missing: string[] = [];
    const obj = Buffer.from(`mtllib a.mtl\nmtllib ./a.mtl\nmtllib b\\..\\a.mtl\nmtllib c.mtl\nusemtl x\n${good}`);
    const mtl = Buffer.from('newmtl x\nmap_Kd a.png\nnewmtl y\nmap_Kd a.png\n');
    await toGlb(obj, {
      read: async (name) => {
        asked.push(name);
        if (name !== 'a.mtl') throw new Error('no');
        return mtl;
      },
      onMissing: (name) => missing.push(name),
    });
    assert.deepEqual(asked, ['a.mtl', 'c.mtl', 'a.png']);
    assert.deepEqual(missing, ['c.mtl', 'a.png']);
  });

  test('is missed where there can be none', async () => {
    const scope = globalThis as { Worker?: unknown };
    scope.Worker = class {
      constructor() {
        throw new Error('not here');
      }
    };
    try {
      const message = /^toGlb: this host cannot start the worker \(not here\); other formats are only read in one$/;
      await assert.rejects(toGlb(good), refused('unsupported', message));
    } finally {
      delete scope.Worker;
    }
  });
});
