// One night in which all goes wrong: afterwards the programs have to tell the truth.
import { createHash } from 'node:crypto';
import { readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { setTimeout } from 'node:timers/promises';
import { freePort, startRedis } from '../redis.ts';
import { end, manifestOf, type Program, type Stage, start, transfers } from './stage.ts';

export interface Night {
  /** Transfers that can be done. */
  jobs: number;
  /** How long Redis is full, and a worker is frozen: longer than a lock. */
  fullMs: number;
  frozenMs: number;
}

/** What was told, and what is there; the README has a table. */
export type Figures = Record<string, number | string>;

/** Jobs that must fail, each with its reason: as lines of a manifest, and as what others put into Redis. */
function badJobs(inputs: string): { lines: object[]; strangers: [id: string, data: unknown][] } {
  writeFileSync(join(inputs, 'broken.glb'), readFileSync(join(inputs, 'cage-0.glb')).subarray(0, 500));
  const lines = Array.from({ length: 10 }, (_, i) => {
    const sha256 = String(i).repeat(64);
    const bad = (target: unknown, settings = {}) => ({ kind: 'inspect', target, cage: 'cage-0.glb', settings });
    return [
      bad('broken.glb', { threshold: i / 100 }),
      bad('cage-0.glb', { threshold: 2 + i }),
      bad({ place: 'cage-0.glb', sha256 }),
      bad({ place: '../secret.glb', sha256: sha256.replace(/^./, 'a') }),
    ];
  }).flat();
  const strangers = Array.from({ length: 10 }, (_, i): [string, unknown] =>
    i % 2 === 0 ? [`../../escaped-${i}`, {}] : [`transfer-${String(i).repeat(32)}`, { output: '../escaped.glb' }],
  );
  return { lines, strangers };
}

/** Three workers, the status page, and what happens to them and to Redis. */
class Misfortune {
  readonly #stage: Stage;
  readonly #night: Night;
  readonly #finished: () => Promise<number>;
  readonly workers: Program[] = [1, 2, 3].map(() => start('worker'));
  foreign = 0;

  constructor(stage: Stage, night: Night, finished: () => Promise<number>) {
    this.#stage = stage;
    this.#night = night;
    this.#finished = finished;
  }

  async #until(share: number): Promise<void> {
    while ((await this.#finished()) < this.#night.jobs * share) await setTimeout(50);
  }

  /** @param ask  Asks Redis. @param page  The address of the status page. */
  async strike(ask: (...command: [string, ...string[]]) => Promise<unknown>, page: string): Promise<void> {
    await this.#until(0.1);
    await ask('CONFIG', 'SET', 'maxmemory', '1000000');
    await setTimeout(this.#night.fullMs);
    await ask('CONFIG', 'SET', 'maxmemory', '0');
    await this.#until(0.25);
    this.workers[0]!.process.kill('SIGKILL');
    await this.#until(0.35);
    this.workers[1]!.process.kill('SIGSTOP');
    const headers = { origin: 'http://evil.example', 'content-type': 'text/plain' };
    this.foreign = (await fetch(`${page}/queue`, { method: 'POST', headers, body: '{"name": "x"}' })).status;
    await setTimeout(this.#night.frozenMs);
    this.workers[1]!.process.kill('SIGCONT');
    await this.#until(0.6);
    await this.#stage.redis.stop('SIGKILL');
    const port = Number(new URL(this.#stage.redis.url).port);
    this.#stage.redis = await startRedis(join(this.#stage.folder, 'redis'), port);
  }
}

/** The last line that a program printed that counts, as numbers. */
const numbersIn = (text: string, pattern: RegExp): number[] => (pattern.exec(text) ?? []).slice(1).map(Number);

/** Runs the night. The environment leads the programs to the stage. */
export async function disaster(stage: Stage, night: Night): Promise<Figures> {
  const { openCatalogue } = await import('../jobs.ts');
  const catalogue = openCatalogue();
  const began = performance.now();
  const finished = async () => {
    const { completed = 0, failed = 0 } = await catalogue.queue.getJobCounts('completed', 'failed');
    return completed + failed;
  };
  const good = await transfers(stage, night.jobs, { threshold: 0.5 });
  const { lines, strangers } = badJobs(stage.inputs);
  const manifest = manifestOf(stage, [good, ...lines]);
  const port = String(await freePort());
  const page = start('status', [], { CATALOGUE_PORT: port });
  while (!page.text().includes('/queue')) await setTimeout(50);

  const misfortune = new Misfortune(stage, night, finished);
  const first = start('submit', [manifest, '--wait']);
  for (const [jobId, data] of strangers) await catalogue.queue.add('x', data as never, { jobId });
  await misfortune.strike((...command) => catalogue.redis.call(...command), `http://127.0.0.1:${port}`);
  await first.ended;
  const files = () => filesOf(join(stage.outputs, 'transfer'));
  files().forEach((path, i) => i % 10 === 0 && rmSync(path));
  const second = start('submit', [manifest, '--wait']);
  await second.ended;
  const report = start('report', ['--worst', '0']);
  await report.ended;
  const metrics = await (await fetch(`http://127.0.0.1:${port}/metrics`)).text();
  await end([...misfortune.workers, page]);
  await catalogue.close();
  return {
    seconds: Math.round((performance.now() - began) / 1000),
    ...told('first', first.text()),
    ...told('second', second.text()),
    doneAgain: numbersIn(second.text(), /(\d+) done again/)[0] ?? 0,
    metricsDone: numbersIn(metrics, /state="completed"\} (\d+)/)[0]!,
    metricsFailed: numbersIn(metrics, /state="failed"\} (\d+)/)[0]!,
    ...told('report', report.text()),
    ...whatIsThere(stage, files()),
    foreignPost: misfortune.foreign,
    waitedForRedis: misfortune.workers.filter(({ text }) => text().includes('Redis is full')).length,
  };
}

const told = (who: string, text: string): Figures => {
  const [done = -1, failed = -1] = numbersIn(text, /(\d+) done(?: \(.*\))?, (\d+) failed$/m);
  return { [`${who}Done`]: done, [`${who}Failed`]: failed };
};

const filesOf = (folder: string): string[] =>
  readdirSync(folder, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => join(entry.parentPath, entry.name));

/** The results and the folder, without asking the recipe. */
function whatIsThere({ folder, outputs }: Stage, files: string[]): Figures {
  const results = readFileSync(join(outputs, 'results.jsonl'), 'utf8').trim().split('\n');
  const lines = results.map((line) => JSON.parse(line));
  const done = lines.filter(({ status }) => status === 'done');
  const hashes = new Map(
    files.map((path) => [path, createHash('sha256').update(readFileSync(path)).digest('hex')] as const),
  );
  const reasons: Record<string, number> = {};
  for (const { reason } of lines) if (reason) reasons[reason] = (reasons[reason] ?? 0) + 1;
  return {
    results: lines.length,
    keys: new Set(lines.map(({ key }) => key)).size,
    files: files.length,
    filesAsTold: done.filter(({ output, outputSha256 }) => hashes.get(join(outputs, output)) === outputSha256).length,
    jobMs: Math.round(done.reduce((sum, { cpuMs }) => sum + cpuMs, 0) / done.length),
    unfinished: filesOf(join(outputs, '.unfinished')).length,
    reasons: JSON.stringify(reasons),
    escaped: filesOf(folder).filter((path) => path.includes('escaped')).length,
  };
}
