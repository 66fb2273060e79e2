// npm run bench [-- --jobs 2000] [-- --detail 12]: what the catalogue holds and what it costs, measured on this machine.
//   --jobs     transfers in the night in which all goes wrong (disaster.ts)
//   --detail   quads along and around each model: 12 make 264 triangles
import { mkdtempSync, readdirSync, readFileSync, rmSync, statSync } from 'node:fs';
import { loadavg, tmpdir } from 'node:os';
import { join } from 'node:path';
import { setTimeout } from 'node:timers/promises';
import { parseArgs } from 'node:util';
import { startRedis } from '../redis.ts';
import { disaster } from './disaster.ts';
import { end, manifestOf, type Stage, start, transfers } from './stage.ts';

const { values } = parseArgs({ options: { jobs: { type: 'string' }, detail: { type: 'string' } } });
const [most, detail] = [Number(values.jobs ?? 2000), Number(values.detail ?? 12)];
const folder = mkdtempSync(join(tmpdir(), 'catalogue-bench-'));
const redis = await startRedis(join(folder, 'redis'));
const stage: Stage = { folder, inputs: join(folder, 'inputs'), outputs: join(folder, 'outputs'), redis };
const lockMs = 5000;
Object.assign(process.env, {
  REDIS_URL: redis.url,
  CATALOGUE_INPUTS: stage.inputs,
  CATALOGUE_OUTPUTS: stage.outputs,
  CATALOGUE_CONCURRENCY: '1',
  CATALOGUE_LOCK: String(lockMs),
});
const { openCatalogue } = await import('../jobs.ts');
const { submit, untilDone } = await import('../submit.ts');
const catalogue = openCatalogue();

/** Submits transfers that nobody asked for yet. */
const order = async (jobs: number, threshold: number) =>
  submit(manifestOf(stage, [await transfers(stage, jobs, { threshold }, detail)]), catalogue);

const ticks = 100;
/** Processor time of a process until now, in seconds. */
const cpuOf = (pid: number): number => {
  const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1]!.split(' ');
  return (Number(fields[11]) + Number(fields[12])) / ticks;
};
const finished = async (): Promise<number> => {
  const { completed = 0, failed = 0 } = await catalogue.queue.getJobCounts('completed', 'failed');
  return completed + failed;
};
const round = (value: number, digits = 1) => Number(value.toFixed(digits));

/** Some jobs by a number of workers. Their start is not counted: each does some before. */
async function throughput(count: number, jobs: number) {
  const workers = Array.from({ length: count }, () => start('worker'));
  await order(20 * count, 0.1 + count / 100);
  await untilDone(catalogue);
  const before = await finished();
  const began = performance.now();
  const pids = [...workers.map(({ process }) => process.pid!), stage.redis.pid];
  const cpu = pids.map(cpuOf);
  await order(jobs, 0.2 + count / 100);
  while ((await finished()) < before + jobs) await setTimeout(50);
  const seconds = (performance.now() - began) / 1000;
  const used = pids.map((pid, i) => cpuOf(pid) - cpu[i]!);
  const perJob = (sum: number) => round((1000 * sum) / jobs, 2);
  const workerMs = perJob(used.slice(0, -1).reduce((a, b) => a + b, 0));
  await end(workers);
  return {
    workers: count,
    jobs,
    seconds: round(seconds),
    jobsPerSecond: round(jobs / seconds),
    workerMs,
    redisMs: perJob(used.at(-1)!),
    load: round(loadavg()[0]!),
  };
}

/** What a job takes of Redis' memory and its file. */
async function sizes() {
  const memory = Number(/used_memory:(\d+)/.exec(await catalogue.redis.info('memory'))![1]);
  const logs = join(folder, 'redis/appendonlydir');
  const log = readdirSync(logs).reduce((sum, name) => sum + statSync(join(logs, name)).size, 0);
  const all = await finished();
  return { jobsInRedis: all, bytesOfMemory: Math.round(memory / all), bytesOfLog: Math.round(log / all) };
}

console.table([await throughput(1, 200), await throughput(2, 200), await throughput(3, 200)]);
// Nothing of before counts in the night.
await catalogue.redis.flushall();
rmSync(stage.outputs, { recursive: true });
console.table(await disaster(stage, { jobs: most, fullMs: 6000, frozenMs: 2.5 * lockMs }));
console.table([await sizes()]);
await catalogue.close();
await stage.redis.stop();
rmSync(folder, { recursive: true, force: true });
