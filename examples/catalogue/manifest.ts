import { linesOf } from './command.ts';
import { withoutSecrets } from './failure.ts';
import { kinds } from './kinds/index.ts';
import { settings as limits } from './settings.ts';
import { isAddress, isRecord, type JobData } from './shape.ts';
import { hashOf, read } from './storage.ts';

/** A line of a manifest, read: its jobs, or what is wrong with it. */
export type Entry = { line: number } & ({ data: JobData } | { error: string });

/**
 * The jobs of a manifest, which has a JSON object per line:
 *
 *   {"kind": "inspect", "target": ["avatars/1.glb", "avatars/2.glb"], "cage": ["cages/a.glb", "cages/b.glb"]}
 *   {"kind": "transfer", "target": "https://…", "cage": "cages/a.glb", "output": "https://…", "settings": {"threshold": 0.4}}
 *
 * A list stands for one job for each of its members, several lists for all pairs. An input is a path in the input folder, a URL, or
 * {"place": …, "sha256": …}, which saves reading it now. Lines are read one by one: a manifest may be larger than the memory.
 * @throws {Failure} if the file cannot be read.
 */
export async function* readManifest(path: string): AsyncGenerator<Entry> {
  const hashes = new Map<string, Promise<string>>();
  let line = 0;
  for await (const text of linesOf(path)) {
    ++line;
    if (text.trim() === '') continue;
    try {
      for (const job of pairsOf(parse(text))) yield { line, ...(await entryOf(job, hashes)) };
    } catch (error) {
      yield { line, error: textOf(error) };
    }
  }
}

const textOf = (error: unknown): string => withoutSecrets((error as Error).message).slice(0, 500);

type Line = Record<string, unknown>;

/** The message of `JSON.parse` would show a part of the line, where the signature of an address may be. */
function parse(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    throw new Error('is not a JSON object; was it cut off, or is a quote or a comma missing?');
  }
}

/** One line for each combination of the members of its lists, one by one: a short line can stand for millions. */
function* pairsOf(line: unknown): Generator<Line> {
  if (!isRecord(line)) throw new Error('is not a JSON object');
  const lists = Object.entries(line).filter((entry): entry is [string, unknown[]] => Array.isArray(entry[1]));
  for (const [name, list] of lists) {
    if (list.length === 0) throw new Error(`"${name}" is an empty list`);
    if (list.some(Array.isArray)) throw new Error(`"${name}" has a list in its list`);
  }
  const count = lists.reduce((product, [, list]) => product * list.length, 1);
  if (count > limits.pairs) {
    const sizes = lists.map(([name, { length }]) => `${length} of "${name}"`).join(' × ');
    throw new Error(
      `stands for ${count} jobs (${sizes}), at most ${limits.pairs} are allowed: split it, or raise CATALOGUE_PAIRS`,
    );
  }
  if (count > 1 && typeof line['output'] === 'string')
    throw new Error(`stands for ${count} jobs, but has one "output", where each would replace the one before`);
  const inner = [...lists].reverse(); // the last list turns fastest
  for (let n = 0; n < count; ++n) {
    const job = { ...line };
    let rest = n;
    for (const [name, list] of inner) {
      job[name] = list[rest % list.length];
      rest = Math.floor(rest / list.length);
    }
    yield job;
  }
}

async function entryOf(
  line: Line,
  hashes: Map<string, Promise<string>>,
): Promise<{ data: JobData } | { error: string }> {
  try {
    return { data: await dataOf(line, hashes) };
  } catch (error) {
    return { error: textOf(error) };
  }
}

async function dataOf(line: Line, hashes: Map<string, Promise<string>>): Promise<JobData> {
  const { kind, settings = {}, output, ...given } = line;
  const known = typeof kind === 'string' && Object.hasOwn(kinds, kind) ? kinds[kind] : undefined;
  if (!known) throw new Error(`"kind" is ${JSON.stringify(kind)}; there are: ${Object.keys(kinds).join(', ')}`);
  if (!isRecord(settings)) throw new Error('"settings" is not an object');
  if (output !== undefined && !isAddress(output))
    throw new Error('"output" is not a URL; without one, it is written to the output folder');
  const stranger = Object.keys(given).find((name) => !Object.hasOwn(known.inputs, name));
  if (stranger !== undefined)
    throw new Error(`"${stranger}" is unknown; inputs: ${Object.keys(known.inputs).join(', ')}`);
  const inputs: JobData['inputs'] = {};
  for (const [name, need] of Object.entries(known.inputs)) {
    const value = given[name];
    if (value === undefined && need === 'required') throw new Error(`has no "${name}"`);
    if (value !== undefined) inputs[name] = await inputOf(name, value, hashes);
  }
  return { kind: kind as string, inputs, settings: settings as Line, ...(output !== undefined && { output }) };
}

async function inputOf(name: string, value: unknown, hashes: Map<string, Promise<string>>) {
  const { place, sha256 } = typeof value === 'string' ? { place: value } : isRecord(value) ? value : {};
  if (typeof place !== 'string' || place === '') throw new Error(`"${name}" is not a path or a URL`);
  if (sha256 !== undefined && !/^[0-9a-f]{64}$/.test(String(sha256))) throw new Error(`"${name}" has a wrong sha256`);
  if (sha256 !== undefined) return { place, sha256: String(sha256) };
  const hash = hashes.get(place) ?? read(place).then(hashOf);
  hashes.set(place, hash);
  return { place, sha256: await hash };
}
