import { realpathSync, renameSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import { InputError, firstLine } from '../gltf/input-error.js';

/**
 * Writes files, all of them or none: each under another name first, which it gives up once all are complete. Links lead to
 * the file that is replaced; what is no file, as a pipe or /dev/null, is written to as it is.
 * @throws {InputError} that names the file that cannot be written.
 */
export function writeFiles(files: readonly { path: string; data: Uint8Array | string }[]): void {
  const written: { path: string; temporary: string }[] = [];
  try {
    for (const { path, data } of files.filter(({ path }) => !isStream(path))) {
      const place = placeOf(path);
      const temporary = join(dirname(place), `.${basename(place)}.${process.pid}.tmp`);
      written.push({ path, temporary });
      attempt(path, () => writeFileSync(temporary, data));
    }
    for (const { path, data } of files.filter(({ path }) => isStream(path))) attempt(path, () => writeFileSync(path, data));
    for (const { path, temporary } of written) attempt(path, () => renameSync(temporary, placeOf(path)));
  } finally {
    for (const { temporary } of written) rmSync(temporary, { force: true });
  }
}

/** The file that a path leads to, behind links; where there is none yet, the path itself, from the root. */
export function placeOf(path: string): string {
  try {
    return realpathSync(path);
  } catch {
    return resolve(path);
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
    const reason = code === 'ENOENT' ? 'its folder does not exist' : code === 'EISDIR' ? 'is a folder' : firstLine(error);
    throw new InputError(`cannot be written (${reason})`, { cause: error }).in(path);
  }
}
