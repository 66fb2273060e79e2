import { CommanderError } from 'commander';
import { makeProgram } from './commands/program.js';
import { Io, type Streams } from './io/io.js';
import { kExit, messageOf, UsageError } from './model/failures.js';
import { oneLine } from './model/text.js';

export { serveBatch } from './commands/batch-worker.js';
export { writeStandard } from './io/output.js';

/**
 * Runs the command. Paths are relative to the working directory of the process, and `-` is its standard input.
 * @param args  Without the program's name.
 * @returns its exit code.
 */
export async function runCommand(args: readonly string[], streams: Streams): Promise<number> {
  const io = new Io(streams);
  try {
    await makeProgram(io).parseAsync(args, { from: 'user' });
    io.clear();
    return io.exitCode;
  } catch (error) {
    // Help that is printed because no command was given is wrong usage.
    if (error instanceof CommanderError) return error.exitCode === 0 ? 0 : kExit.wrongUsage;
    io.err(`cagecast: ${oneLine(messageOf(error))}\n`);
    return error instanceof UsageError ? kExit.wrongUsage : kExit.unusable;
  }
}
