import { createHash } from 'node:crypto';
import { existsSync, readFileSync, statSync } from 'node:fs';
import { basename, dirname, extname } from 'node:path';
import { firstLine, InputError, naming } from '../../scene/input-error.js';
import { isUvSetChoice, uvSetText } from '../../scene/uv-sets.js';
import { filesBeside } from '../io/beside.js';
import { readBytes, standard } from '../io/files.js';
import { filesOf } from '../io/glob.js';
import { canonicalPath } from '../io/output.js';
import { UsageError } from '../model/failures.js';
import { isObject, type Json, parseObject, pathOf, refuseUnknown } from '../model/json.js';
import { kSettingNames, type Layer, type ResolvedSettings, resolveSettings, settingsOf } from '../model/settings.js';
import { kAutoCage, type Region, type TransferCommand } from '../model/sources.js';
import { shown } from '../model/text.js';
import { areBounds, boundsFault, boundsText } from '../model/uv-bounds.js';
import { filesReadBy } from '../transfer/files-read.js';
import { isKnownTemplate } from '../transfer/template.js';
import { aroundOf } from './common-flags.js';

/** A transfer of a batch. */
export interface Job {
  command: TransferCommand;
  /** The files that it reads. */
  reads: readonly string[];
  /** Identifies the job: its arguments, and the size and time of what it reads. */
  key: string;
  /** Why it cannot be started, if so. */
  error?: string;
}

/** What jobs have in common. */
interface JobDefaults extends Omit<TransferCommand, 'target' | 'cage' | keyof ResolvedSettings> {
  cage?: string | undefined;
  /** Where the batch writes its results, if in a file. */
  results?: string | undefined;
  /** The settings of a target, from configuration files and flags. */
  layersFor: (target: string) => Promise<Layer[]>;
}

/**
 * The jobs for the files that patterns name, without the cages among them.
 * @throws {InputError} for a pattern without files, or if two jobs write the same file.
 */
export async function jobsOfPatterns(
  patterns: readonly string[],
  defaults: JobDefaults,
): Promise<{ jobs: Job[]; leftOut: string[] }> {
  const leftOut = new Set<string>();
  const cages = [defaults.cage, defaults.referenceCage, ...(defaults.regions ?? []).map(({ cage }) => cage)];
  const isCage = (target: string) => cages.some((cage) => cage !== undefined && isSameFile(target, cage));
  const targets = patterns.flatMap((pattern) => {
    const found = filesOf(pattern);
    // One that is named itself is meant.
    const [own, others] = pattern.includes('*')
      ? [found.filter((one) => !isCage(one)), found.filter(isCage)]
      : [found, []];
    for (const cage of others) leftOut.add(cage);
    if (own.length === 0)
      throw new InputError(`no file${others.length > 0 ? ' but a cage' : ''} has such a name`).in(pattern);
    return own;
  });
  const jobs = [...new Set(targets)].map((target) =>
    orFailed(target, target, defaults, async () => jobOf({ ...defaults, target }, await defaults.layersFor(target))),
  );
  return { jobs: refuseClashes(await Promise.all(jobs), defaults), leftOut: [...leftOut] };
}

/** Whether two paths lead to one file, or to files of the same content. */
function isSameFile(a: string, b: string): boolean {
  if (canonicalPath(a) === canonicalPath(b)) return true;
  const size = sizeAndTime(a)[0];
  try {
    return !!size && size === sizeAndTime(b)[0] && readFileSync(a).equals(readFileSync(b));
  } catch {
    return false; // The job that reads it says what is wrong.
  }
}

/**
 * The jobs of a manifest: a JSON object per line, with paths relative to the manifest. A line that is wrong becomes a job that fails.
 * @throws {InputError} if the manifest cannot be read, or two jobs write the same file.
 */
export async function jobsOfManifest(path: string, defaults: JobDefaults): Promise<Job[]> {
  const bytes = await naming(path, () => readBytes(path));
  const folder = path === standard ? '.' : dirname(path);
  const lines = new TextDecoder().decode(bytes).split('\n');
  const jobs = lines.flatMap((line, i) => {
    if (line.trim() === '') return [];
    const place = `line ${i + 1} of ${path}`;
    return orFailed(targetOf(line, folder) ?? place, place, defaults, () => jobOfLine(line, folder, defaults));
  });
  if (jobs.length === 0) throw new InputError('has no jobs: each line is one, as a JSON object').in(path);
  return refuseClashes(await Promise.all(jobs), defaults, path);
}

/** A job, or one that fails if it cannot be started. @param place  What its error is about. */
async function orFailed(
  target: string,
  place: string,
  { reading }: JobDefaults,
  start: () => Promise<Job>,
): Promise<Job> {
  try {
    return await start();
  } catch (error) {
    const command = { target, cage: '', reading, ...resolveSettings([]) };
    return { command, reads: [target], key: `${place} failed`, error: `${place}: ${firstLine(error)}` };
  }
}

/** The target that a line names, which may be wrong otherwise. */
function targetOf(line: string, folder: string): string | undefined {
  try {
    return pathOf(parseObject(line), 'target', folder);
  } catch {
    return undefined;
  }
}

const kPaths = ['target', 'cage', 'template', 'referenceCage', 'texture', 'output', 'report'] as const;

/** The job of a line of a manifest: its settings win over flags. @throws {InputError} that names the member. */
async function jobOfLine(line: string, folder: string, defaults: JobDefaults): Promise<Job> {
  const given = parseObject(line);
  refuseUnknown(given, [...kPaths, 'regions', 'cageUvs', 'uvBounds', ...kSettingNames]);
  const names = kPaths.map((name) => [name, pathIn(given, name, folder)] as const);
  const own = Object.fromEntries(names.filter(([, path]) => path !== undefined));
  const { target } = own;
  if (target === undefined) throw new InputError('has no "target"');
  const { cageUvs = defaults.cageUvs, uvBounds = defaults.uvBounds, regions } = given;
  if (cageUvs !== undefined && !isUvSetChoice(cageUvs))
    throw new InputError(`"cageUvs" is ${shown(cageUvs)}, not ${uvSetText}`);
  if (uvBounds !== undefined && !areBounds(uvBounds))
    throw new InputError(`"uvBounds" is ${shown(uvBounds)}, not an array of ${boundsText}`);
  const around = (own['cage'] ?? own['template']) ? { cage: undefined, template: undefined } : {};
  return jobOf(
    {
      ...defaults,
      ...around,
      ...own,
      target,
      cageUvs,
      uvBounds,
      ...(regions !== undefined && { regions: regionsOf(regions, folder) }),
    },
    [...(await defaults.layersFor(target)), { settings: settingsOf(given, folder) }],
  );
}

/** A path of a line, or a word for a cage. @throws {InputError} with the member's name. */
const pathIn = (given: Json, name: string, folder: string): string | undefined =>
  (name === 'cage' && given[name] === kAutoCage) || (name === 'template' && isKnownTemplate(given[name]))
    ? (given[name] as string)
    : pathOf(given, name, folder);

/** @throws {InputError} that names the member, and of which region it is. */
function regionsOf(regions: unknown, folder: string): Region[] {
  const form = '{"cage": …, "texture": …}';
  if (!Array.isArray(regions)) throw new InputError(`"regions" is ${shown(regions)}, not an array of ${form}`);
  return regions.map((region: unknown, r) =>
    naming(`regions[${r}]`, () => {
      if (!isObject(region)) throw new InputError(`is ${shown(region)}, not ${form}`);
      const [cage, texture] = ['cage', 'texture'].map((name) => {
        const path = pathIn(region, name, folder);
        if (path === undefined) throw new InputError(`has no "${name}"`);
        return path;
      });
      return { cage: cage!, texture: texture! };
    }),
  );
}

/** What is wrong with the placeholders in the paths of what a job writes, if anything is. */
export function placeholderFault(...written: readonly (string | undefined)[]): string | undefined {
  const found = written.flatMap((path) => path?.match(/\{\w+\}/g) ?? []);
  const unknown = found.find((one) => !['{name}', '{dir}'].includes(one));
  return unknown && `${unknown} is unknown; paths may hold {name} and {dir}`;
}

/** A path for a target, with the name of its file and its folder in the placeholders. */
export const filledFor = (target: string, path: string): string =>
  // In one pass and by a function: names may hold `{dir}`, or `$&`.
  path.replace(/\{name\}|\{dir\}/g, (found) => (found === '{dir}' ? dirname(target) : nameOf(target)));

/** The name of a file without its ending. That of `...glb` is whole: `..` would lead to another folder. */
function nameOf(path: string): string {
  const name = basename(path, extname(path));
  return /^\.*$/.test(name) ? basename(path) : name;
}

/** @throws {InputError} if something is missing or wrong. */
function jobOf({ layersFor: _, results: __, ...given }: JobDefaults & { target: string }, layers: Layer[]): Job {
  const { target, texture, regions = [], output, report } = given;
  // A configuration may say so for other commands.
  const cuts = resolveSettings(layers.filter(({ config }) => config === undefined)).borders === 'cut';
  if (output === undefined && (cuts || texture !== undefined || regions.length > 0))
    throw new InputError('has no output, where its texture or its cut target would be written');
  if (output !== undefined && !/\.(glb|vrm|gltf)$/i.test(output))
    throw new InputError(`its output ${output} does not end in .glb, .vrm or .gltf`);
  const fault = placeholderFault(output, report) ?? boundsFault(texture, given.uvBounds);
  if (fault !== undefined) throw new InputError(fault);
  const command = {
    ...given,
    ...aroundOf(given, target),
    output: output && filledFor(target, output),
    report: report && filledFor(target, report),
    ...resolveSettings(layers),
  };
  const reads = filesReadBy(command);
  const identity = JSON.stringify([command, reads.map(sizeAndTime)]);
  const key = createHash('sha256').update(identity).digest('hex').slice(0, 16);
  const { config } = command.rules;
  return { command, reads: config === undefined ? reads : [...reads, config], key };
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
  const allRead = [...jobs.flatMap(({ reads }) => reads), ...(manifest && manifest !== standard ? [manifest] : [])];
  const read = new Set(allRead.map((path) => canonicalPath(path)));
  // What a `.gltf` has beside it is named after it.
  const kBeside = /(\.bin|-image\d+\.\w+)$/;
  const withBeside = new Set(
    [...read].filter((path) => kBeside.test(path)).map((path) => path.replace(kBeside, '.gltf')),
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
    const { target, output } = job.command;
    const buffer = output && /\.gltf$/i.test(output) ? [output.replace(/gltf$/i, 'bin')] : [];
    for (const path of [...writtenBy(job), ...buffer]) {
      const real = canonicalPath(path);
      const other = written.get(real);
      if (other === job) refuse(path, `is both output and report of ${target}; choose another file for one of them`);
      if (other !== undefined) {
        const whose = typeof other === 'string' ? other : other.command.target;
        refuse(path, `is written for ${whose} and ${target}; use {name} or {dir} in its path`);
      }
      if (path === output && withBeside.has(real))
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
