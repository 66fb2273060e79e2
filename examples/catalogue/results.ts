import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { linesOf } from './command.ts';
import { Failure } from './failure.ts';
import { type Catalogue, finishedJobs, type Result } from './jobs.ts';
import { settings } from './settings.ts';
import { write } from './storage.ts';

const resultsFile = 'results.jsonl';

/** The results in a file, one by one. @throws {Failure} if it cannot be read, or a line is not a result. */
export async function* readResults(path: string): AsyncGenerator<Result> {
  let line = 0;
  for await (const text of linesOf(path)) {
    ++line;
    yield parse(text, `${path}, line ${line},`);
  }
}

function parse(text: string, where: string): Result {
  try {
    return JSON.parse(text);
  } catch {
    throw new Failure('broken', `${where} is not a result; was the file cut off?`);
  }
}

/** The results in the output folder; none before the first night. */
async function* ownResults(): AsyncGenerator<Result> {
  const path = join(settings.outputs, resultsFile);
  if (existsSync(path)) yield* readResults(path);
}

/** Keys of jobs that were done, as told by the results in the output folder: Redis may have forgotten them. */
export async function doneBefore(): Promise<Set<string>> {
  const keys = new Set<string>();
  for await (const { key, status } of ownResults()) if (status === 'done') keys.add(key);
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
    for await (const result of ownResults()) if (!keys.has(result.key)) yield take(result);
  }
  await write(resultsFile, lines());
}
