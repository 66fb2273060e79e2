import { type Command, InvalidArgumentError, Option } from 'commander';
import type { ReadOptions } from '../gltf/files.js';
import { defaultLimits, type ReadLimits } from '../gltf/limits.js';

/** The flags that say how files are read, as commander parses them. */
export interface ReadFlags {
  allowOutside?: boolean;
  limit?: Partial<ReadLimits>;
}

/** Adds the flags that say how files are read. */
export function addReadFlags(command: Command): Command {
  const limits = Object.entries(defaultLimits).map(([name, value]) => `${name}=${value}`);
  return command
    .option(
      '--allow-outside',
      'read also files outside the folder of a glTF or a found cagecast.config.json that refers to them',
    )
    .addOption(
      new Option(
        '--limit <NAME=VALUE>',
        `what reading a file may cost; may be repeated; names and defaults: ${limits.join(', ')}`,
      ).argParser(limitOf),
    );
}

/** How files are read, by the flags. */
export const readingOf = ({ allowOutside = false, limit }: ReadFlags): ReadOptions => ({
  allowOutside,
  limits: { ...defaultLimits, ...limit },
});

function limitOf(text: string, before: Partial<ReadLimits> = {}): Partial<ReadLimits> {
  const [name = '', value = ''] = text.split('=', 2);
  if (!Object.hasOwn(defaultLimits, name))
    throw new InvalidArgumentError(`There are the limits ${Object.keys(defaultLimits).join(', ')}.`);
  if (!/^\d+$/.test(value)) throw new InvalidArgumentError(`A limit is a whole number, such as ${name}=5000.`);
  return { ...before, [name]: Number(value) };
}
