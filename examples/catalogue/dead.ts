// npm run dead [-- --reason REASON] [-- --retry]: the dead-letter list, a JSON object per line; or tries its jobs again.
import { parseArgs } from 'node:util';
import { command } from './command.ts';
import { Failure, reasons } from './failure.ts';
import { resultOf, retry, startsKey } from './jobs.ts';
import { patiently } from './patience.ts';

await command(async ({ queue, redis }) => {
  const { values } = parseArgs({ options: { reason: { type: 'string' }, retry: { type: 'boolean' } } });
  if (values.reason !== undefined && !Object.hasOwn(reasons, values.reason))
    throw new Failure('broken', `--reason is "${values.reason}"; there are: ${Object.keys(reasons).join(', ')}`);
  for (const id of await patiently(() => queue.getRanges(['failed'], 0, -1))) {
    const job = await patiently(() => queue.getJob(id));
    if (!job) continue; // tried again meanwhile
    const { key, reason, error, inputs } = resultOf(job, 'failed');
    if (values.reason !== undefined && values.reason !== reason) continue;
    console.log(JSON.stringify({ key, reason, error, inputs, tried: job.attemptsStarted }));
    if (!values.retry) continue;
    await patiently(() => redis.hdel(startsKey, key));
    await retry(job, 'failed');
  }
  return 0;
});
