import { chmodSync, lstatSync, readlinkSync, realpathSync, renameSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import { firstLine, InputError } from '../gltf/input-error.js';

/**
 * Writes files, all of them or none: each under another name first, which it gives up once all are complete. Links lead to
 * the file that is replaced, also where there is none yet; a file that is replaced keeps its permissions. What is no file, as
 * a pipe or /dev/null, is written to as it is.
 * @throws {InputError} that names the file that cannot be written.
 */
export function writeFiles(files: readonly { path: string; data: Uint8Array | string }[]): void {
  const written: { path: string; temporary: string }[] = [];
  try {
    for (const { path, data } of files.filter(({ path }) => !isStream(path))) {
      const place = placeOf(path);
      const temporary = join(dirname(place), `.${basename(place)}.${process.pid}.tmp`);
      written.push({ path, temporary });
      attempt(path, () => writeAs(place, temporary, data));
    }
    for (const { path, data } of files.filter(({ path }) => isStream(path)))
      attempt(path, () => writeFileSync(path, data));
    for (const { path, temporary } of written) attempt(path, () => renameSync(temporary, placeOf(path)));
  } finally {
    for (const { temporary } of written) rmSync(temporary, { force: true });
  }
}

/** Writes what is to replace a file, if that is there, under another name. */
function writeAs(place: string, temporary: string, data: Uint8Array | string): void {
  const before = statSync(place, { throwIfNoEntry: false });
  if (before?.isDirectory()) throw Object.assign(new Error('is a folder'), { code: 'EISDIR' });
  const mode = before && before.mode & 0o777;
  writeFileSync(temporary, data, { mode: mode ?? 0o666 });
  if (mode !== undefined) chmodSync(temporary, mode); // whatever the process leaves out of those that it makes
}

/** The file that a path leads to, behind links, from the root; there may be none yet. @param links  That may still be followed. */
export function placeOf(path: string, links = 40): string {
  try {
    return realpathSync(path);
  } catch {
    const place = resolve(path);
    const folder = dirname(place);
    if (links === 0 || folder === place) return place;
    if (lstatSync(place, { throwIfNoEntry: false })?.isSymbolicLink())
      return placeOf(resolve(realpathSync(folder), readlinkSync(place)), links - 1);
    return join(placeOf(folder, links), basename(place));
  }
}

/** Whether a path is of something that is no file and no folder: replacing it would do harm far beyond this command. */
function isStream(path: string): boolean {
  const found = statSync(path, { throwIfNoEntry: false });
  return found !== undefined && !found.isFile() && !found.isDirectory();
}

function attempt(path: string, write: () => void): void {
  try {
    write();
  } catch (error) {
    const { code } = error as NodeJS.ErrnoException;
    const reason =
      code === 'ENOENT' ? 'its folder does not exist' : code === 'EISDIR' ? 'is a folder' : firstLine(error);
    throw new InputError(`cannot be written (${reason})`, { cause: error }).in(path);
  }
}
