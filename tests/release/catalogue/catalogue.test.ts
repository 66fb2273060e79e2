import assert from 'node:assert/strict';
import { type ChildProcess, spawn } from 'node:child_process';
import { createHash } from 'node:crypto';
import { once } from 'node:events';
import {
  existsSync,
  mkdirSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  rmSync,
  statSync,
  writeFileSync,
} from 'node:fs';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { type OwnRedis, startRedis } from '../../../examples/catalogue/redis.ts';
import { ball } from '../../package/scenes.js';
import { glbOf } from '../../support/glb.js';
import { validate } from '../../support/gltf.js';

const recipe = resolve('examples/catalogue');
const folder = mkdtempSync(join(tmpdir(), 'cagecast-catalogue-'));
const [inputs, outputs] = [join(folder, 'inputs'), join(folder, 'outputs')];
let redis: OwnRedis;

/** The parts of the recipe, which read the environment when they are loaded. */
async function loadRecipe() {
  const [jobs, submission, report, status] = await Promise.all([
    import('../../../examples/catalogue/jobs.ts'),
    import('../../../examples/catalogue/submit.ts'),
    import('../../../examples/catalogue/report.ts'),
    import('../../../examples/catalogue/status.ts'),
  ]);
  return { ...jobs, ...submission, ...report, ...status };
}
let parts: Awaited<ReturnType<typeof loadRecipe>>;
let catalogue: ReturnType<typeof parts.openCatalogue>;

/** Submits lines of a manifest. @returns what the command says. */
async function submit(...lines: object[]): Promise<string[]> {
  const path = join(folder, 'manifest.jsonl');
  writeFileSync(path, lines.map((line) => `${JSON.stringify(line)}\n`).join(''));
  const summary = await parts.submit(path, catalogue);
  return [parts.describe(summary), ...summary.errors];
}

/** Runs a program of the recipe. @returns its exit code, and the lines that it printed. */
async function run(program: string, ...args: string[]): Promise<[code: number, ...lines: string[]]> {
  const child = spawn(process.execPath, ['--import', 'tsx', program, ...args], { cwd: recipe });
  let text = '';
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (chunk) => (text += chunk));
  const [code] = await once(child, 'close');
  return [code, ...text.trim().split('\n').sort()];
}

/** Workers that are started again when they die, as Kubernetes does. */
const workers = new Set<ChildProcess>();
let isEnding = false;
function startWorker(): void {
  const args = ['--import', 'tsx', 'worker.ts'];
  const worker = spawn(process.execPath, args, { cwd: recipe, stdio: ['ignore', 'ignore', 'inherit'] });
  workers.add(worker);
  worker.once('exit', () => {
    workers.delete(worker);
    if (!isEnding) startWorker();
  });
}

interface Line {
  key: string;
  kind: string;
  status: string;
  reason?: string;
  error?: string;
  output?: string;
  verdict?: string;
  inputs: Record<string, string>;
}

/** Waits until nothing is left to do, and reads the results. */
async function results(): Promise<Line[]> {
  await parts.untilDone(catalogue);
  await parts.report(catalogue, { worst: 1 });
  const lines = readFileSync(join(outputs, 'results.jsonl'), 'utf8').trim().split('\n');
  return lines.map((line) => JSON.parse(line));
}

/** A server of objects: signed addresses, an upload, and some that are wrong. */
let store: Server;
let origin = '';
const objects = new Map<string, Buffer>();
const asked: string[] = [];
async function startStore(): Promise<void> {
  store = createServer(async (request, response) => {
    const { pathname, searchParams } = new URL(request.url!, origin);
    asked.push(`${request.method} ${pathname}`);
    const isFirst = asked.indexOf(asked.at(-1)!) === asked.length - 1;
    if (pathname === '/busy.glb' && isFirst) response.writeHead(503).end();
    else if (pathname === '/to-other.glb') response.writeHead(302, { location: 'http://169.254.169.254/key' }).end();
    else if (pathname === '/around.glb') response.writeHead(302, { location: '/around.glb?signature=s' }).end();
    else if (pathname === '/endless.glb') {
      for (; !response.destroyed; await setTimeout(10)) response.write(Buffer.alloc(1e6));
    } else if (searchParams.get('signature') !== 's') response.writeHead(403).end();
    else if (request.method === 'PUT') {
      const chunks: Buffer[] = [];
      for await (const chunk of request) chunks.push(chunk as Buffer);
      objects.set(pathname, Buffer.concat(chunks));
      response.end();
    } else response.end(objects.get(pathname));
  }).listen(0, '127.0.0.1');
  await new Promise((done) => store.once('listening', done));
  origin = `http://127.0.0.1:${(store.address() as AddressInfo).port}`;
}

before(async () => {
  mkdirSync(inputs);
  const sphere = (radius: number) => glbOf(ball([0, 0, 0], () => radius, 12, 16));
  writeFileSync(join(inputs, 'cage.glb'), sphere(1.1));
  writeFileSync(join(inputs, 'small-cage.glb'), sphere(0.4));
  writeFileSync(join(inputs, 'large.glb'), Buffer.alloc(3e6));
  writeFileSync(join(inputs, 'broken.glb'), sphere(1).subarray(0, 999));
  writeFileSync(join(folder, 'secret.glb'), 'not yours');
  for (let i = 0; i < 20; ++i) writeFileSync(join(inputs, `${i}.glb`), sphere(1 + i / 1000));
  await startStore();
  redis = await startRedis(join(folder, 'redis'));
  Object.assign(process.env, {
    REDIS_URL: redis.url,
    CATALOGUE_PREFIX: 'test',
    CATALOGUE_INPUTS: inputs,
    CATALOGUE_OUTPUTS: outputs,
    CATALOGUE_HOSTS: new URL(origin).host,
    CATALOGUE_KINDS: resolve('tests/release/catalogue/kinds.ts'),
    CATALOGUE_CONCURRENCY: '1',
    CATALOGUE_PORT: '0',
    CATALOGUE_LOCK: '1500',
    CATALOGUE_BACKOFF: '50',
    CATALOGUE_SECONDS: '60',
    CATALOGUE_MEMORY: '600',
    CATALOGUE_INPUT_SIZE: '2',
  });
  for (let i = 0; i < 3; ++i) startWorker();
  parts = await loadRecipe();
  catalogue = parts.openCatalogue();
});
after(async () => {
  isEnding = true;
  for (const worker of workers) worker.kill('SIGKILL');
  store?.close();
  store?.closeAllConnections();
  await catalogue?.close();
  await redis?.stop('SIGKILL');
  rmSync(folder, { recursive: true, force: true });
});

const targets = Array.from({ length: 20 }, (_, i) => `${i}.glb`);
const manifest = [
  { kind: 'transfer', target: targets, cage: 'cage.glb' },
  { kind: 'slow', target: targets, settings: { ms: 150 } },
];

const filesOf = (place: string): string[] =>
  readdirSync(place, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => join(entry.parentPath, entry.name));

describe('the catalogue', () => {
  test('gives each result once, although a worker is killed and Redis is restarted', async () => {
    assert.deepEqual(await submit(...manifest), ['40 new jobs, 0 known']);
    const written = () => (existsSync(join(outputs, 'slow')) ? filesOf(join(outputs, 'slow')).length : 0);
    for (const end = Date.now() + 120_000; written() < 4 && Date.now() < end; ) await setTimeout(20);
    assert.ok(written() >= 4);
    [...workers][0]!.kill('SIGKILL');
    await redis.stop('SIGKILL');
    await setTimeout(500);
    redis = await startRedis(join(folder, 'redis'), Number(new URL(redis.url).port));

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
    const at = (path: string) => `${origin}${path}`;
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
      '17 new jobs, 0 known, 3 lines that cannot be used',
      'line 18: "kind" is "paint"; there are: inspect, transfer, slow, hang, hog, die, kill',
      'line 19: refused: ../secret.glb is outside the input folder',
      'line 20: "colour" is unknown; inputs: target, cage',
    ]);
    const lines = await results();
    const dead = lines.filter(({ status }) => status === 'failed');
    const reasons = dead.map(
      ({ key, reason, inputs }) => `${key.split('-')[0]} ${inputs['target']!.replace(origin, '')} ${reason}`,
    );
    assert.deepEqual(reasons.sort(), [
      'die 1.glb crash',
      'hang 1.glb limit',
      'hog 1.glb limit',
      'inspect 1.glb broken',
      'inspect 1.glb unfit',
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
    assert.equal(lines.filter(({ status }) => status === 'done').length, 42);
    assert.equal(asked.filter((one) => one === 'GET /busy.glb').length, 2);
    assert.equal(lines.find(({ output }) => output?.startsWith(origin))!.output, `${origin}/out.glb`);
    writeFileSync(join(folder, 'out.glb'), objects.get('/out.glb')!);
    assert.deepEqual(await validate(join(folder, 'out.glb')), []);
  });

  test('tells its state as a page, as metrics and as a report with pictures, without the signatures of addresses', async () => {
    const { address, close } = await parts.serveStatus(catalogue);
    try {
      const page = (name: string) => `${address}/${name}`;
      const get = async (address: string) => (await fetch(address)).text();
      assert.match(await get(page('queue')), /<title>Bull/);
      const jobs = await get(`${page('queue')}/api/queues?activeQueue=jobs&status=completed&jobsPerPage=100`);
      assert.match(jobs, /good\.glb/);
      assert.doesNotMatch(jobs, /signature/);
      await submit({ kind: 'slow', target: '1.glb', settings: { ms: 3 } });
      const metrics = () => get(page('metrics'));
      let text = '';
      for (const end = Date.now() + 60_000; !/jobs_done_total.*1$/m.test(text) && Date.now() < end; )
        text = await metrics();
      assert.match(text, /^catalogue_jobs\{state="failed"\} 15$/m);
      assert.match(text, /^catalogue_jobs_done_total\{verdict="none"\} 1$/m);
      assert.match(text, /^catalogue_job_duration_seconds_count 1$/m);
      const report = await get(page('files/report.html'));
      assert.match(report, /unfit: 1\.glb in small-cage\.glb/);
      assert.equal(report.match(/<img /g)!.length, 4);
    } finally {
      await close();
    }
  });

  test('forgets jobs in Redis, but not that they were done', async () => {
    await results();
    await parts.report(catalogue, { worst: 0, forget: true });
    assert.deepEqual(await catalogue.queue.getJobCounts('completed', 'failed'), { completed: 0, failed: 15 });
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
      '0 new jobs, 0 known, 1 lines that cannot be used',
      'line 1: "target" is an empty list',
    ]);

    const missing = join(folder, 'yesterdy.jsonl');
    assert.deepEqual(await run('submit.ts', missing), [2, `missing: ${missing}: ENOENT`]);
    assert.deepEqual(await run('report.ts', '--before', missing), [2, `missing: ${missing}: ENOENT`]);
    const cutOff = join(folder, 'cut-off.jsonl');
    writeFileSync(cutOff, readFileSync(join(outputs, 'results.jsonl')).subarray(0, -50));
    assert.deepEqual(await run('report.ts', '--before', cutOff), [
      2,
      `broken: ${cutOff}, line 58, is not a result; was the file cut off?`,
    ]);
    assert.deepEqual(await run('dead.ts', '--reason', 'brokn', '--retry'), [
      2,
      '--reason is "brokn"; there are: broken, unfit, limit, missing, refused, network, crash, unexpected',
    ]);
    assert.equal((await run('dead.ts', '--reason', 'broken')).length, 4);
  });
});
