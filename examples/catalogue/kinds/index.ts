import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Failure } from '../failure.ts';
import { inspectKind } from './inspect.ts';
import type { Kind } from './kind.ts';
import { transferKind } from './transfer.ts';

/** A module outside this folder whose default export has further kinds. */
const others = process.env['CATALOGUE_KINDS'];

async function load(path: string): Promise<Record<string, Kind>> {
  try {
    return (await import(pathToFileURL(resolve(path)).href)).default;
  } catch (error) {
    throw new Failure('broken', `CATALOGUE_KINDS: ${resolve(path)} cannot be loaded: ${(error as Error).message}`);
  }
}

/** All kinds of jobs, by the name that a manifest gives them. */
export const kinds: Record<string, Kind> = {
  inspect: inspectKind,
  transfer: transferKind,
  ...(others && (await load(others))),
};
