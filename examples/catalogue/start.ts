// npm start: the catalogue over the sample models, on this machine: a Redis of its own, workers, the status page and the report.
//   --once   ends when all is done, instead of serving the pages until Ctrl-C
import { type ChildProcess, spawn } from 'node:child_process';
import { once } from 'node:events';
import { availableParallelism } from 'node:os';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { freePort, startRedis } from './redis.ts';

const here = (path: string) => fileURLToPath(new URL(path, import.meta.url));
const { values } = parseArgs({ options: { once: { type: 'boolean' } } });

process.env.CATALOGUE_INPUTS ??= here('../samples');
process.env.CATALOGUE_OUTPUTS ??= here('outputs');
const redis = process.env.REDIS_URL ? undefined : await startRedis(here('.redis'));
process.env.REDIS_URL ??= redis!.url;
process.env.CATALOGUE_PORT ??= String(await freePort());

// These read the environment.
const { openCatalogue } = await import('./jobs.ts');
const { describe, onTerminal, submit, untilDone } = await import('./submit.ts');
const { serveStatus } = await import('./status.ts');
const { described, report } = await import('./report.ts');

const catalogue = openCatalogue();
const { address, close } = await serveStatus(catalogue);
console.log(`queue    ${address}/queue\nmetrics  ${address}/metrics`);
const workers: ChildProcess[] = Array.from({ length: Math.max(2, availableParallelism()) }, () =>
  spawn(process.execPath, ['--import', 'tsx', here('worker.ts')], {
    cwd: here('.'),
    env: { ...process.env, CATALOGUE_CONCURRENCY: '1' },
    stdio: ['ignore', 'ignore', 'inherit'],
  }),
);
const summary = await submit(here('samples.jsonl'), catalogue);
console.log(describe(summary));
for (const error of summary.errors) console.log(`  ${error}`);
await untilDone(catalogue, onTerminal);
const counts = await report(catalogue);
console.log(`\n${described(counts)}\nreport   ${address}/files/report.html\nresults  ${address}/files/results.jsonl`);
if (!values.once) {
  console.log('Ctrl-C ends all of it.');
  await Promise.race([once(process, 'SIGINT'), once(process, 'SIGTERM')]);
}
for (const worker of workers) worker.kill();
await Promise.all(workers.map((worker) => worker.exitCode ?? once(worker, 'exit')));
await close();
await catalogue.close();
await redis?.stop();
