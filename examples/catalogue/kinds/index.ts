import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { inspectKind } from './inspect.ts';
import type { Kind } from './kind.ts';
import { transferKind } from './transfer.ts';

/** A module outside this folder whose default export has further kinds. */
const others = process.env['CATALOGUE_KINDS'];

/** All kinds of jobs, by the name that a manifest gives them. */
export const kinds: Record<string, Kind> = {
  inspect: inspectKind,
  transfer: transferKind,
  ...(others && ((await import(pathToFileURL(resolve(others)).href)).default as Record<string, Kind>)),
};
