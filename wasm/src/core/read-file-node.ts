import { readFile as read } from 'node:fs/promises';

/** Reads a file of the package. */
export async function readFile(url: URL): Promise<Uint8Array<ArrayBuffer>> {
  return new Uint8Array(await read(url));
}
