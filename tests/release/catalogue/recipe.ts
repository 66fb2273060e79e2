// The recipe with a Redis, folders, a server of objects and workers of its own, for the tests of one file.
import { type ChildProcess, execFile, spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { setTimeout } from 'node:timers/promises';
import { promisify } from 'node:util';
import { type OwnRedis, startRedis } from '../../../examples/catalogue/redis.ts';
import { ball } from '../../package/scenes.js';
import { glbOf } from '../../support/glb.js';

export const home = resolve('examples/catalogue');
export const folder = mkdtempSync(join(tmpdir(), 'cagecast-catalogue-'));
export const [inputs, outputs] = [join(folder, 'inputs'), join(folder, 'outputs')];

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
export let parts: Awaited<ReturnType<typeof loadRecipe>>;
export let catalogue: ReturnType<typeof parts.openCatalogue>;
export let redis: OwnRedis;

/** Writes a manifest. @returns its path */
export function manifestOf(...lines: (object | string)[]): string {
  const path = join(folder, 'manifest.jsonl');
  writeFileSync(path, lines.map((line) => `${typeof line === 'string' ? line : JSON.stringify(line)}\n`).join(''));
  return path;
}

/** Submits lines of a manifest. @returns what the command says. */
export async function submit(...lines: (object | string)[]): Promise<string[]> {
  const summary = await parts.submit(manifestOf(...lines), catalogue);
  return [parts.describe(summary), ...summary.errors];
}

/** Starts a program of the recipe. @returns what it has printed until now, and its exit code when it has ended. */
export function start(
  program: string,
  args: string[],
  env: Record<string, string> = {},
): { child: ChildProcess; text: () => string; ended: Promise<number> } {
  const options = { cwd: home, env: { ...process.env, ...env } };
  const child = spawn(process.execPath, ['--import', 'tsx', join(home, program), ...args], options);
  let text = '';
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (chunk) => (text += chunk));
  return { child, text: () => text, ended: once(child, 'close').then(([code]) => code) };
}

/** Runs a program of the recipe. @returns its exit code, and the lines that it printed. */
export async function run(program: string, ...args: string[]): Promise<[code: number, ...lines: string[]]> {
  const { text, ended } = start(program, args);
  const code = await ended;
  return [code, ...text().trim().split('\n').sort()];
}

/** Waits for something, two minutes at most. */
export async function until(what: () => boolean | Promise<boolean>): Promise<void> {
  for (const end = Date.now() + 120_000; !(await what()); await setTimeout(50))
    if (Date.now() > end) throw new Error(`in vain: ${what}`);
}

/** Workers that are started again when they die, as Kubernetes does. What they say is kept. */
export const workers = new Set<ChildProcess>();
export let said = '';
let isEnding = false;
export function startWorker(): void {
  const args = ['--import', 'tsx', join(home, 'worker.ts')];
  const worker = spawn(process.execPath, args, { cwd: home, stdio: ['ignore', 'ignore', 'pipe'] });
  worker.stderr.on('data', (chunk) => (said += chunk));
  workers.add(worker);
  worker.once('exit', () => {
    workers.delete(worker);
    if (!isEnding) startWorker();
  });
}

/** Ends all workers at once. Those that are started next are started again when they die. */
export async function stopWorkers(): Promise<void> {
  isEnding = true;
  const all = [...workers];
  const ended = all.map((worker) => once(worker, 'exit'));
  for (const worker of all) worker.kill('SIGKILL');
  await Promise.all(ended);
  isEnding = false;
}

export interface Line {
  key: string;
  kind: string;
  status: string;
  reason?: string;
  error?: string;
  output?: string;
  outputBytes?: number;
  outputSha256?: string;
  verdict?: string;
  inputs: Record<string, string>;
}

/** Waits until nothing is left to do, and reads the results. */
export async function results(): Promise<Line[]> {
  await parts.untilDone(catalogue);
  await parts.report(catalogue, { worst: 1 });
  const lines = readFileSync(join(outputs, 'results.jsonl'), 'utf8').trim().split('\n');
  return lines.map((line) => JSON.parse(line));
}

/** A server of objects: signed addresses, an upload, and some that are wrong. */
let store: Server;
export let origin = '';
export const objects = new Map<string, Buffer>();
export const asked: string[] = [];
async function startStore(): Promise<void> {
  store = createServer(async (request, response) => {
    const { pathname, searchParams } = new URL(request.url!, origin);
    asked.push(`${request.method} ${pathname}`);
    const isFirst = asked.indexOf(asked.at(-1)!) === asked.length - 1;
    if (pathname === '/busy.glb' && isFirst) response.writeHead(503).end();
    else if (pathname === '/to-other.glb') response.writeHead(302, { location: 'http://169.254.169.254/key' }).end();
    else if (pathname === '/around.glb') response.writeHead(302, { location: '/around.glb?signature=s' }).end();
    else if (pathname === '/nowhere.glb') response.writeHead(302, { location: 'http://[no?signature=s3cr3t' }).end();
    else if (pathname === '/cut.glb') response.socket!.destroy();
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

/** Starts all of it. */
export async function open(count: number, env: Record<string, string> = {}): Promise<void> {
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
    ...env,
  });
  for (let i = 0; i < count; ++i) startWorker();
  parts = await loadRecipe();
  catalogue = parts.openCatalogue();
}

/** Ends all of it. */
export async function close(): Promise<void> {
  await stopWorkers();
  store?.close();
  store?.closeAllConnections();
  await Promise.race([catalogue?.close(), setTimeout(5000)]); // a Redis that a test left busy does not answer
  await redis?.stop('SIGKILL');
  rmSync(folder, { recursive: true, force: true });
}

/** Kills Redis, and starts it again after a while. */
export async function restartRedis(ms: number): Promise<void> {
  await redis.stop('SIGKILL');
  await setTimeout(ms);
  redis = await startRedis(join(folder, 'redis'), Number(new URL(redis.url).port));
}

/** Asks Redis on a connection of its own. */
export async function ask(...command: string[]): Promise<string> {
  const { stdout } = await promisify(execFile)('redis-cli', ['-p', new URL(redis.url).port, ...command]);
  return stdout.trim();
}

export const filesOf = (place: string): string[] =>
  readdirSync(place, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => join(entry.parentPath, entry.name));
