// npm run bench [-- --jobs 2000] [-- --detail 12]: what the catalogue holds and what it costs, measured on this machine.
//   --jobs     transfers in the large run, in which a worker is killed and Redis is restarted
//   --detail   quads along and around each model: 12 make 264 triangles
import { type ChildProcess, spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { loadavg, tmpdir } from 'node:os';
import { join } from 'node:path';
import { setTimeout } from 'node:timers/promises';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { Document, NodeIO } from '@gltf-transform/core';
import { startRedis } from '../redis.ts';

const { values } = parseArgs({ options: { jobs: { type: 'string' }, detail: { type: 'string' } } });
const [most, detail] = [Number(values.jobs ?? 2000), Number(values.detail ?? 12)];
const folder = mkdtempSync(join(tmpdir(), 'catalogue-bench-'));
const [inputs, outputs] = [join(folder, 'inputs'), join(folder, 'outputs')];
let redis = await startRedis(join(folder, 'redis'));
Object.assign(process.env, {
  REDIS_URL: redis.url,
  CATALOGUE_INPUTS: inputs,
  CATALOGUE_OUTPUTS: outputs,
  CATALOGUE_CONCURRENCY: '1',
  CATALOGUE_LOCK: '5000',
});
const { openCatalogue } = await import('../jobs.ts');
const { submit, untilDone } = await import('../submit.ts');
const { collectResults } = await import('../results.ts');
const catalogue = openCatalogue();

/** A sphere as a GLB. */
function sphere(radius: number): Promise<Uint8Array> {
  const [positions, uvs, indices]: [number[], number[], number[]] = [[], [], []];
  for (let r = 0; r <= detail; ++r)
    for (let s = 0; s <= detail; ++s) {
      const [theta, phi] = [(Math.PI * r) / detail, (2 * Math.PI * (s % detail)) / detail];
      const flat = r % detail === 0 ? 0 : Math.sin(theta);
      positions.push(radius * flat * Math.cos(phi), radius * flat * Math.sin(phi), radius * Math.cos(theta));
      uvs.push(s / detail, r / detail);
      if (r === detail || s === detail) continue;
      const a = r * (detail + 1) + s;
      const b = a + detail + 1;
      if (r > 0) indices.push(a, b, a + 1);
      if (r < detail - 1) indices.push(a + 1, b, b + 1);
    }
  const document = new Document();
  const buffer = document.createBuffer();
  const accessor = (type: 'VEC3' | 'VEC2' | 'SCALAR', array: Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer>) =>
    document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const primitive = document
    .createPrimitive()
    .setAttribute('POSITION', accessor('VEC3', new Float32Array(positions)))
    .setAttribute('TEXCOORD_0', accessor('VEC2', new Float32Array(uvs)))
    .setIndices(accessor('SCALAR', new Uint32Array(indices)));
  const node = document.createNode('sphere').setMesh(document.createMesh().addPrimitive(primitive));
  document.createScene().addChild(node);
  return new NodeIO().writeBinary(document);
}

/** Submits transfers that nobody asked for yet. */
async function order(jobs: number, threshold: number): Promise<{ new: number }> {
  const target = Array.from({ length: Math.ceil(jobs / 20) }, (_, t) => `target-${t}.glb`);
  const cage = Array.from({ length: 20 }, (_, c) => `cage-${c}.glb`);
  writeFileSync(
    join(folder, 'manifest.jsonl'),
    JSON.stringify({ kind: 'transfer', target, cage, settings: { threshold } }),
  );
  return submit(join(folder, 'manifest.jsonl'), catalogue);
}

const startWorker = (): ChildProcess =>
  spawn(process.execPath, ['--import', 'tsx', fileURLToPath(new URL('worker.ts', import.meta.url))], {
    stdio: 'ignore',
  });
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
const until = async (count: number) => {
  while ((await finished()) < count) await setTimeout(50);
};
async function end(workers: ChildProcess[]): Promise<void> {
  const running = workers.filter(({ exitCode, signalCode }) => exitCode === null && signalCode === null);
  const ended = running.map((worker) => once(worker, 'exit'));
  for (const worker of running) worker.kill();
  await Promise.all(ended);
}
const round = (value: number, digits = 1) => Number(value.toFixed(digits));

/** Some jobs by a number of workers. Their start is not counted: each does some before. */
async function throughput(count: number, jobs: number) {
  const workers = Array.from({ length: count }, startWorker);
  await order(20 * count, 0.1 + count / 100);
  await untilDone(catalogue);
  const before = await finished();
  const began = performance.now();
  const cpu = [...workers.map(({ pid }) => cpuOf(pid!)), cpuOf(redis.pid)];
  await order(jobs, 0.2 + count / 100);
  await until(before + jobs);
  const seconds = (performance.now() - began) / 1000;
  const used = [...workers.map(({ pid }) => cpuOf(pid!)), cpuOf(redis.pid)].map((now, i) => now - cpu[i]!);
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

/** Many jobs on three workers, of which one is killed; Redis is killed and restarted on the way. */
async function disaster(jobs: number) {
  const began = performance.now();
  const workers = Array.from({ length: 3 }, startWorker);
  const submitted = await order(jobs, 0.5);
  const start = (await finished()) - 0;
  await until(start + jobs * 0.3);
  workers[0]!.kill('SIGKILL');
  await until(start + jobs * 0.6);
  await redis.stop('SIGKILL');
  redis = await startRedis(join(folder, 'redis'), Number(new URL(redis.url).port));
  await untilDone(catalogue);
  const seconds = (performance.now() - began) / 1000;
  const again = await order(jobs, 0.5);
  await end(workers);
  let [lines, done, whole, cpuMs] = [0, 0, 0, 0];
  const keys = new Set<string>();
  await collectResults(catalogue, ({ key, status, settings, output, cpuMs: ms = 0 }) => {
    if (settings['threshold'] !== 0.5) return;
    ++lines;
    keys.add(key);
    done += Number(status === 'done');
    cpuMs += ms;
    const bytes = readFileSync(join(outputs, output!));
    whole += Number(bytes.readUInt32LE(8) === bytes.length); // the length that a GLB says it has
  });
  const files = readdirSync(join(outputs, 'transfer'), { recursive: true }).filter((name) =>
    String(name).endsWith('.glb'),
  );
  return {
    jobs: submitted.new,
    results: lines,
    keys: keys.size,
    done,
    whole,
    files: files.length,
    secondSubmission: again.new,
    seconds: round(seconds),
    jobMs: round(cpuMs / jobs, 2),
  };
}

mkdirSync(inputs);
for (let c = 0; c < 20; ++c) writeFileSync(join(inputs, `cage-${c}.glb`), await sphere(1.1 + c / 1000));
for (let t = 0; t < Math.ceil(Math.max(most, 200) / 20); ++t)
  writeFileSync(join(inputs, `target-${t}.glb`), await sphere(1 + t / 1e5));
console.table([await throughput(1, 200), await throughput(2, 200), await throughput(3, 200)]);
console.table([await disaster(most)]);
const memory = Number(/used_memory:(\d+)/.exec(await catalogue.redis.info('memory'))![1]);
const log = readdirSync(join(folder, 'redis/appendonlydir')).reduce(
  (sum, name) => sum + statSync(join(folder, 'redis/appendonlydir', name)).size,
  0,
);
const all = await finished();
console.table([{ jobsInRedis: all, bytesOfMemory: Math.round(memory / all), bytesOfLog: Math.round(log / all) }]);
await catalogue.close();
await redis.stop();
rmSync(folder, { recursive: true, force: true });
