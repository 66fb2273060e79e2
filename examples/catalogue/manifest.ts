import { createHash } from 'node:crypto';
import { linesOf } from './command.ts';
import type { JobData } from './jobs.ts';
import { kinds } from './kinds/index.ts';
import { read } from './storage.ts';

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
      for (const job of pairsOf(JSON.parse(text))) yield { line, ...(await entryOf(job, hashes)) };
    } catch (error) {
      yield { line, error: (error as Error).message };
    }
  }
}

type Line = Record<string, unknown>;

/** One line for each combination of the members of its lists. */
function pairsOf(line: Line): Line[] {
  if (!(line instanceof Object) || Array.isArray(line)) throw new Error('is not a JSON object');
  const list = Object.entries(line).find(([, value]) => Array.isArray(value));
  if (!list) return [line];
  if ((list[1] as unknown[]).length === 0) throw new Error(`"${list[0]}" is an empty list`);
  return (list[1] as unknown[]).flatMap((one) => pairsOf({ ...line, [list[0]]: one }));
}

async function entryOf(
  line: Line,
  hashes: Map<string, Promise<string>>,
): Promise<{ data: JobData } | { error: string }> {
  try {
    return { data: await dataOf(line, hashes) };
  } catch (error) {
    return { error: (error as Error).message };
  }
}

async function dataOf(line: Line, hashes: Map<string, Promise<string>>): Promise<JobData> {
  const { kind, settings = {}, output, ...given } = line;
  const known = typeof kind === 'string' && Object.hasOwn(kinds, kind) ? kinds[kind] : undefined;
  if (!known) throw new Error(`"kind" is ${JSON.stringify(kind)}; there are: ${Object.keys(kinds).join(', ')}`);
  if (!(settings instanceof Object)) throw new Error('"settings" is not an object');
  if (output !== undefined && (typeof output !== 'string' || !/^https?:/.test(output)))
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
  const { place, sha256 } = (typeof value === 'string' ? { place: value } : value) as Record<string, unknown>;
  if (typeof place !== 'string') throw new Error(`"${name}" is not a path or a URL`);
  if (sha256 !== undefined && !/^[0-9a-f]{64}$/.test(String(sha256))) throw new Error(`"${name}" has a wrong sha256`);
  if (sha256 !== undefined) return { place, sha256: String(sha256) };
  const hash = hashes.get(place) ?? read(place).then(hashOf);
  hashes.set(place, hash);
  return { place, sha256: await hash };
}

export const hashOf = (bytes: Uint8Array): string => createHash('sha256').update(bytes).digest('hex');
