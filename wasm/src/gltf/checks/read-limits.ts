import { InputError } from '../../scene/input-error.js';

/** What reading a glTF file may cost. A few bytes can otherwise demand all memory and hours. */
export interface ReadLimits {
  /** Bytes of the file, of its buffers together, and of each image beside it. Default: 2^30 */
  bytes: number;
  /** Levels of its JSON, and of nodes below each other. Default: 1000 */
  nesting: number;
  /** How often the scene shows the same positions: nodes that share a mesh, primitives that share an accessor. Default: 1000 */
  instances: number;
  /** Parts of the scene: nodes, and primitives as often as nodes show them. Default: 20,000 */
  parts: number;
  /**
   * Elements of accessors that are not in the file: those without bytes are zero. Attributes of a primitive whose positions are in the
   * file are not counted. Default: 1,000,000
   */
  implied: number;
  /**
   * How many times larger than its files the data may become when it is decoded and shown: geometry from 32 MiB on, images from 256 MiB
   * on. What is used more than once is counted more than once: instances, attributes and morph targets that share bytes, the joints
   * of each skinned node. Default: 100
   */
  expansion: number;
}

/** The limits that hold if no others are given. */
export const defaultLimits: Readonly<ReadLimits> = {
  bytes: 2 ** 30,
  nesting: 1000,
  instances: 1000,
  parts: 20_000,
  implied: 1_000_000,
  expansion: 100,
};

/** The error of a file over a limit. @param what  The subject, with its number. */
export function exceeds<Limit extends string>(
  what: string,
  limit: Limit,
  { [limit]: value }: Record<Limit, number>,
): InputError {
  return new InputError(`${what}; the limit "${limit}" is ${value.toLocaleString('en')}`);
}

/** Checks the size of a file. @throws {InputError} */
export function checkBytes(bytes: number, limits: ReadLimits): void {
  if (bytes > limits.bytes) throw exceeds(`has more than ${limits.bytes.toLocaleString('en')} bytes`, 'bytes', limits);
}
