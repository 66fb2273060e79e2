// Ends the process when what it reads takes more than its share: from a thread of its own, as the other may never come back.
import { writeSync } from 'node:fs';
import { workerData } from 'node:worker_threads';

/** Where the other thread notes its processor milliseconds and its megabytes when it begins with a file; 0 between files. */
const began = new Float64Array(workerData.began);
const { milliseconds, megabytes } = workerData.limits;

setInterval(() => {
  const [cpu, memory] = began;
  if (cpu === 0) return;
  const { user, system } = process.cpuUsage();
  const spent = (user + system) / 1000 - cpu;
  const grown = process.memoryUsage.rss() / 2 ** 20 - memory;
  if (spent < milliseconds && grown < megabytes) return;
  const what =
    spent < milliseconds ? `more than ${megabytes} MB` : `more than ${milliseconds / 1000} s of the processor`;
  writeSync(2, `\nit takes ${what}\n`);
  process.kill(process.pid, 'SIGKILL');
}, 20);
