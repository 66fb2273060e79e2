import { join } from 'node:path';
import { linesOf } from './command.ts';
import { Failure, meaningOf } from './failure.ts';
import { type Catalogue, finishedJobs, presentResult, type Result } from './jobs.ts';
import { settings } from './settings.ts';
import { isRecord, type Written } from './shape.ts';
import { openOutput, write } from './storage.ts';

const resultsFile = 'results.jsonl';
/** How many outputs are looked at at once. */
const atOnce = 200;

/** The results in a file, one by one. @throws {Failure} if it cannot be read, or a line is not a result. */
export async function* readResults(path: string, lines = linesOf(path)): AsyncGenerator<Result> {
  let line = 0;
  for await (const text of lines) {
    ++line;
    const result = parse(text);
    if (!result) throw new Failure('broken', `${path}, line ${line}, is not a result; was the file cut off?`);
    yield result;
  }
}

function parse(text: string): Result | undefined {
  try {
    const { key, kind, status, inputs, settings, ...rest } = JSON.parse(text);
    const isResult = /^(done|failed)$/.test(status) && isRecord(inputs) && isRecord(settings);
    if (!isResult || typeof key !== 'string' || typeof kind !== 'string') return undefined;
    return { key, kind, status, inputs, settings, ...rest } as Result;
  } catch {
    return undefined;
  }
}

/** The results in the output folder; none before the first night. */
async function* ownResults(): AsyncGenerator<Result> {
  const file = await openOutput(resultsFile).catch((error: NodeJS.ErrnoException) => {
    if (error.code !== 'ENOENT')
      throw new Failure('refused', `${resultsFile} in the output folder ${meaningOf(error)}`);
  });
  if (!file) return;
  const path = join(settings.outputs, resultsFile);
  const lines = linesOf(path, async () => file);
  // One that was lost may be there again: whoever asks looks.
  for await (const { reason, error, ...result } of readResults(path, lines))
    yield reason === 'lost' ? { ...result, status: 'done' } : { ...result, ...(reason && { reason, error: error! }) };
}

/** What jobs wrote that were done, as told by the results in the output folder: Redis may have forgotten them. */
export async function doneBefore(): Promise<Map<string, Partial<Written>>> {
  const all = new Map<string, Partial<Written>>();
  for await (const { key, status, output, outputBytes, outputSha256, outputTime } of ownResults())
    if (status === 'done') all.set(key, { output, outputBytes, outputSha256, outputTime } as Partial<Written>);
  return all;
}

/**
 * All results: those that Redis has, then those in the output folder that Redis has forgotten. Each job has one; it is done if its
 * output is there now.
 */
async function* allResults(catalogue: Catalogue): AsyncGenerator<Result> {
  const keys = new Set<string>();
  async function* each() {
    yield* finishedJobs(catalogue);
    yield* ownResults();
  }
  let some: Result[] = [];
  for await (const result of each()) {
    if (keys.has(result.key)) continue;
    keys.add(result.key);
    if (some.push(result) < atOnce) continue;
    yield* await Promise.all(some.map(presentResult));
    some = [];
  }
  yield* await Promise.all(some.map(presentResult));
}

/** Writes all results to the output folder. @param visit  Called with each. */
export async function collectResults(catalogue: Catalogue, visit: (result: Result) => void): Promise<void> {
  async function* lines() {
    for await (const result of allResults(catalogue)) {
      visit(result);
      yield `${JSON.stringify(result)}\n`;
    }
  }
  await write(resultsFile, lines());
}
