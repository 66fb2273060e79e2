import { type Command, InvalidArgumentError } from 'commander';
import { placeOf } from './output.js';

/** Exit codes. */
export const unusable = 1;
export const wrongUsage = 2;
export const unfit = 3;

/** Returns a parser for the name of a file with some ending. */
export function endingIn(ending: string): (text: string) => string {
  return (text) => {
    if (!text.toLowerCase().endsWith(ending)) throw new InvalidArgumentError(`Its name must end in ${ending}.`);
    return text;
  };
}

/** Ends the command with a message if an output is an input as well, or two outputs are one file. */
export function refuseOverwriting(
  command: Command,
  inputs: readonly (string | undefined)[],
  outputs: readonly (string | undefined)[],
): void {
  const placesOf = (paths: readonly (string | undefined)[]) =>
    paths.filter((path) => path !== undefined).map((path) => placeOf(path));
  const [read, written] = [placesOf(inputs), placesOf(outputs)];
  const clash = written.find((path, i) => read.includes(path) || written.indexOf(path) !== i);
  if (clash !== undefined)
    command.error(`${clash} would overwrite another file of this command`, { exitCode: wrongUsage });
}
