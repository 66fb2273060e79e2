import { type Queue, QueueEvents } from 'bullmq';
import { Counter, Gauge, Histogram, Registry } from 'prom-client';
import { reasonOf } from '../failure.ts';
import { connect, queueName } from '../jobs.ts';
import { patiently } from '../patience.ts';
import { settings } from '../settings.ts';
import { checkedDone, type Done, type JobData } from '../shape.ts';

/**
 * The metrics of all workers together, from the events of the queue: counted since this process began, as Prometheus expects, and
 * read from one place.
 */
export async function watch(
  queue: Queue<JobData, Done>,
): Promise<{ text: () => Promise<string>; close: () => Promise<void> }> {
  const register = new Registry();
  const registers = [register];
  const depth = new Gauge({ name: 'catalogue_jobs', help: 'Jobs by state', labelNames: ['state'], registers });
  const done = new Counter({
    name: 'catalogue_jobs_done_total',
    help: 'Jobs that were done, by verdict',
    labelNames: ['verdict'],
    registers,
  });
  const failed = new Counter({
    name: 'catalogue_jobs_failed_total',
    help: 'Jobs that went to the dead-letter list, by reason',
    labelNames: ['reason'],
    registers,
  });
  const stalled = new Counter({
    name: 'catalogue_jobs_stalled_total',
    help: 'Jobs that were started again because their worker was gone',
    registers,
  });
  const buckets = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60, 120];
  const seconds = (name: string, help: string) => new Histogram({ name, help, buckets, registers });
  const duration = seconds('catalogue_job_duration_seconds', 'From start to end of a job, with its inputs and outputs');
  const cpu = seconds('catalogue_job_cpu_seconds', 'Processor time of a job');

  const redis = connect();
  // From the last event until now: one that comes while this connects counts.
  const [last] = await patiently(() => redis.xrevrange(queue.toKey('events'), '+', '-', 'COUNT', 1));
  const lastEventId = last?.[0] ?? '0-0';
  const events = new QueueEvents(queueName, { connection: redis, prefix: settings.prefix, lastEventId });
  events.on('error', () => {}); // it tries again
  events.on('completed', ({ returnvalue }) => {
    const { facts, ms, cpuMs } = doneOf(returnvalue);
    done.inc({ verdict: facts.verdict ?? 'none' });
    duration.observe(ms / 1000);
    cpu.observe(cpuMs / 1000);
  });
  events.on('failed', ({ failedReason }) => failed.inc({ reason: reasonOf(failedReason) }));
  events.on('stalled', () => stalled.inc());
  return {
    text: async () => {
      depth.reset();
      for (const [state, count] of Object.entries(await queue.getJobCounts())) depth.set({ state }, count);
      return register.metrics();
    },
    close: async () => {
      await events.close();
      redis.disconnect();
    },
  };
}

/** What an event says of a job that is done; whatever it says. */
function doneOf(value: unknown): Done {
  try {
    return checkedDone(value);
  } catch {
    return { facts: {}, ms: 0, cpuMs: 0 };
  }
}
