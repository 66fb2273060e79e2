import { constants, existsSync } from 'node:fs';
import { type FileHandle, open, readdir, realpath, stat } from 'node:fs/promises';
import { basename, dirname, isAbsolute, join, relative, resolve } from 'node:path';
import { checkBytes, defaultLimits, type ReadLimits } from '../../gltf/checks/read-limits.js';
import { decodedUri } from '../../gltf/data-uri.js';
import { firstLine, InputError } from '../../scene/input-error.js';
import { reasons } from '../model/failures.js';
import type { ReadOptions } from '../model/reading.js';

/** The name of the standard input and output. */
export const standard = '-';

/**
 * Reads a whole file or pipe, or the standard input for `-`.
 * @throws {InputError} with a message that does not name the file.
 */
export async function readBytes(path: string, limits: ReadLimits = defaultLimits): Promise<Uint8Array> {
  if (path === standard) return readStandardInput(limits);
  return withPlainErrors(async () => {
    const file = await open(path);
    try {
      const found = await file.stat();
      if (found.isCharacterDevice() || found.isBlockDevice()) throw new InputError('is a device, not a file');
      return await readAll(file, limits);
    } finally {
      await file.close();
    }
  });
}

/**
 * Reads a file that a glTF refers to: a regular one in its folder.
 * @throws {InputError} that begins with `name`.
 */
export async function readUri(name: string, uri: string, folder: string, options: ReadOptions): Promise<Uint8Array> {
  const path = localFile(uri, folder);
  if (path === undefined) throw new InputError(`${name} is at ${uri.slice(0, 60)}; only local files can be read`);
  try {
    return await readBeside(path, folder, options);
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    throw new InputError(`${name} is in ${uri.slice(0, 60)}: ${error.message}${await nearlyNamed(path)}`);
  }
}

/** A path whose file is named in this Unicode form or in another: a program may write names in one, and a disk keep them in another. */
async function asNamed(path: string): Promise<string> {
  const [folder, name] = [dirname(path), basename(path)];
  if (/^[\x20-\x7e]*$/.test(name) || existsSync(path)) return path;
  const names = await readdir(folder).catch((): string[] => []);
  const found = names.find((one) => one.normalize('NFC') === name.normalize('NFC'));
  return found === undefined ? path : join(folder, found);
}

/** The end of a message: which file has the name that is missing but for capitals, if one has. */
async function nearlyNamed(path: string): Promise<string> {
  const names = await readdir(dirname(path)).catch((): string[] => []);
  if (names.includes(basename(path))) return '';
  const found = names.find((name) => name.toLowerCase() === basename(path).toLowerCase());
  return found === undefined ? '' : `; there is ${found}`;
}

/**
 * Reads a regular file. What the path leads to must be in the folder, too, after links.
 * @throws {InputError} with a message that does not name the file.
 */
export function readBeside(path: string, folder: string, { limits, allowOutside }: ReadOptions): Promise<Uint8Array> {
  return withPlainErrors(async () => {
    const refuseOutside = (to: string, from: string) => {
      if (!allowOutside && isOutside(to, from))
        throw new InputError('is outside the folder of the file that refers to it; --allow-outside permits it');
    };
    refuseOutside(path, resolve(folder)); // before anything tells whether the file exists
    const own = await asNamed(path);
    refuseOutside(await realpath(own), await realpath(folder));
    // Without O_NONBLOCK, opening a pipe waits for somebody to write to it.
    const file = await open(own, constants.O_RDONLY | (constants.O_NONBLOCK ?? 0));
    try {
      const found = await file.stat();
      if (!found.isFile() && !found.isDirectory()) throw new InputError('is a device or a pipe, not a file');
      return await readAll(file, limits);
    } finally {
      await file.close();
    }
  });
}

/** Whether a path is not in a folder; links are not followed. */
export function isOutside(path: string, folder: string): boolean {
  const way = relative(folder, path);
  return way === '..' || /^\.\.[\\/]/.test(way) || isAbsolute(way);
}

async function readStandardInput(limits: ReadLimits): Promise<Uint8Array> {
  const chunks: Buffer[] = [];
  let length = 0;
  for await (const chunk of process.stdin as AsyncIterable<Buffer>) {
    chunks.push(chunk);
    length += chunk.length;
    checkBytes(length, limits);
  }
  return Buffer.concat(chunks);
}

const kChunkBytes = 2 ** 20;

/** Reads until the end. The size that the system tells is no promise: that of a pipe is 0. */
async function readAll(file: FileHandle, limits: ReadLimits): Promise<Uint8Array> {
  const { size } = await file.stat();
  checkBytes(size, limits);
  let bytes = Buffer.allocUnsafeSlow(size + 1); // one more, to see the end without another allocation
  let length = 0;
  for (;;) {
    if (length === bytes.length) {
      const larger = Buffer.allocUnsafeSlow(2 * length + kChunkBytes);
      larger.set(bytes);
      bytes = larger;
    }
    const { bytesRead } = await file.read(bytes, length, bytes.length - length);
    if (bytesRead === 0) return bytes.subarray(0, length);
    length += bytesRead;
    checkBytes(length, limits);
  }
}

/** Whether a path leads to a folder. @throws {InputError} if it leads nowhere. */
export async function isFolder(path: string): Promise<boolean> {
  return path !== standard && (await withPlainErrors(() => stat(path))).isDirectory();
}

/** Reads, and turns errors of the system into plain ones. */
async function withPlainErrors<Result>(read: () => Promise<Result>): Promise<Result> {
  try {
    return await read();
  } catch (error) {
    throw error instanceof InputError ? error : plain(error);
  }
}

/** An error of the system in plain words. */
function plain(error: unknown): InputError {
  const reason = reasons[(error as NodeJS.ErrnoException).code ?? ''];
  return new InputError(reason ?? `cannot be read (${firstLine(error)})`, { cause: error });
}

/** Why a folder cannot be listed, with its name. */
export const listingError = (error: unknown): InputError => plain(error).in((error as NodeJS.ErrnoException).path!);

/** The file that a glTF in a folder refers to, by slashes or backslashes; none for a data URI or an address in the network. */
export const localFile = (uri: string, folder: string): string | undefined =>
  /^[a-z][a-z0-9+.-]+:/i.test(uri) ? undefined : resolve(folder, decodedUri(uri).replaceAll('\\', '/'));
