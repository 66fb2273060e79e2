import { standard } from '../io/files.js';
import type { Io } from '../io/io.js';
import { checkOutputs } from '../io/output.js';
import { jsonText, type Line, oneLine } from '../model/text.js';
import type * as common from './common-flags.js';

/** What a command found: for people, and for programs. */
export interface Found {
  lines: readonly Line[];
  report: object;
  /** Default: 0. */
  exitCode?: number;
}

/** The files that a command reads and writes, as flags and arguments name them. */
interface Files {
  inputs: readonly (string | undefined)[];
  outputs: readonly (string | undefined)[];
}

/**
 * Checks the files of a command before it begins, and prints what it finds: on the standard output, or beside it if a file is written
 * there.
 */
export async function perform(
  io: Io,
  { json, quiet }: common.PrintFlags,
  { inputs, outputs }: Files,
  find: () => Promise<Found>,
): Promise<void> {
  if (quiet) io.silence();
  checkOutputs(inputs, outputs);
  const { lines, report, exitCode = 0 } = await find();
  const text = json
    ? jsonText(report, 2)
    : `${lines
        .filter((line) => typeof line === 'string')
        .map(oneLine)
        .join('\n')}\n`;
  if (!quiet) outputs.includes(standard) ? io.err(text) : io.out(text);
  io.exitCode = exitCode;
}
