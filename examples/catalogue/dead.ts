// npm run dead [-- --reason REASON] [-- --retry]: the dead-letter list, a JSON object per line; or tries its jobs again.
import { parseArgs } from 'node:util';
import { command } from './command.ts';
import { reasons } from './failure.ts';
import { resultOf, startsKey } from './jobs.ts';

const { values } = parseArgs({ options: { reason: { type: 'string' }, retry: { type: 'boolean' } } });
await command(async ({ queue, redis }) => {
  if (values.reason !== undefined && !Object.hasOwn(reasons, values.reason)) {
    console.error(`--reason is "${values.reason}"; there are: ${Object.keys(reasons).join(', ')}`);
    return 2;
  }
  for (const job of await queue.getFailed(0, -1)) {
    const { key, reason, error, inputs } = resultOf(job, 'failed');
    if (values.reason !== undefined && values.reason !== reason) continue;
    console.log(JSON.stringify({ key, reason, error, inputs, tried: job.attemptsStarted }));
    if (!values.retry) continue;
    await redis.hdel(startsKey, key);
    await job.retry('failed', { resetAttemptsMade: true });
  }
  return 0;
});
