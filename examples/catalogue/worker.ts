// npm run worker: any number of them, on any machine.
import { UnrecoverableError, Worker } from 'bullmq';
import { asFailure, Failure, publicOf, redisTrouble, withoutSecrets } from './failure.ts';
import { type CatalogueJob, connect, outputOf, queueName, startsKey } from './jobs.ts';
import { kinds } from './kinds/index.ts';
import { isInTrouble, patiently, tellTrouble } from './patience.ts';
import { Sandbox } from './sandbox.ts';
import { settings } from './settings.ts';
import { checkedJob, type Done, type JobData, type Written } from './shape.ts';
import { hashOf, read, removeLeftovers, shown, write } from './storage.ts';

/** A job is given up when it has killed so many processes. */
const mostDeaths = 3;

const redis = connect();
const sandboxes: Sandbox[] = [];
/** Those of them that have no job at the moment. */
const idle: Sandbox[] = [];

/** Does a job. Whatever it does can be done again: its output is the same bytes in the same place. */
async function run(job: CatalogueJob): Promise<Done> {
  const began = performance.now();
  let starts = 0;
  try {
    const { key, data } = checkedJob(job);
    // Counted before, so that it is known even if this process dies at once.
    starts = await patiently(() => redis.hincrby(startsKey, key, 1));
    if (starts > mostDeaths) throw new Failure('crash', `a worker died on it ${mostDeaths} times`);
    const { facts, cpuMs, ...written } = await result(key, data);
    await patiently(() => redis.hdel(startsKey, key));
    return { facts, ...written, ms: Math.round(performance.now() - began), cpuMs };
  } catch (error) {
    throw await ended(job, asFailure(error), starts);
  }
}

/** What a job comes to, with its output written. @throws {Failure} */
async function result(key: string, data: JobData): Promise<Omit<Done, 'ms'>> {
  if (!Object.hasOwn(kinds, data.kind))
    throw new Failure('missing', `this worker does not know the kind "${data.kind}" (CATALOGUE_KINDS)`);
  const { ending = '', seconds = settings.seconds } = kinds[data.kind]!;
  const sandbox = idle.pop() ?? newSandbox();
  try {
    const { facts, output, cpuMs } = await sandbox.run({ ...data, seconds, inputs: await inputsOf(data) });
    const place = data.output ?? outputOf(key, ending);
    return { facts: publicOf(facts), cpuMs, ...(output && (await written(place, output))) };
  } finally {
    idle.push(sandbox);
  }
}

/** Writes an output, and says what was written. @throws {Failure} */
async function written(place: string, bytes: Uint8Array): Promise<Written> {
  const outputTime = await write(place, bytes);
  const output = { output: shown(place), outputBytes: bytes.length, outputSha256: hashOf(bytes) };
  return outputTime === undefined ? output : { ...output, outputTime };
}

function newSandbox(): Sandbox {
  const sandbox = new Sandbox();
  sandboxes.push(sandbox);
  return sandbox;
}

/** How a failure is reported to BullMQ: again after a while, or never. */
async function ended(job: CatalogueJob, failure: Failure, starts: number): Promise<Error> {
  const isCrash = failure.reason === 'crash';
  if (!isCrash || starts >= mostDeaths) await patiently(() => redis.hdel(startsKey, String(job.id)));
  if (failure.facts) await patiently(() => job.updateProgress(publicOf(failure.facts!)));
  const passes = failure.mayPass && !(isCrash && starts >= mostDeaths);
  const error = passes ? failure : new UnrecoverableError(failure.message);
  error.stack = ''; // it would be kept in Redis, and shown
  return error;
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

/** All calls that BullMQ makes about jobs go through this method of its worker, which waits only if there is no connection. */
interface Calls {
  retryIfFailed?(ask: () => Promise<unknown>, options: object): Promise<unknown>;
}

/** Lets a worker's own calls wait for Redis, whatever keeps it from answering. */
function makePatient(worker: Worker<JobData, Done>): void {
  const calls = worker as unknown as Calls;
  const original = calls.retryIfFailed?.bind(worker);
  if (!original)
    throw new Failure('unexpected', 'this version of BullMQ is not supported: npm ci installs one that is');
  calls.retryIfFailed = (ask, options) => original(() => patiently(ask), options);
}

await removeLeftovers();
const worker = new Worker<JobData, Done>(queueName, run, {
  connection: redis.duplicate(),
  prefix: settings.prefix,
  autorun: false,
  concurrency: settings.concurrency,
  lockDuration: settings.lock,
  stalledInterval: settings.lock / 2,
  // Our own count comes first, with a reason; this one is the net below, wide enough for a Redis that is away often.
  maxStalledCount: 20,
  ...(settings.rate > 0 && { limiter: { max: settings.rate, duration: 1000 } }),
});
makePatient(worker);
const tell = (text: string) => console.error(`${new Date().toISOString()} ${withoutSecrets(text)}`);
worker.on('error', (error) => {
  const trouble = redisTrouble(error);
  if (trouble !== undefined) tellTrouble(trouble);
  else tell(asFailure(error).message);
});
worker.on('failed', (job, { message }) => {
  // All others are as expected, and in the dead-letter list.
  if (/^(unexpected|crash)/.test(message)) tell(`${job?.id} ${message}`);
});
await patiently(() => worker.waitUntilReady());
void worker.run();
console.log(`worker ${process.pid}: ${settings.concurrency} at once, ${new URL(settings.redis).host}`);

let isEnding = false;
for (const signal of ['SIGINT', 'SIGTERM'] as const)
  process.on(signal, async () => {
    // Without Redis there is nobody to tell of the jobs that it has: they will be started again.
    if (!isEnding && redis.status === 'ready' && !isInTrouble()) {
      isEnding = true;
      await worker.close(); // when the jobs that it has are done
    }
    for (const sandbox of sandboxes) sandbox.close();
    process.exit(0);
  });
