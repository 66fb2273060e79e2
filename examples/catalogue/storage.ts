// Inputs and outputs: in a folder that all machines mount, or behind http(s), with S3-style signed URLs for GET and PUT.
import { createHash, randomUUID } from 'node:crypto';
import { constants } from 'node:fs';
import { type FileHandle, lstat, mkdir, open, readdir, realpath, rename, rm, writeFile } from 'node:fs/promises';
import { dirname, isAbsolute, join, relative, resolve } from 'node:path';
import { Failure, meaningOf, publicOf } from './failure.ts';
import { settings } from './settings.ts';
import type { Written } from './shape.ts';

const mostRedirects = 3;
const requestMs = 60_000;
const temporaryFolder = '.unfinished';

export const isUrl = (place: string): boolean => /^[a-z][a-z0-9+.-]+:/i.test(place);

/** A place without the signature of its URL: for logs, pages and results. */
export const shown = (place: string): string => publicOf(place);

export const hashOf = (bytes: Uint8Array): string => createHash('sha256').update(bytes).digest('hex');

/** The bytes of an input. @throws {Failure} */
export const read = (place: string): Promise<Uint8Array> => (isUrl(place) ? get(place) : readFile(place));

const tooLarge = (place: string) =>
  new Failure('limit', `${shown(place)} has more than ${settings.inputSize} MB (CATALOGUE_INPUT_SIZE)`);

/** Reads a regular file that is in the input folder, after links are followed. */
async function readFile(name: string): Promise<Uint8Array> {
  const path = resolve(settings.inputs, name);
  const refuseOutside = (from: string, to: string) => {
    const way = relative(from, to);
    if (way === '..' || /^\.\.[\\/]/.test(way) || isAbsolute(way))
      throw new Failure('refused', `${name} is outside the input folder`);
  };
  refuseOutside(settings.inputs, path);
  try {
    refuseOutside(await realpath(settings.inputs), await realpath(path));
    // Without O_NONBLOCK, opening a pipe waits for somebody to write to it.
    const file = await open(path, constants.O_RDONLY | constants.O_NONBLOCK);
    try {
      const found = await file.stat();
      if (!found.isFile()) throw new Failure('refused', `${name} is not a file`);
      if (found.size > settings.inputSize * 1e6) throw tooLarge(name);
      return await file.readFile();
    } finally {
      await file.close();
    }
  } catch (error) {
    if (error instanceof Failure) throw error;
    const { code = '' } = error as NodeJS.ErrnoException;
    // ESTALE and EIO are what a shared folder says when its server is away for a moment.
    throw new Failure(
      /^(ENOENT|ENOTDIR|EACCES|ELOOP)$/.test(code) ? 'missing' : 'network',
      `${name} ${meaningOf(error)}`,
    );
  }
}

/** @throws {Failure} unless the server is one of those that are allowed. */
function allowed(place: string): URL {
  const url = URL.canParse(place) ? new URL(place) : undefined;
  if (!url || !/^https?:$/.test(url.protocol) || !settings.hosts.includes(url.host))
    throw new Failure('refused', `${shown(place)}: its server is not in CATALOGUE_HOSTS`);
  if (url.username || url.password)
    throw new Failure('refused', `${shown(place)}: an address must not have a user or a password; sign it instead`);
  return url;
}

async function request(place: string, init: RequestInit): Promise<Response> {
  const url = allowed(place);
  try {
    return await fetch(url, { ...init, redirect: 'manual', signal: AbortSignal.timeout(requestMs) });
  } catch (error) {
    throw new Failure('network', `${shown(place)}: ${meaningOf(error)}`);
  }
}

/** What an answer of a server means. Busy servers and gateways get another chance. */
function checkStatus(place: string, { ok, status }: Response): void {
  if (ok) return;
  const passes = status >= 500 || status === 429 || status === 408;
  throw new Failure(passes ? 'network' : 'missing', `${shown(place)}: the server says ${status}`);
}

async function get(place: string): Promise<Uint8Array> {
  let at = place;
  for (let redirects = 0; ; ++redirects) {
    const response = await request(at, {});
    const next = response.status >= 300 && response.status < 400 ? response.headers.get('location') : null;
    if (next === null) {
      checkStatus(place, response);
      return body(place, response);
    }
    await response.body?.cancel();
    if (redirects === mostRedirects) throw new Failure('limit', `${shown(place)}: more than ${redirects} redirects`);
    if (!URL.canParse(next, at)) throw new Failure('missing', `${shown(place)}: is redirected to what is no address`);
    at = new URL(next, at).href;
  }
}

/** Reads no more than is allowed, whatever the server says of the length. */
async function body(place: string, response: Response): Promise<Uint8Array> {
  const chunks: Uint8Array[] = [];
  let length = 0;
  try {
    for await (const chunk of response.body ?? []) {
      length += chunk.length;
      if (length > settings.inputSize * 1e6) throw tooLarge(place);
      chunks.push(chunk);
    }
  } catch (error) {
    throw error instanceof Failure ? error : new Failure('network', `${shown(place)}: ${meaningOf(error)}`);
  }
  return Buffer.concat(chunks);
}

/**
 * The path of a name in the output folder. Its folders are folders: with links, it could be anywhere.
 * @param make  Whether folders are made that are not there.
 * @throws {Failure} `refused`; errors of the system if a folder is not there.
 */
async function pathOf(name: string, make = false): Promise<string> {
  const parts = name.split('/');
  if (parts.some((part) => /^\.{0,2}$|[\\\0]/.test(part)))
    throw new Failure('refused', `${name} is outside the output folder`);
  if (make) await mkdir(settings.outputs, { recursive: true });
  let path = await realpath(settings.outputs);
  for (const part of parts.slice(0, -1)) {
    path = join(path, part);
    if (make)
      await mkdir(path).catch((error) => {
        if (error.code !== 'EEXIST') throw error;
      });
    if (!(await lstat(path)).isDirectory())
      throw new Failure('refused', `${name}: "${part}" in the output folder is a link or a file; remove it`);
  }
  return join(path, parts.at(-1)!);
}

/** Opens a regular file of the output folder; no link leads out of it. @throws {Failure} `refused`; errors of the system */
export async function openOutput(name: string): Promise<FileHandle> {
  const file = await open(await pathOf(name), constants.O_RDONLY | constants.O_NOFOLLOW | constants.O_NONBLOCK);
  if ((await file.stat()).isFile()) return file;
  await file.close();
  throw new Failure('refused', `${name} is not a file`);
}

/** Whether an output is there, and is what was written. What is behind an address was there when its server said so. */
export async function isThere(written: Partial<Written>): Promise<boolean> {
  const { output, outputBytes, outputSha256, outputTime } = written;
  if (output === undefined || isUrl(output)) return true;
  let file: FileHandle | undefined;
  try {
    file = await openOutput(output);
    const { size, mtimeMs } = await file.stat();
    if (size !== outputBytes) return false;
    if (mtimeMs === outputTime) return true;
    const hash = createHash('sha256');
    for await (const chunk of file.createReadStream({ autoClose: false })) hash.update(chunk);
    return hash.digest('hex') === outputSha256;
  } catch (error) {
    const { code = '' } = error as NodeJS.ErrnoException;
    if (error instanceof Failure || /^(ENOENT|ENOTDIR|ELOOP)$/.test(code)) return false;
    throw new Failure('network', `${output}: ${meaningOf(error)}`); // it may be there
  } finally {
    await file?.close();
  }
}

/**
 * Writes an output, complete or not at all: a file gets its name when it is complete, and servers of objects show an object when its
 * upload is complete. Writing the same twice does no harm.
 * @param place  A URL for PUT, or a name in the output folder.
 * @returns when a file was written
 */
export async function write(
  place: string,
  data: Uint8Array | string | AsyncIterable<string>,
): Promise<number | undefined> {
  if (isUrl(place)) {
    checkStatus(place, await request(place, { method: 'PUT', body: data as BodyInit }));
    return undefined;
  }
  let unfinished: string | undefined;
  try {
    const path = await pathOf(place, true);
    unfinished = await pathOf(`${temporaryFolder}/${randomUUID()}`, true);
    const file = await open(unfinished, 'wx');
    try {
      await writeFile(file, data);
      await file.sync();
      const { mtimeMs } = await file.stat();
      await rename(unfinished, path);
      return mtimeMs;
    } finally {
      await file.close();
    }
  } catch (error) {
    if (unfinished !== undefined) await rm(unfinished, { force: true });
    if (error instanceof Failure || !(error as NodeJS.ErrnoException).code) throw error;
    throw new Failure('network', `${place} cannot be written: ${meaningOf(error)}`);
  }
}

/** Removes what workers that died left unfinished more than an hour ago. */
export async function removeLeftovers(): Promise<void> {
  const folder = await pathOf(`${temporaryFolder}/any`).then(dirname, (error) => {
    if (error instanceof Failure) throw error;
  });
  if (folder === undefined) return; // nothing was written yet
  for (const name of await readdir(folder).catch(() => [])) {
    const path = join(folder, name);
    const { mtimeMs } = await lstat(path).catch(() => ({ mtimeMs: Number.POSITIVE_INFINITY }));
    if (mtimeMs < Date.now() - 3_600_000) await rm(path, { force: true });
  }
}
