// Inputs and outputs: in a folder that all machines mount, or behind http(s), with S3-style signed URLs for GET and PUT.
import { constants } from 'node:fs';
import { mkdir, open, readdir, realpath, rename, rm, stat, writeFile } from 'node:fs/promises';
import { dirname, isAbsolute, join, relative, resolve } from 'node:path';
import { Failure } from './failure.ts';
import { settings } from './settings.ts';

const mostRedirects = 3;
const requestMs = 60_000;
const temporaryFolder = '.unfinished';

export const isUrl = (place: string): boolean => /^[a-z][a-z0-9+.-]+:/i.test(place);

/** A place without the signature of its URL: for logs, pages and results. */
export const shown = (place: string): string => (isUrl(place) ? place.replace(/[?#].*$/s, '') : place);

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
    throw new Failure(/^(ENOENT|ENOTDIR|EACCES|ELOOP)$/.test(code) ? 'missing' : 'network', `${name}: ${code}`);
  }
}

/** @throws {Failure} unless the server is one of those that are allowed. */
function allowed(place: string): URL {
  const url = URL.canParse(place) ? new URL(place) : undefined;
  if (!url || !/^https?:$/.test(url.protocol) || !settings.hosts.includes(url.host))
    throw new Failure('refused', `${shown(place)}: its server is not in CATALOGUE_HOSTS`);
  return url;
}

async function request(place: string, init: RequestInit): Promise<Response> {
  const url = allowed(place);
  try {
    return await fetch(url, { ...init, redirect: 'manual', signal: AbortSignal.timeout(requestMs) });
  } catch (error) {
    throw new Failure('network', `${shown(place)}: ${(error as Error).message}`);
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
    throw error instanceof Failure ? error : new Failure('network', `${shown(place)}: ${(error as Error).message}`);
  }
  return Buffer.concat(chunks);
}

/**
 * Writes an output, complete or not at all: a file gets its name when it is complete, and servers of objects show an object when its
 * upload is complete. Writing the same twice does no harm.
 * @param place  A URL for PUT, or a name in the output folder.
 */
export async function write(place: string, data: Uint8Array | string | AsyncIterable<string>): Promise<void> {
  if (isUrl(place)) {
    checkStatus(place, await request(place, { method: 'PUT', body: data as BodyInit }));
    return;
  }
  const path = join(settings.outputs, place);
  const unfinished = join(settings.outputs, temporaryFolder, `${process.pid}-${Date.now()}-${Math.random()}`);
  try {
    await mkdir(dirname(unfinished), { recursive: true });
    await mkdir(dirname(path), { recursive: true });
    await writeFile(unfinished, data, { flush: true });
    await rename(unfinished, path);
  } catch (error) {
    await rm(unfinished, { force: true });
    throw new Failure('network', `${place} cannot be written (${(error as NodeJS.ErrnoException).code})`);
  }
}

/** Removes what workers that died left unfinished more than an hour ago. */
export async function removeLeftovers(): Promise<void> {
  const folder = join(settings.outputs, temporaryFolder);
  for (const name of await readdir(folder).catch(() => [])) {
    const path = join(folder, name);
    const { mtimeMs } = await stat(path).catch(() => ({ mtimeMs: Number.POSITIVE_INFINITY }));
    if (mtimeMs < Date.now() - 3_600_000) await rm(path, { force: true });
  }
}
