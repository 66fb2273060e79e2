// npm run dead [-- --reason REASON] [-- --retry]: the dead-letter list, a JSON object per line; or tries its jobs again.
import { parseArgs } from 'node:util';
import { reasonOf } from './failure.ts';
import { openCatalogue, resultOf, startsKey } from './jobs.ts';

const { values } = parseArgs({ options: { reason: { type: 'string' }, retry: { type: 'boolean' } } });
const { queue, redis, close } = openCatalogue();
for (const job of await queue.getFailed(0, -1)) {
  const { key, reason, error, inputs } = resultOf(job, 'failed');
  if (values.reason !== undefined && values.reason !== reasonOf(job.failedReason)) continue;
  console.log(JSON.stringify({ key, reason, error, inputs, tried: job.attemptsStarted }));
  if (!values.retry) continue;
  await redis.hdel(startsKey, key);
  await job.retry('failed', { resetAttemptsMade: true });
}
await close();
