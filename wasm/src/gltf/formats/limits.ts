import { defaultLimits, type ReadLimits } from '../checks/read-limits.js';

/** What reading a model of another format may cost. A few bytes can otherwise demand all memory, or never end. */
export interface FormatLimits extends Pick<ReadLimits, 'bytes' | 'nesting' | 'instances' | 'parts' | 'expansion'> {
  /** Files beside the model that are asked for, also missing ones. Default: 1000 */
  files: number;
  /** Corners of a polygon. Default: 2000 */
  corners: number;
  /**
   * Seconds that the loader may take, waiting for files not counted. In Node, seconds of CPU, other threads of the process included;
   * default: 1.5, for a file of more than a MiB 1.5 for each. In pages, seconds of the clock, as phones are slower; default: 10, for each
   */
  seconds: number;
  /**
   * Bytes of all that the loader makes: typed arrays, and what it adds to other arrays. Default: 128 MiB, and `expansion` times the
   * bytes of the file. In Node, the heap of its thread may also not be larger than twice that and 256 MiB.
   */
  memory: number;
}

const kMiB = 2 ** 20;

/** Seconds for each MiB, by the host: whether it tells the CPU that is used. */
const kSeconds = typeof globalThis.process?.cpuUsage === 'function' ? 1.5 : 10;

/** Limits that do not depend on the file. */
const kFixed = { files: 1000, corners: 2000 };

/** The names of the limits that only other formats have, and what their defaults are, for people. */
export const formatDefaults = {
  ...kFixed,
  seconds: '1.5 for each MiB',
  memory: '128 MiB and "expansion" times the file',
};

/** The limits of a file. @param given  Those that are not the default ones. */
export function limitsOf(bytes: number, given: Partial<FormatLimits> = {}): FormatLimits {
  const { bytes: most, nesting, instances, parts, expansion } = { ...defaultLimits, ...withoutNone(given) };
  return {
    bytes: most,
    nesting,
    instances,
    parts,
    expansion,
    ...kFixed,
    seconds: kSeconds * Math.max(1, bytes / kMiB),
    memory: 128 * kMiB + expansion * bytes,
    ...withoutNone(given),
  };
}

const withoutNone = (given: Partial<FormatLimits>): Partial<FormatLimits> =>
  Object.fromEntries(Object.entries(given).filter(([, value]) => value !== undefined));

/** What of a file may become of it: 32 MiB, or as many times its size as `expansion` says. */
export const mostBytes = (bytes: number, { expansion }: Pick<FormatLimits, 'expansion'>): number =>
  Math.max(32 * kMiB, expansion * bytes);
