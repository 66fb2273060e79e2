import { createReadStream, existsSync } from 'node:fs';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { type Catalogue, finishedJobs, type Result } from './jobs.ts';
import { settings } from './settings.ts';
import { write } from './storage.ts';

const resultsFile = 'results.jsonl';
const ownResults = () => join(settings.outputs, resultsFile);

/** The results in a file, one by one; none if there is no such file. */
export async function* readResults(path: string): AsyncGenerator<Result> {
  if (!existsSync(path)) return;
  for await (const line of createInterface({ input: createReadStream(path) })) yield JSON.parse(line) as Result;
}

/** Keys of jobs that were done, as told by the results in the output folder: Redis may have forgotten them. */
export async function doneBefore(): Promise<Set<string>> {
  const keys = new Set<string>();
  for await (const { key, status } of readResults(ownResults())) if (status === 'done') keys.add(key);
  return keys;
}

/**
 * Writes all results to the output folder: those that Redis has, then those of the file before that Redis has forgotten. Each job has
 * one line.
 * @param visit  Called with each.
 */
export async function collectResults(catalogue: Catalogue, visit: (result: Result) => void): Promise<void> {
  const keys = new Set<string>();
  const take = (result: Result) => {
    keys.add(result.key);
    visit(result);
    return `${JSON.stringify(result)}\n`;
  };
  async function* lines() {
    for await (const result of finishedJobs(catalogue)) yield take(result);
    for await (const result of readResults(ownResults())) if (!keys.has(result.key)) yield take(result);
  }
  await write(resultsFile, lines());
}
