import { isMainThread } from 'node:worker_threads';
import { CommanderError } from 'commander';
import { firstLine } from '../gltf/input-error.js';
import { serveBatch } from './batch-worker.js';
import { oneLine } from './print.js';
import { makeProgram } from './program/program.js';
import { Progress } from './progress.js';
import { messageOf, UsageError, unusable, wrongUsage } from './usage.js';

// A reader that closes the pipe early, such as `head`, is not an error: what is left to be done is done.
process.stdout.on('error', (error: NodeJS.ErrnoException) => {
  if (error.code === 'EPIPE') return;
  process.stderr.write(`cagecast: the standard output: cannot be written (${firstLine(error)})\n`);
  process.exit(unusable);
});

/** Runs the command that the arguments say. */
async function main(): Promise<void> {
  const progress = new Progress();
  try {
    await makeProgram(progress).parseAsync();
  } catch (error) {
    progress.clear();
    if (error instanceof CommanderError) {
      // Help that is printed because no command was given is wrong usage.
      process.exitCode = error.exitCode === 0 ? 0 : wrongUsage;
    } else {
      process.stderr.write(`cagecast: ${oneLine(messageOf(error))}\n`);
      process.exitCode = error instanceof UsageError ? wrongUsage : unusable;
    }
  }
}

// A batch runs this file in its threads.
if (isMainThread) await main();
else serveBatch();
