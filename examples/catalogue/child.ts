// The process that does jobs, one after another, for a worker (sandbox.ts). It may crash, hang or be killed.
import { Worker } from 'node:worker_threads';
import { asFailure } from './failure.ts';
import { kinds } from './kinds/index.ts';
import type { Reply, Task } from './sandbox.ts';

process.on('message', async ({ kind, inputs, settings }: Task) => {
  const before = process.cpuUsage();
  const cpuMs = () => {
    const { user, system } = process.cpuUsage(before);
    return Math.round((user + system) / 1000);
  };
  let reply: Reply;
  try {
    // Copies: what comes in messages is not aligned, as arrays of floats have to be.
    const own = Object.entries(inputs).map(([name, bytes]) => [name, Uint8Array.from(bytes)]);
    reply = { ...(await kinds[kind]!.run(Object.fromEntries(own), settings)), cpuMs: cpuMs() };
  } catch (error) {
    const { reason, message, facts } = asFailure(error);
    reply = { failure: { reason, text: message.slice(reason.length + 2), facts }, cpuMs: cpuMs() };
  }
  process.send!(reply);
});
process.on('disconnect', () => process.exit());
process.send!('ready');

// A hanging job would outlive a killed worker, as it never hears of its end. A thread of its own does.
new Worker(
  `const parent = process.ppid; setInterval(() => process.ppid === parent || process.kill(process.pid, 'SIGKILL'), 1000);`,
  { eval: true, execArgv: [] },
).unref();
