import { appendFileSync, existsSync, mkdirSync, readFileSync } from 'node:fs';
import { dirname } from 'node:path';
import type { Verdict } from '../../inspect/index.js';
import { firstLine, InputError } from '../../scene/input-error.js';
import { canonicalPath, writing } from '../io/output.js';
import type { Outcome } from './batch-worker.js';

/** A line of the results. */
export type ResultLine = { target: string; output: string | null; report?: string; key: string } & (
  | Outcome
  | { status: 'skipped'; verdict?: Verdict }
);

/** What the results of earlier runs say. */
interface EarlierResults {
  /** The last line of each job that was done, by its key. */
  lines: Map<string, ResultLine>;
  /** The keys of the jobs that wrote files last, by the canonical path of the file. */
  writers: Map<string, string>;
  /** The last lines, by target. */
  last: Map<string, ResultLine>;
}

export const noResults = (): EarlierResults => ({ lines: new Map(), writers: new Map(), last: new Map() });

/** Reads the results of earlier runs. A line that was not written to its end is left out. */
export function readResults(path: string): EarlierResults {
  const found = noResults();
  const text = readText(path);
  for (const one of text.split('\n')) {
    try {
      const line = JSON.parse(one) as ResultLine;
      if (typeof line.key !== 'string') continue;
      found.last.set(line.target, line);
      if (line.status !== 'done') continue;
      found.lines.set(line.key, line);
      for (const file of [line.output, line.report]) if (file) found.writers.set(canonicalPath(file), line.key);
    } catch {
      // Cut off when the batch was killed.
    }
  }
  if (text !== '' && !text.endsWith('\n')) append(path, '\n');
  return found;
}

function readText(path: string): string {
  try {
    return existsSync(path) ? readFileSync(path, 'utf8') : '';
  } catch (error) {
    throw new InputError(`cannot be read (${firstLine(error)})`, { cause: error }).in(path);
  }
}

/** Finds out before the first job whether results can be written. Makes their folder. */
export function openResults(path: string): void {
  writing(path, () => mkdirSync(dirname(path), { recursive: true }));
  append(path, '');
}

export const append = (path: string, text: string): void => writing(path, () => appendFileSync(path, text));
