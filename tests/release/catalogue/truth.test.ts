import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { readFileSync, rmSync, statSync, symlinkSync, truncateSync, utimesSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import * as recipe from './recipe.ts';
import { ask, filesOf, inputs, manifestOf, objects, outputs, results, run, start, submit, until } from './recipe.ts';

before(() => recipe.open(2));
after(() => recipe.close());

const targets = (count: number) => Array.from({ length: count }, (_, i) => `${i}.glb`);
const slow = (ms: number, count = 20) => ({ kind: 'slow', target: targets(count), settings: { ms } });
const again = (count: number) => `${count} done again, as their outputs are gone or were changed`;

describe('the catalogue tells what is there', () => {
  test('counts every job that failed', async () => {
    const changed = {
      kind: 'slow',
      target: targets(20).map((place, i) => ({ place, sha256: String(i + 10).repeat(32) })),
      settings: { ms: 1 },
    };
    const said = ['0 done, 20 failed', '20 new jobs, 0 known'];
    assert.deepEqual(await run('submit.ts', manifestOf(changed), '--wait'), [1, ...said]);
    assert.equal((await run('dead.ts')).length, 1 + 20);
    const report = ['wrote report.html and results.jsonl: 0 done, 20 failed'];
    assert.deepEqual(await run('report.ts'), [0, ...report]);
  });

  test('writes to each place that is asked for, and to none for two jobs', async () => {
    const bytes = readFileSync(join(inputs, '1.glb'));
    const to = (name: string, signature = 's') => ({
      kind: 'slow',
      target: '1.glb',
      settings: { ms: 1 },
      output: `${recipe.origin}/${name}?signature=${signature}`,
    });
    assert.deepEqual(await submit(to('a.txt'), to('b.txt')), ['2 new jobs, 0 known']);
    const lines = (await results()).filter(({ output }) => output?.startsWith('http'));
    assert.deepEqual(lines.map(({ output }) => output).sort(), [`${recipe.origin}/a.txt`, `${recipe.origin}/b.txt`]);
    assert.equal(objects.get('/a.txt')!.length, bytes.length);
    assert.equal(objects.get('/b.txt')!.length, bytes.length);
    // The same place, signed for another night.
    assert.deepEqual(await submit(to('a.txt', 'other')), ['0 new jobs, 1 known']);

    const [, first, second] = await submit({ ...to('c.txt'), target: ['1.glb', '2.glb'] }, to('d.txt'), {
      ...to('d.txt'),
      target: '2.glb',
    });
    assert.match(first!, /^line 1: stands for 2 jobs, but has one "output"/);
    assert.match(second!, /^line 3: its "output" is that of another job/);
  });

  test('does again what has lost its output, and nothing else', async () => {
    assert.deepEqual(await submit(slow(2, 12)), ['12 new jobs, 0 known']);
    const own = (await results()).filter(({ kind, output }) => kind === 'slow' && output?.startsWith('slow/'));
    const paths = own.map(({ output }) => join(outputs, output!));
    assert.equal(paths.length, 12);
    for (const { output, outputBytes, outputSha256 } of own) {
      const bytes = readFileSync(join(outputs, output!));
      assert.equal(outputBytes, bytes.length);
      assert.equal(outputSha256, createHash('sha256').update(bytes).digest('hex'));
    }
    const whole = paths.map((path) => readFileSync(path, 'utf8'));
    const damage = async () => {
      for (const path of paths.slice(0, 3)) rmSync(path);
      truncateSync(paths[3]!, 5);
      writeFileSync(paths[4]!, 'y'.repeat(whole[4]!.length));
      rmSync(paths[5]!);
      symlinkSync(join(recipe.folder, 'secret.glb'), paths[5]!);
      utimesSync(paths[6]!, 1, 1); // copied from a backup: the same bytes
      assert.equal((await results()).filter(({ reason }) => reason === 'lost').length, 6);
    };
    const mend = async () => {
      const said = await run('submit.ts', manifestOf(slow(2, 12)), '--wait');
      assert.deepEqual(said, [0, `0 new jobs, 6 known, ${again(6)}`, '12 done, 0 failed']);
      assert.deepEqual(
        paths.map((path) => readFileSync(path, 'utf8')),
        whole,
      );
    };
    await damage();
    await mend();
    // The same when Redis has forgotten the jobs.
    await recipe.parts.report(recipe.catalogue, { worst: 0, forget: true });
    await damage();
    await mend();
    assert.equal(statSync(paths[6]!).mtimeMs, 1000);
  });

  test('fails no job because of Redis, and tells what it waits for', async () => {
    const began = recipe.said.length;
    const nobody = ['127.0.0.1', '1'];
    const troubles: [begin: () => Promise<unknown>, end: () => Promise<unknown>, says: RegExp][] = [
      [
        () => ask('CONFIG', 'SET', 'maxmemory', '100000'),
        () => ask('CONFIG', 'SET', 'maxmemory', '0'),
        /Redis is full: raise its maxmemory/,
      ],
      [() => ask('REPLICAOF', ...nobody), () => ask('REPLICAOF', 'NO', 'ONE'), /Redis is a replica, which takes no/],
      [
        async () => {
          await ask('CONFIG', 'SET', 'replica-serve-stale-data', 'no');
          await ask('REPLICAOF', ...nobody);
        },
        () => ask('REPLICAOF', 'NO', 'ONE'),
        /Redis is a replica whose master does not answer/,
      ],
      [
        async () => {
          await ask('CONFIG', 'SET', 'busy-reply-threshold', '10');
          void ask('EVAL', 'while true do end', '0').catch(() => {});
        },
        () => ask('SCRIPT', 'KILL'),
        /Redis is busy with a script: SCRIPT KILL ends it/,
      ],
      [() => recipe.redis.stop('SIGKILL'), () => recipe.restartRedis(0), /Redis does not answer: start it, or set/],
    ];
    assert.deepEqual(await submit(slow(150)), ['20 new jobs, 0 known']);
    for (const [i, [begin, end, says]] of troubles.entries()) {
      await begin();
      const { text, ended } = start('submit.ts', [manifestOf(slow(151 + i, 4)), '--wait']);
      await until(() => says.test(text()) && says.test(recipe.said.slice(began)));
      await setTimeout(2000); // longer than the lock of a job
      await end();
      assert.equal(await ended, 0, text());
      assert.match(text(), /^4 done, 0 failed$/m);
    }
    const jobs = (await results()).filter(({ kind, reason }) => kind === 'slow' && reason !== 'missing');
    assert.deepEqual(
      jobs.filter(({ status }) => status === 'failed'),
      [],
    );
    for (const job of await recipe.catalogue.queue.getJobs(['completed']))
      assert.equal(job.attemptsMade, 1, `${job.id} ${job.failedReason}`);
    assert.doesNotMatch(recipe.said, /OOM|ECONN|READONLY|MASTERDOWN|BUSY|command not allowed|^ +at /m);
  });

  test('does not tell a job as done that Redis has lost', async () => {
    await recipe.stopWorkers();
    const waits = run('submit.ts', manifestOf(slow(3, 2)), '--wait');
    const { queue } = recipe.catalogue;
    for (const end = Date.now() + 60_000; (await queue.getWaitingCount()) < 2 && Date.now() < end; )
      await setTimeout(50);
    await queue.drain();
    const rest = '0 done, 0 failed, 2 neither: their outputs or Redis have lost them; submit again';
    assert.deepEqual(await waits, [1, rest, '2 new jobs, 0 known']);
    assert.ok(filesOf(outputs).every((path) => !path.includes('.unfinished')));
  });
});
