import { randomBytes } from 'node:crypto';
import {
  accessSync,
  closeSync,
  constants,
  fchmodSync,
  fstatSync,
  lstatSync,
  mkdirSync,
  openSync,
  readlinkSync,
  realpathSync,
  renameSync,
  rmSync,
  type Stats,
  statSync,
  writeFileSync,
} from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import { isatty } from 'node:tty';
import { firstLine, InputError } from '../../scene/input-error.js';
import { reasons, UsageError } from '../model/failures.js';
import { standard } from './files.js';
import type { Io } from './io.js';

/**
 * Writes all of the files or none: each is first written under a temporary name, and renamed once all are complete, the first one
 * last, as it may refer to the others. Symbolic links are followed, even to files that do not exist yet; a replaced file keeps its
 * permissions. Pipes, devices such as /dev/null and descriptors such as /dev/stdout are written to directly, the standard output
 * for `-`.
 * @throws {InputError} that names the file that cannot be written.
 */
export function writeFiles(files: readonly { path: string; data: Uint8Array | string }[], io: Io): void {
  const written: { path: string; temporary: string }[] = [];
  try {
    for (const { path, data } of files.filter(({ path }) => streamOf(path) === undefined)) {
      const real = canonicalPath(path);
      const temporary = temporaryPath(real);
      // Exclusively: nobody else has the name, and no link that was planted there is followed.
      const file = writing(path, () => openSync(temporary, 'wx'));
      written.push({ path, temporary });
      writing(path, () => writeAs(real, file, data));
    }
    for (const { path, data } of files) {
      const stream = streamOf(path);
      if (stream === standard) io.out(data);
      else if (stream !== undefined) writing(path, () => writeFileSync(stream, data));
    }
    for (const { path, temporary } of written.reverse())
      writing(path, () => renameSync(temporary, canonicalPath(path)));
  } finally {
    for (const { temporary } of written) rmSync(temporary, { force: true });
  }
}

/**
 * Finds, before a command begins, the reasons why it could not write: a file is read-only, an input, or another output.
 * @throws {UsageError} if an output is an input or another output, or two of either are the standard one.
 * @throws {InputError} that names the file that cannot be written.
 */
export function checkOutputs(inputs: readonly (string | undefined)[], outputs: readonly (string | undefined)[]): void {
  for (const [paths, name] of [
    [inputs, 'input'],
    [outputs, 'output'],
  ] as const)
    if (paths.filter((path) => path === standard).length > 1)
      throw new UsageError(`only one file can be the standard ${name}`);
  refuseOverwriting(inputs, outputs);
  for (const path of outputs) {
    if (path === undefined || streamOf(path) !== undefined) continue;
    writing(path, () => {
      refuseFolder(path);
      accessSync(`${dirname(canonicalPath(path))}/.`, constants.W_OK);
    });
  }
}

/** @throws {UsageError} if an output is an input or another output. */
export function refuseOverwriting(
  inputs: readonly (string | undefined)[],
  outputs: readonly (string | undefined)[],
): void {
  const known = new Map<string, string>();
  const take = (path: string | undefined, use: string, mayBeKnown: boolean) => {
    if (path === undefined || path === standard) return;
    const real = canonicalPath(path);
    const other = known.get(real);
    if (other !== undefined && !mayBeKnown)
      throw new UsageError(`${path} would overwrite ${other}; choose another output`);
    known.set(real, `${path}, which this command ${use}`);
  };
  for (const path of inputs) take(path, 'reads', true);
  for (const path of outputs) take(path, 'writes', false);
}

/**
 * Writes to the standard output of the process.
 * @throws {InputError} if it is a file or a device that does not take all of it. Errors of pipes are events of `process.stdout`.
 */
export function writeStandard(data: Uint8Array | string): void {
  if (isatty(1) || isPipe(fstatSync(1))) process.stdout.write(data);
  // Node's stream for files loses without an error what the disk has no room for.
  else writing('the standard output', () => writeFileSync(1, data));
}

const isPipe = (found: Stats): boolean => found.isFIFO() || found.isSocket();

/** Makes the folder of a file that is to be written: with `{name}` and `{dir}` in paths there may be many. */
export function makeFolder(path: string): void {
  try {
    mkdirSync(dirname(path), { recursive: true });
  } catch {
    // What writes the file says what is wrong.
  }
}

/** Characters of a file's name that its temporary one begins with: with the rest, it stays a name that systems allow. */
const kNameLength = 50;

/** A name beside a file that nobody can foresee. */
const temporaryPath = (path: string): string =>
  join(dirname(path), `${temporaryPrefix(path)}${randomBytes(8).toString('hex')}.tmp`);

const temporaryPrefix = (path: string): string => `.${[...basename(path)].slice(0, kNameLength).join('')}.`;

/** Whether a name is a temporary one of a file. */
export const isTemporary = (name: string, path: string): boolean =>
  name.startsWith(temporaryPrefix(path)) && /^[0-9a-f]{16}\.tmp$/.test(name.slice(temporaryPrefix(path).length));

/** Writes to a file that is open under its temporary name, with the permissions of the one that it will replace, if there is one. */
function writeAs(path: string, file: number, data: Uint8Array | string): void {
  try {
    const before = refuseFolder(path);
    if (before) fchmodSync(file, before.mode & 0o777); // before anybody could read what is in it
    writeFileSync(file, data);
  } finally {
    closeSync(file);
  }
}

/** What is known of a file, if it exists. A folder is no file that could be replaced. */
function refuseFolder(path: string): Stats | undefined {
  const found = statSync(path, { throwIfNoEntry: false });
  if (found?.isDirectory()) throw Object.assign(new Error('is a folder'), { code: 'EISDIR' });
  return found;
}

/** The absolute path of a file, with symbolic links resolved; the file need not exist. @param links  How many links may still be followed. */
export function canonicalPath(path: string, links = 40): string {
  try {
    return realpathSync(path);
  } catch {
    const absolute = resolve(path);
    const folder = dirname(absolute);
    if (links === 0 || folder === absolute) return absolute;
    if (isLink(absolute)) return canonicalPath(resolve(realpathSync(folder), readlinkSync(absolute)), links - 1);
    return join(canonicalPath(folder, links), basename(absolute));
  }
}

/** Whether a path is a link; not if it cannot be looked up, which whatever opens it reports. */
function isLink(path: string): boolean {
  try {
    return lstatSync(path).isSymbolicLink();
  } catch {
    return false;
  }
}

/** What is to be written to, not replaced: a pipe or a device, by its path, or a file that is open, by its descriptor. */
function streamOf(path: string): string | number | undefined {
  if (path === standard) return standard;
  const found = writing(path, () => statSync(path, { throwIfNoEntry: false }));
  return found && !found.isFile() && !found.isDirectory() ? path : descriptorOf(path);
}

/** The descriptor that a path such as /dev/stdout leads to. @param links  How many links may still be followed. */
function descriptorOf(path: string, links = 40): number | undefined {
  const absolute = join(canonicalPath(dirname(path)), basename(path));
  const number = [`/proc/${process.pid}/fd`, '/dev/fd'].includes(dirname(absolute))
    ? Number(basename(absolute))
    : Number.NaN;
  if (Number.isInteger(number)) return number;
  return links > 0 && isLink(absolute)
    ? descriptorOf(resolve(dirname(absolute), readlinkSync(absolute)), links - 1)
    : undefined;
}

/** Errors of the system that mean something else than in reading. */
const writingReasons: Readonly<Record<string, string>> = {
  ENOENT: 'its folder does not exist',
  ENOTDIR: 'its folder is a file',
  EISDIR: 'is a folder',
  EACCES: 'permission denied',
};

/** Does what writes a file. @throws {InputError} that names it. */
export function writing<Result>(path: string, write: () => Result): Result {
  try {
    return write();
  } catch (error) {
    const { code } = error as NodeJS.ErrnoException;
    const reason = { ...reasons, ...writingReasons }[code ?? ''];
    throw new InputError(`cannot be written (${reason ?? firstLine(error)})`, { cause: error }).in(path);
  }
}
