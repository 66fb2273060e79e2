// The program: what connects the command with a process. A batch runs this file in its threads, too.
import { isMainThread } from 'node:worker_threads';
import { runCommand, serveBatch, writeStandard } from './command.js';

if (isMainThread) {
  const { stdout, stderr } = process;
  // A reader that closes the pipe early, such as `head`, is not an error: what is left to be done is done.
  stdout.on('error', ({ code, message }: NodeJS.ErrnoException) => {
    if (code === 'EPIPE') return;
    stderr.write(`cagecast: the standard output: cannot be written (${message})\n`);
    process.exit(1);
  });
  process.exitCode = await runCommand(process.argv.slice(2), {
    stdout: writeStandard,
    stderr: (text) => stderr.write(text),
    columns: stderr.isTTY ? stderr.columns || 80 : undefined,
  });
} else {
  serveBatch();
}
