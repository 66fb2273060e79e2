import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { existsSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { validate } from '../../support/gltf.js';
import * as recipe from './recipe.ts';
import { filesOf, folder, inputs, objects, outputs, results, run, submit, workers } from './recipe.ts';

before(() => recipe.open(3));
after(() => recipe.close());

const targets = Array.from({ length: 20 }, (_, i) => `${i}.glb`);
const manifest = [
  { kind: 'transfer', target: targets, cage: 'cage.glb' },
  { kind: 'slow', target: targets, settings: { ms: 150 } },
];

describe('the catalogue', () => {
  test('gives each result once, although a worker is killed and Redis is restarted', async () => {
    assert.deepEqual(await submit(...manifest), ['40 new jobs, 0 known']);
    const written = () => (existsSync(join(outputs, 'slow')) ? filesOf(join(outputs, 'slow')).length : 0);
    for (const end = Date.now() + 120_000; written() < 4 && Date.now() < end; ) await setTimeout(20);
    assert.ok(written() >= 4);
    [...workers][0]!.kill('SIGKILL');
    await recipe.restartRedis(500);

    const lines = await results();
    assert.equal(lines.length, 40);
    assert.equal(new Set(lines.map(({ key }) => key)).size, 40);
    for (const { status, output, kind, verdict, error } of lines) {
      assert.equal(status, 'done', error);
      if (kind === 'transfer') assert.equal(verdict, 'good');
      const bytes = readFileSync(join(outputs, output!));
      if (kind === 'slow') assert.match(bytes.toString(), /^x+$/);
      else assert.deepEqual(await validate(join(outputs, output!)), []);
    }
    assert.equal(filesOf(join(outputs, 'slow')).length + filesOf(join(outputs, 'transfer')).length, 40);
  });

  test('does no work when the same is submitted again, by other names too', async () => {
    const times = () => filesOf(join(outputs, 'transfer')).map((path) => statSync(path).mtimeMs);
    const before = times();
    writeFileSync(join(inputs, 'copy.glb'), readFileSync(join(inputs, '3.glb')));
    const copy = { kind: 'transfer', target: 'copy.glb', cage: 'cage.glb', settings: {} };
    assert.deepEqual(await submit(...manifest, copy), ['0 new jobs, 41 known']);
    assert.equal((await results()).length, 40);
    assert.deepEqual(times(), before);
  });

  test('keeps bad jobs with their reasons in the dead-letter list, and does all others', async () => {
    const at = (path: string) => `${recipe.origin}${path}`;
    const bytes = readFileSync(join(inputs, '7.glb'));
    objects.set('/busy.glb', bytes).set('/good.glb', bytes);
    const known = (path: string) => ({ place: at(path), sha256: createHash('sha256').update(bytes).digest('hex') });
    const said = await submit(
      { kind: 'inspect', target: 'broken.glb', cage: 'cage.glb' },
      { kind: 'inspect', target: '1.glb', cage: 'small-cage.glb' },
      { kind: 'inspect', target: '1.glb', cage: 'cage.glb', settings: { threshold: 7 } },
      { kind: 'slow', target: { place: 'large.glb', sha256: '0'.repeat(64) }, settings: { ms: 1 } },
      { kind: 'slow', target: { place: '1.glb', sha256: '7'.repeat(64) }, settings: { ms: 1 } },
      { kind: 'slow', target: { place: '../secret.glb', sha256: '1'.repeat(64) }, settings: { ms: 1 } },
      { kind: 'slow', target: { place: 'http://127.0.0.1:1/key', sha256: '2'.repeat(64) }, settings: { ms: 1 } },
      { kind: 'slow', target: { place: at('/to-other.glb'), sha256: '3'.repeat(64) }, settings: { ms: 1 } },
      { kind: 'slow', target: { place: at('/around.glb'), sha256: '4'.repeat(64) }, settings: { ms: 1 } },
      { kind: 'slow', target: { place: at('/endless.glb'), sha256: '5'.repeat(64) }, settings: { ms: 1 } },
      { kind: 'slow', target: { place: at('/good.glb?signature=s'), sha256: '6'.repeat(64) }, settings: { ms: 1 } },
      { kind: 'hang', target: '1.glb' },
      { kind: 'hog', target: '1.glb' },
      { kind: 'die', target: '1.glb' },
      { kind: 'kill', target: '1.glb' },
      // Good ones among them.
      { kind: 'slow', target: known('/busy.glb?signature=s'), settings: { ms: 2 } },
      {
        kind: 'transfer',
        target: known('/good.glb?signature=s'),
        cage: 'cage.glb',
        output: at('/out.glb?signature=s'),
        settings: { threshold: 0.4 },
      },
      // Lines that are no jobs.
      { kind: 'paint', target: '1.glb' },
      { kind: 'inspect', target: '../secret.glb', cage: 'cage.glb' },
      { kind: 'inspect', target: '1.glb', cage: 'cage.glb', colour: 'red' },
    );
    assert.deepEqual(said, [
      '17 new jobs, 0 known, 3 that cannot be used',
      'line 18: "kind" is "paint"; there are: inspect, transfer, slow, tell, hang, hog, die, kill',
      'line 19: refused: ../secret.glb is outside the input folder',
      'line 20: "colour" is unknown; inputs: target, cage',
    ]);
    const lines = await results();
    const dead = lines.filter(({ status }) => status === 'failed');
    const reasons = dead.map(
      ({ key, reason, inputs }) => `${key.split('-')[0]} ${inputs['target']!.replace(recipe.origin, '')} ${reason}`,
    );
    assert.deepEqual(reasons.sort(), [
      'die 1.glb crash',
      'hang 1.glb limit',
      'hog 1.glb limit',
      'inspect 1.glb broken',
      'inspect broken.glb broken',
      'kill 1.glb crash',
      'slow ../secret.glb refused',
      'slow /around.glb limit',
      'slow /endless.glb limit',
      'slow /good.glb missing',
      'slow /to-other.glb refused',
      'slow 1.glb missing',
      'slow http://127.0.0.1:1/key refused',
      'slow large.glb limit',
    ]);
    assert.match(dead.find(({ key }) => key.startsWith('kill'))!.error!, /a worker died on it 3 times/);
    assert.equal(lines.length, 57);
    assert.equal(lines.filter(({ status }) => status === 'done').length, 43);
    const unfit = lines.filter(({ verdict }) => verdict === 'unfit');
    assert.deepEqual(
      unfit.map(({ kind, status, why, output }) => [kind, status, /pokes out/.test(String(why)), output]),
      [['inspect', 'done', true, undefined]],
    );
    assert.equal(recipe.asked.filter((one) => one === 'GET /busy.glb').length, 2);
    assert.equal(lines.find(({ output }) => output?.startsWith(recipe.origin))!.output, `${recipe.origin}/out.glb`);
    writeFileSync(join(folder, 'out.glb'), objects.get('/out.glb')!);
    assert.deepEqual(await validate(join(folder, 'out.glb')), []);
  });

  test('tells its state as a page, as metrics and as a report with pictures, without the signatures of addresses', async () => {
    const { address, close } = await recipe.parts.serveStatus(recipe.catalogue);
    try {
      const page = (name: string) => `${address}/${name}`;
      const get = async (address: string) => (await fetch(address)).text();
      const state = JSON.parse(await get(page('queue.json')));
      const counts = await recipe.catalogue.queue.getJobCounts();
      assert.deepEqual([state.counts, state.failed.length, state.done.length], [counts, 14, 43]);
      for (const jobs of [await get(page('queue')), JSON.stringify(state)]) {
        assert.match(jobs, /good\.glb/);
        assert.match(jobs, /a worker died on it 3 times/);
        assert.doesNotMatch(jobs, /signature/);
      }
      await submit({ kind: 'slow', target: '1.glb', settings: { ms: 3 } });
      const metrics = () => get(page('metrics'));
      let text = '';
      for (const end = Date.now() + 60_000; !/jobs_done_total.*1$/m.test(text) && Date.now() < end; )
        text = await metrics();
      assert.match(text, /^catalogue_jobs\{state="failed"\} 14$/m);
      assert.match(text, /^catalogue_jobs_done_total\{verdict="none"\} 1$/m);
      assert.match(text, /^catalogue_job_duration_seconds_count 1$/m);
      const report = await get(page('files/report.html'));
      assert.match(report, /57 jobs: 43 done \(21 fit, 1 unfit\), 14 failed/);
      assert.match(report, /unfit: 1\.glb in small-cage\.glb/);
      assert.equal(report.match(/<img /g)!.length, 4);
    } finally {
      await close();
    }
  });

  test('forgets jobs in Redis, but not that they were done', async () => {
    await results();
    await recipe.parts.report(recipe.catalogue, { worst: 0, forget: true });
    assert.deepEqual(await recipe.catalogue.queue.getJobCounts('completed', 'failed'), { completed: 0, failed: 14 });
    assert.deepEqual(await submit(...manifest), ['0 new jobs, 40 known']);
    assert.equal((await results()).length, 58);
  });

  test('tells a nightly run by its exit code that jobs failed, or that a file or a word is wrong', async () => {
    const file = (name: string, ...lines: object[]) => {
      writeFileSync(join(folder, name), lines.map((line) => `${JSON.stringify(line)}\n`).join(''));
      return join(folder, name);
    };
    const good = { kind: 'slow', target: '1.glb', settings: { ms: 4 } };
    const bad = { kind: 'inspect', target: 'broken.glb', cage: 'cage.glb', settings: { threshold: 0.41 } };
    assert.deepEqual(await run('submit.ts', file('good.jsonl', good), '--wait'), [
      0,
      '1 done, 0 failed',
      '1 new jobs, 0 known',
    ]);
    assert.deepEqual(await run('submit.ts', file('bad.jsonl', good, bad), '--wait'), [
      1,
      '1 done, 1 failed',
      '1 new jobs, 1 known',
    ]);
    assert.deepEqual(await run('submit.ts', file('empty.jsonl', { ...bad, target: [] }), '--wait'), [
      1,
      '0 done, 0 failed',
      '0 new jobs, 0 known, 1 that cannot be used',
      'line 1: "target" is an empty list',
    ]);

    const missing = join(folder, 'yesterdy.jsonl');
    assert.deepEqual(await run('submit.ts', missing), [2, `missing: ${missing} is not there`]);
    assert.deepEqual(await run('report.ts', '--before', missing), [2, `missing: ${missing} is not there`]);
    const cutOff = join(folder, 'cut-off.jsonl');
    writeFileSync(cutOff, readFileSync(join(outputs, 'results.jsonl')).subarray(0, -50));
    assert.deepEqual(await run('report.ts', '--before', cutOff), [
      2,
      `broken: ${cutOff}, line 58, is not a result; was the file cut off?`,
    ]);
    assert.deepEqual(await run('dead.ts', '--reason', 'brokn', '--retry'), [
      2,
      'broken: --reason is "brokn"; there are: broken, limit, missing, lost, refused, network, crash, unexpected',
    ]);
    assert.equal((await run('dead.ts', '--reason', 'broken')).length, 4);
  });
});
