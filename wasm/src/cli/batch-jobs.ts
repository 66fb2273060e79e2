import { createHash } from 'node:crypto';
import { existsSync, statSync } from 'node:fs';
import { basename, dirname, extname, resolve } from 'node:path';
import { optionFlags } from '../generated/options.js';
import { readBytes, standard } from '../gltf/files.js';
import { forms } from '../gltf/glb-writer.js';
import { firstLine, InputError } from '../gltf/input-error.js';
import { filesOf } from './glob.js';
import { placeOf } from './output.js';
import { autoCage } from './run.js';
import type { TransferCommand } from './transfer-command.js';

/** A transfer of a batch. */
export interface Job {
  command: TransferCommand;
  /** Identifies the job: its arguments, and the size and time of what it reads. */
  key: string;
  /** Why it cannot be started, if so. */
  error?: string;
}

/** What jobs have in common, from the command line. */
export type JobDefaults = Omit<TransferCommand, 'target' | 'cage'> & { cage?: string | undefined };

/** The jobs for the files that patterns name. @throws {InputError} for a pattern without files. */
export function jobsOfPatterns(patterns: readonly string[], defaults: JobDefaults): Job[] {
  const targets = patterns.flatMap((pattern) => {
    const found = filesOf(pattern);
    if (found.length === 0) throw new InputError('no file has such a name').in(pattern);
    return found;
  });
  return refuseClashes([...new Set(targets)].map((target) => jobOf({ ...defaults, target })));
}

/**
 * The jobs of a manifest: a JSON object per line, with paths relative to the manifest. A line that is wrong becomes a job that fails.
 * @throws {InputError} if the manifest cannot be read, or two jobs write the same file.
 */
export async function jobsOfManifest(path: string, defaults: JobDefaults): Promise<Job[]> {
  let text: string;
  try {
    text = new TextDecoder().decode(await readBytes(path));
  } catch (error) {
    throw error instanceof InputError ? error.in(path) : error;
  }
  const folder = path === standard ? '.' : dirname(path);
  const lines = text.split('\n').map((line, i) => ({ line: line.trim(), place: `line ${i + 1} of ${path}` }));
  return refuseClashes(
    lines
      .filter(({ line }) => line !== '')
      .map(({ line, place }) => {
        try {
          return jobOf({ ...defaults, ...jobLine(line, folder, defaults) });
        } catch (error) {
          const command = { ...defaults, target: place, cage: '' };
          return { command, key: place, error: `${place}: ${firstLine(error)}` };
        }
      }),
  );
}

const paths = ['target', 'cage', 'texture', 'output', 'report'] as const;

/** A line of a manifest. @throws {InputError} that names the member. */
function jobLine(line: string, folder: string, { rules }: JobDefaults): Partial<TransferCommand> & { target: string } {
  let all: unknown;
  try {
    all = JSON.parse(line);
  } catch (error) {
    throw new InputError(`is not JSON (${firstLine(error)})`);
  }
  if (typeof all !== 'object' || all === null || Array.isArray(all)) throw new InputError('is not a JSON object');
  const given = all as Record<string, unknown>;
  const known = [...paths, 'borders', 'compress', 'preset', 'keep', 'exclude', ...optionFlags.map(({ name }) => name)];
  const unknown = Object.keys(given).find((name) => !(known as string[]).includes(name));
  if (unknown !== undefined) throw new InputError(`"${unknown}" is unknown; there are: ${known.join(', ')}`);
  const choice = (name: string, choices: readonly string[]) => {
    if (given[name] !== undefined && !choices.includes(given[name] as string))
      throw new InputError(`"${name}" is not one of ${choices.join(', ')}`);
  };
  choice('borders', ['triangle', 'cut']);
  choice('compress', forms);
  choice('preset', ['default', 'paper']);
  for (const name of paths)
    if (given[name] !== undefined && typeof given[name] !== 'string') throw new InputError(`"${name}" is not a path`);
  for (const name of ['keep', 'exclude'])
    if (
      given[name] !== undefined &&
      !(Array.isArray(given[name]) && given[name].every((one) => typeof one === 'string'))
    )
      throw new InputError(`"${name}" is not an array of names`);
  if (given['target'] === undefined) throw new InputError('has no "target"');
  const own = Object.fromEntries(
    paths.flatMap((name) => {
      const path = given[name] as string | undefined;
      return path === undefined ? [] : [[name, name === 'cage' && path === autoCage ? path : resolve(folder, path)]];
    }),
  );
  const { borders, compress, preset = rules.preset, keep = rules.keep, exclude = rules.exclude, ...others } = given;
  for (const name of paths) delete others[name];
  return {
    ...own,
    ...(borders !== undefined && { borders }),
    ...(compress !== undefined && { compress }),
    rules: { preset, keep, exclude, single: { ...rules.single, ...others } },
  } as Partial<TransferCommand> & { target: string };
}

/** Fills in a job's own names. `{name}` in a path is the target's name without its ending, `{dir}` its folder. */
function jobOf(given: JobDefaults & { target: string }): Job {
  const { target, cage, output, report, texture } = given;
  if (cage === undefined)
    throw new InputError('has no cage; give one with --cage, or as "cage" in the manifest').in(target);
  const fill = (path: string | undefined) =>
    path?.replaceAll('{name}', basename(target, extname(target))).replaceAll('{dir}', dirname(target));
  const command: TransferCommand = { ...given, cage, output: fill(output), report: fill(report) };
  const read = [target, cage, texture].map((path) => {
    const found = path === undefined ? undefined : statSync(path, { throwIfNoEntry: false });
    return [found?.size, found?.mtimeMs];
  });
  const key = createHash('sha256')
    .update(JSON.stringify([command, read]))
    .digest('hex')
    .slice(0, 16);
  return { command, key };
}

/** @throws {InputError} if two jobs write the same file, or one writes what another reads. */
function refuseClashes(jobs: Job[]): Job[] {
  const read = new Set(
    jobs.flatMap(({ command: { target, cage, texture } }) =>
      [target, cage, texture].flatMap((path) => (path === undefined ? [] : [placeOf(path)])),
    ),
  );
  const written = new Map<string, string>();
  for (const { command, error } of jobs) {
    for (const path of error === undefined ? [command.output, command.report] : []) {
      if (path === undefined) continue;
      const place = placeOf(path);
      const other = written.get(place);
      if (other !== undefined)
        throw new InputError(`is written for ${other} and ${command.target}; use {name} or {dir} in its path`).in(path);
      if (read.has(place)) throw new InputError('is read and written by this batch').in(path);
      written.set(place, command.target);
    }
  }
  return jobs;
}

/** Whether all that a job writes exists. */
export const isWritten = ({ command: { output, report } }: Job): boolean =>
  [output, report].every((path) => path === undefined || existsSync(path));
