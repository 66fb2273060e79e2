import { createHash } from 'node:crypto';
import { existsSync, statSync } from 'node:fs';
import { basename, dirname, extname, resolve } from 'node:path';
import { readBytes, standard } from '../gltf/files.js';
import { firstLine, InputError, withName } from '../gltf/input-error.js';
import { filesBeside, filesReadBy } from './beside.js';
import type { ResolvedSettings } from './config/config-flags.js';
import {
  isObject,
  mergeMasks,
  parseObject,
  pathOf,
  refuseUnknown,
  settingNames,
  settingsOf,
  shown,
} from './config/settings.js';
import { filesOf } from './glob.js';
import { defaultRules } from './options.js';
import { canonicalPath } from './output.js';
import { areBounds, boundsText } from './paint/cage-area.js';
import { boundsFault } from './paint/read-paint.js';
import { autoCage } from './run.js';
import type { Region, TransferCommand } from './transfer/command.js';
import { UsageError } from './usage.js';

/** A transfer of a batch. */
export interface Job {
  command: TransferCommand;
  /** Identifies the job: its arguments, and the size and time of what it reads. */
  key: string;
  /** Why it cannot be started, if so. */
  error?: string;
}

/** What jobs have in common, from the command line and configuration files. */
interface JobDefaults extends Omit<TransferCommand, 'target' | 'cage' | keyof ResolvedSettings> {
  cage?: string | undefined;
  /** Where the batch writes its results, if in a file. */
  results?: string | undefined;
  settingsFor: (target: string) => Promise<ResolvedSettings>;
  /** Whether a flag asks for cut borders. */
  cuts: boolean;
}

/** The jobs for the files that patterns name. @throws {InputError} for a pattern without files, or if two jobs write the same file. */
export async function jobsOfPatterns(patterns: readonly string[], defaults: JobDefaults): Promise<Job[]> {
  const targets = patterns.flatMap((pattern) => {
    const found = filesOf(pattern);
    if (found.length === 0) throw new InputError('no file has such a name').in(pattern);
    return found;
  });
  return refuseClashes(
    await Promise.all(
      [...new Set(targets)].map(async (target) => {
        try {
          return jobOf({ ...defaults, target, ...(await defaults.settingsFor(target)) });
        } catch (error) {
          return failedJob(target, target, defaults, error);
        }
      }),
    ),
    defaults,
  );
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
    throw withName(error, path);
  }
  const folder = path === standard ? '.' : dirname(path);
  const lines = text.split('\n').map((line, i) => ({ line: line.trim(), place: `line ${i + 1} of ${path}` }));
  return refuseClashes(
    await Promise.all(
      lines
        .filter(({ line }) => line !== '')
        .map(async ({ line, place }) => {
          try {
            return jobOf({ ...defaults, ...(await jobLine(line, folder, defaults)) });
          } catch (error) {
            return failedJob(targetOf(line, folder) ?? place, place, defaults, error);
          }
        }),
    ),
    defaults,
    path,
  );
}

/** A job that cannot be started. @param place  What its error is about. */
function failedJob(target: string, place: string, { reading }: JobDefaults, error: unknown): Job {
  const text = firstLine(error);
  const message = text.startsWith(place) ? text : `${place}: ${text}`;
  return { command: { target, cage: '', reading, ...noSettings }, key: `${place} failed`, error: message };
}

/** The target that a line names, which may be wrong otherwise. */
function targetOf(line: string, folder: string): string | undefined {
  try {
    const { target } = parseObject(line);
    return typeof target === 'string' && target !== '' ? resolve(folder, target) : undefined;
  } catch {
    return undefined;
  }
}

const paths = ['target', 'cage', 'referenceCage', 'texture', 'output', 'report'] as const;

/** Stands for those of a job that cannot be started. */
const noSettings: ResolvedSettings = {
  rules: defaultRules,
  borders: 'triangle',
  compress: 'keep',
};

/** A line of a manifest: its settings win over flags. @throws {InputError} that names the member. */
async function jobLine(
  line: string,
  folder: string,
  { settingsFor, output, cuts }: JobDefaults,
): Promise<JobNames & ResolvedSettings> {
  const given = parseObject(line);
  refuseUnknown(given, [...paths, 'regions', 'uvBounds', ...settingNames]);
  if (given['target'] === undefined) throw new InputError('has no "target"');
  const { uvBounds, regions } = given;
  if (uvBounds !== undefined && !areBounds(uvBounds))
    throw new InputError(`"uvBounds" is ${shown(uvBounds)}, not an array of ${boundsText}`);
  const fault = placeholderFault(given['output'], given['report']);
  if (fault !== undefined) throw new InputError(fault);
  const own = Object.fromEntries([
    ...paths.flatMap((name) => {
      const path = pathIn(given, name, folder);
      return path === undefined ? [] : [[name, path]];
    }),
    ...(uvBounds === undefined ? [] : [['uvBounds', uvBounds]]),
    ...(regions === undefined ? [] : [['regions', regionsOf(regions, folder)]]),
  ]) as Partial<JobNames> & { target: string };
  const common = await settingsFor(own.target);
  const { borders, compress, preset, keep, exclude, masks, single } = settingsOf(given, folder);
  // A configuration may say so for other commands.
  if ((borders ? borders === 'cut' : cuts) && (own.output ?? output) === undefined) throw noOutput(own.target);
  const { rules } = common;
  return {
    ...own,
    borders: borders ?? common.borders,
    compress: compress ?? common.compress,
    rules: {
      ...rules,
      preset: preset ?? rules.preset,
      keep: keep ?? rules.keep,
      exclude: exclude ?? rules.exclude,
      ranks: {
        keep: keep ? keep.map(() => 1) : (rules.ranks?.keep ?? []),
        exclude: exclude ? exclude.map(() => 1) : (rules.ranks?.exclude ?? []),
      },
      ...(masks && {
        masks: mergeMasks(rules.masks, masks)!,
        configMasks: (rules.configMasks ?? []).filter((kind) => masks[kind] === undefined),
      }),
      single: { ...rules.single, ...single },
    },
  };
}

/** A path of a line, which may be that of no file but of a cage to be made. @throws {InputError} that names the member. */
const pathIn = (given: Readonly<Record<string, unknown>>, name: string, folder: string): string | undefined =>
  name === 'cage' && given[name] === autoCage ? autoCage : pathOf(given, name, folder);

/** @throws {InputError} that names the member, and of which region it is. */
function regionsOf(regions: unknown, folder: string): Region[] {
  const form = '{"cage": …, "texture": …}';
  if (!Array.isArray(regions)) throw new InputError(`"regions" is ${shown(regions)}, not an array of ${form}`);
  return regions.map((region: unknown, r) => {
    try {
      if (!isObject(region)) throw new InputError(`is ${shown(region)}, not ${form}`);
      const [cage, texture] = ['cage', 'texture'].map((name) => {
        const path = pathIn(region, name, folder);
        if (path === undefined) throw new InputError(`has no "${name}"`);
        return path;
      });
      return { cage: cage!, texture: texture! };
    } catch (error) {
      throw withName(error, `regions[${r}]`);
    }
  });
}

type JobNames = Pick<TransferCommand, 'target' | 'referenceCage' | 'texture' | 'regions' | 'output' | 'report'> & {
  cage?: string | undefined;
};

const noOutput = (target: string): InputError =>
  new InputError('has no output, where its texture or its cut target would be written').in(target);

/** What is wrong with the placeholders in the paths of what a job writes, if anything is. */
export function placeholderFault(...written: readonly unknown[]): string | undefined {
  const found = written.flatMap((path) => (typeof path === 'string' ? (path.match(/\{\w+\}/g) ?? []) : []));
  const unknown = found.find((one) => !['{name}', '{dir}'].includes(one));
  return unknown && `${unknown} is unknown; paths may hold {name} and {dir}`;
}

/** Fills in a job's own names. `{name}` in a path is the target's name without its ending, `{dir}` its folder. */
function jobOf({ settingsFor: _, results: __, cuts: ___, ...given }: JobDefaults & JobNames & ResolvedSettings): Job {
  const { target, cage, output, report } = given;
  if (cage === undefined)
    throw new InputError('has no cage; give one with --cage, or as "cage" in the manifest').in(target);
  // In one pass and by a function: names may hold `{dir}`, or `$&`.
  const fill = (path: string | undefined) =>
    path?.replace(/\{name\}|\{dir\}/g, (found) =>
      found === '{dir}' ? dirname(target) : basename(target, extname(target)),
    );
  if (output === undefined && (given.texture !== undefined || given.regions?.length)) throw noOutput(target);
  if (output !== undefined && !/\.(glb|vrm|gltf)$/i.test(output))
    throw new InputError(`its output ${output} does not end in .glb, .vrm or .gltf`).in(target);
  const fault = boundsFault(given.texture, given.uvBounds);
  if (fault !== undefined) throw new InputError(fault).in(target);
  const command: TransferCommand = { ...given, cage, output: fill(output), report: fill(report) };
  const read = filesReadBy(command).map(sizeAndTime);
  const key = createHash('sha256')
    .update(JSON.stringify([command, read]))
    .digest('hex')
    .slice(0, 16);
  return { command, key };
}

/** Of a file; neither if it cannot be looked up, which whatever opens it reports. */
function sizeAndTime(path: string): (number | undefined)[] {
  try {
    const { size, mtimeMs } = statSync(path);
    return [size, mtimeMs];
  } catch {
    return [undefined, undefined];
  }
}

/**
 * @throws {UsageError} if a file is written twice, or a job writes what another reads, or what the batch itself reads and writes.
 */
function refuseClashes(jobs: Job[], { results }: JobDefaults, manifest?: string): Job[] {
  const named = (path: string | undefined) => (path === undefined || path === standard ? [] : [path]);
  const readByJob = ({ command }: Job) => [...filesReadBy(command), ...named(command.rules.config)];
  const read = new Set([...jobs.flatMap(readByJob), ...named(manifest)].map((path) => canonicalPath(path)));
  // What a `.gltf` has beside it is named after it.
  const kBeside = /(\.bin|-image\d+\.\w+)$/;
  const readBeside = new Set(
    [...read].filter((real) => kBeside.test(real)).map((real) => real.replace(kBeside, '.gltf')),
  );
  const refuse = (path: string, reason: string): never => {
    throw new UsageError(`${path}: ${reason}`);
  };
  const written = new Map<string, Job | 'the results'>();
  if (results !== undefined) {
    if (read.has(canonicalPath(results))) refuse(results, 'is read by this batch; choose another file for results');
    written.set(canonicalPath(results), 'the results');
  }
  for (const job of jobs.filter(({ error }) => error === undefined)) {
    const { target, output, report } = job.command;
    const buffer = output !== undefined && /\.gltf$/i.test(output) ? output.replace(/\w+$/, 'bin') : undefined;
    for (const path of [output, buffer, report]) {
      if (path === undefined) continue;
      const real = canonicalPath(path);
      const other = written.get(real);
      if (other === job) refuse(path, `is both output and report of ${target}; choose another file for one of them`);
      if (other !== undefined) {
        const whose = typeof other === 'string' ? other : other.command.target;
        refuse(path, `is written for ${whose} and ${target}; use {name} or {dir} in its path`);
      }
      if (path === output && readBeside.has(real))
        refuse(path, 'is written beside a file of its name that this batch reads');
      if (read.has(real)) refuse(path, 'is read and written by this batch');
      written.set(real, job);
    }
  }
  return jobs;
}

/** The files that a job writes, as they are named. */
export const writtenBy = ({ command: { output, report } }: Job): string[] =>
  [output, report].filter((path) => path !== undefined);

/** Whether all that a job writes exists, with what a glTF has beside it. */
export const isWritten = (job: Job): boolean =>
  writtenBy(job).every((path) => [path, ...filesBeside(path)].every((file) => existsSync(file)));
