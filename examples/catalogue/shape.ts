import { Failure } from './failure.ts';
import type { Facts } from './kinds/kind.ts';

/** What a job is to do, as it is kept in Redis. */
export interface JobData {
  kind: string;
  /** Where each input is, and the hash of its bytes. */
  inputs: Record<string, { place: string; sha256: string }>;
  settings: Record<string, unknown>;
  /** A URL for PUT; by default a file in the output folder, named by the job's key. */
  output?: string;
}

/** What was written: looked at again before the job is told as done. */
export interface Written {
  /** A URL, or a name in the output folder. */
  output: string;
  outputBytes: number;
  outputSha256: string;
  /** When the file was written, in ms; one that was not touched since is not read again. */
  outputTime?: number;
}

/** What a job that is done leaves in Redis. */
export interface Done extends Partial<Written> {
  facts: Facts;
  ms: number;
  cpuMs: number;
}

export const isRecord = (value: unknown): value is Record<string, unknown> =>
  typeof value === 'object' && value !== null && !Array.isArray(value);

export const isAddress = (value: unknown): value is string =>
  typeof value === 'string' && /^https?:\/\//i.test(value) && URL.canParse(value);

const isHash = (value: unknown) => typeof value === 'string' && /^[0-9a-f]{64}$/.test(value);

/**
 * The one check of what Redis has of a job: anybody may have put it there. A key becomes the name of a file.
 * @throws {Failure} `broken`
 */
export function checkedJob({ id, data }: { id?: string | undefined; data: unknown }): { key: string; data: JobData } {
  const wrong = (what: string) =>
    new Failure('broken', `is not a job of the catalogue: ${what}; npm run submit makes jobs`);
  if (!isRecord(data) || Object.keys(data).length === 0) throw wrong('it has no data');
  const { kind, inputs, settings, output } = data;
  if (typeof kind !== 'string' || !/^\w[\w-]{0,63}$/.test(kind)) throw wrong('its "kind" is no name');
  const isInput = (one: unknown) =>
    isRecord(one) && typeof one['place'] === 'string' && one['place'] !== '' && isHash(one['sha256']);
  if (!isRecord(inputs) || !Object.values(inputs).every(isInput))
    throw wrong('its "inputs" have not all a place and a sha256');
  if (!isRecord(settings)) throw wrong('its "settings" are no object');
  if (output !== undefined && !isAddress(output)) throw wrong('its "output" is no address');
  if (typeof id !== 'string' || !id.startsWith(`${kind}-`) || !/^[0-9a-f]{32}$/.test(id.slice(kind.length + 1)))
    throw wrong('its id is not its kind, "-" and 32 hexadecimal digits');
  return { key: id, data: data as unknown as JobData };
}

/** What Redis has of what came of a job, checked too. @throws {Failure} `broken` */
export function checkedDone(value: unknown): Done {
  const wrong = new Failure('broken', 'what its worker left in Redis is no result');
  if (!isRecord(value) || !isRecord(value['facts'])) throw wrong;
  const { output, outputBytes, outputSha256, ms, cpuMs } = value;
  if (typeof ms !== 'number' || typeof cpuMs !== 'number') throw wrong;
  if (output !== undefined && !(typeof output === 'string' && typeof outputBytes === 'number' && isHash(outputSha256)))
    throw wrong;
  return value as unknown as Done;
}
