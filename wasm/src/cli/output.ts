import { renameSync, rmSync, writeFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { InputError, firstLine } from '../gltf/input-error.js';

/**
 * Writes files, all of them or none: each under another name first, which it gives up once all are complete.
 * @throws {InputError} that names the file that cannot be written.
 */
export function writeFiles(files: readonly { path: string; data: Uint8Array | string }[]): void {
  const written: { path: string; temporary: string }[] = [];
  try {
    for (const { path, data } of files) {
      const temporary = join(dirname(path), `.${basename(path)}.${process.pid}.tmp`);
      written.push({ path, temporary });
      attempt(path, () => writeFileSync(temporary, data));
    }
    for (const { path, temporary } of written) attempt(path, () => renameSync(temporary, path));
  } finally {
    for (const { temporary } of written) rmSync(temporary, { force: true });
  }
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
