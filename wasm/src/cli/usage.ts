import { type Command, InvalidArgumentError } from 'commander';
import { standard } from '../gltf/files.js';
import { firstLine, InputError } from '../gltf/input-error.js';
import { CagecastError } from '../index.js';
import { canonicalPath } from './output.js';

/** Exit codes. */
export const unusable = 1;
export const wrongUsage = 2;
export const unfit = 3;
export const changed = 4;

/** Arguments that cannot be used together, which shows only once files are read. */
export class UsageError extends InputError {}

/** What an error says of what went wrong. Others than those of files and of the package are defects. */
export const messageOf = (error: unknown): string =>
  error instanceof InputError || error instanceof CagecastError
    ? error.message
    : `failed unexpectedly (${firstLine(error)}); please report it`;

/** Returns a parser for the name of a file with one of some endings, or of the standard output. */
export function endingIn(...endings: string[]): (text: string) => string {
  return (text) => {
    if (text !== standard && !endings.some((ending) => text.toLowerCase().endsWith(ending)))
      throw new InvalidArgumentError(`Its name must end in ${endings.join(' or ')}, or be -, the standard output.`);
    return text;
  };
}

/** Ends the command with a message if an output is an input as well, or two outputs are one file, or two inputs the standard input. */
export function refuseOverwriting(
  command: Command,
  inputs: readonly (string | undefined)[],
  outputs: readonly (string | undefined)[],
): void {
  for (const [paths, name] of [
    [inputs, 'input'],
    [outputs, 'output'],
  ] as const)
    if (paths.filter((path) => path === standard).length > 1)
      command.error(`only one file can be the standard ${name}`, { exitCode: wrongUsage });
  const known = new Map<string, string>();
  const add = (path: string | undefined, use: string) => {
    if (path !== undefined && path !== standard) known.set(canonicalPath(path), `${path}, which this command ${use}`);
  };
  for (const path of inputs) add(path, 'reads');
  for (const path of outputs) {
    const other = path === undefined || path === standard ? undefined : known.get(canonicalPath(path));
    if (other !== undefined)
      command.error(`${path} would overwrite ${other}; choose another output`, { exitCode: wrongUsage });
    add(path, 'writes');
  }
}
