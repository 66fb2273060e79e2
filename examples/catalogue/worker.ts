// npm run worker: any number of them, on any machine.
import { UnrecoverableError, Worker } from 'bullmq';
import { asFailure, Failure } from './failure.ts';
import { type CatalogueJob, connect, type Done, type JobData, outputOf, queueName, startsKey } from './jobs.ts';
import { kinds } from './kinds/index.ts';
import { hashOf } from './manifest.ts';
import { Sandbox } from './sandbox.ts';
import { settings } from './settings.ts';
import { isUrl, read, removeLeftovers, shown, write } from './storage.ts';

/** A job is given up when it has killed so many processes. */
const mostDeaths = 3;

const redis = connect();
const sandboxes: Sandbox[] = [];
/** Those of them that have no job at the moment. */
const idle: Sandbox[] = [];

/** Does a job. Whatever it does can be done again: its output is the same bytes in the same place. */
async function run(job: CatalogueJob): Promise<Done> {
  const { id: key = '', data } = job;
  const began = performance.now();
  // Counted before, so that it is known even if this process dies at once.
  const starts = await redis.hincrby(startsKey, key, 1);
  const sandbox = idle.pop() ?? newSandbox();
  try {
    if (starts > mostDeaths) throw new Failure('crash', `a worker died on it ${mostDeaths} times`);
    const kind = kinds[data.kind];
    if (!kind) throw new Failure('missing', `this worker does not know the kind "${data.kind}"`);
    const { ending = '', seconds = settings.seconds } = kind;
    const { facts, output, cpuMs } = await sandbox.run({ ...data, seconds, inputs: await inputsOf(data) });
    const place = data.output ?? outputOf(key, ending);
    if (output) await write(place, output);
    await redis.hdel(startsKey, key);
    return { facts, ...(output && { output: shown(place) }), ms: Math.round(performance.now() - began), cpuMs };
  } catch (error) {
    throw await ended(job, asFailure(error), starts);
  } finally {
    idle.push(sandbox);
  }
}

function newSandbox(): Sandbox {
  const sandbox = new Sandbox();
  sandboxes.push(sandbox);
  return sandbox;
}

/** How a failure is reported to BullMQ: again after a while, or never. */
async function ended(job: CatalogueJob, failure: Failure, starts: number): Promise<Error> {
  const isCrash = failure.reason === 'crash';
  if (!isCrash || starts >= mostDeaths) await redis.hdel(startsKey, job.id!);
  if (failure.facts) await job.updateProgress(failure.facts);
  return failure.mayPass && !(isCrash && starts >= mostDeaths) ? failure : new UnrecoverableError(failure.message);
}

/** The inputs of a job, if they are what was submitted. @throws {Failure} */
async function inputsOf({ inputs }: JobData): Promise<Record<string, Uint8Array>> {
  const readOne = async ([name, { place, sha256 }]: [string, JobData['inputs'][string]]) => {
    const bytes = await read(place);
    if (hashOf(bytes) !== sha256) throw new Failure('missing', `${shown(place)} has changed since it was submitted`);
    return [name, bytes] as const;
  };
  return Object.fromEntries(await Promise.all(Object.entries(inputs).map(readOne)));
}

await removeLeftovers();
const worker = new Worker<JobData, Done>(queueName, run, {
  connection: redis.duplicate(),
  prefix: settings.prefix,
  concurrency: settings.concurrency,
  lockDuration: settings.lock,
  stalledInterval: settings.lock / 2,
  // Our own count comes first, with a reason; this one is the net below.
  maxStalledCount: mostDeaths + 1,
  ...(settings.rate > 0 && { limiter: { max: settings.rate, duration: 1000 } }),
});
const tell = (text: string) => console.error(`${new Date().toISOString()} ${text}`);
let last = '';
worker.on('error', ({ message }) => {
  if (message !== last) tell(message); // a Redis that is away is reported once
  last = message;
});
worker.on('failed', (job, { message }) => {
  // All others are as expected, and in the dead-letter list.
  if (/^(unexpected|crash)/.test(message)) tell(`${job?.id} ${message}`);
});
await worker.waitUntilReady();
console.log(
  `worker ${process.pid}: ${settings.concurrency} at once, ${isUrl(settings.redis) ? new URL(settings.redis).host : ''}`,
);

let isEnding = false;
for (const signal of ['SIGINT', 'SIGTERM'] as const)
  process.on(signal, async () => {
    // Without Redis there is nobody to tell of the jobs that it has: they will be started again.
    if (!isEnding && redis.status === 'ready') {
      isEnding = true;
      await worker.close(); // when the jobs that it has are done
    }
    for (const sandbox of sandboxes) sandbox.close();
    process.exit(0);
  });
