/** The codes of the C++ core, in the order of its `Code` (core/include/cagecast/mesh.hpp), without `ok`. */
export const coreCodes = [
  'emptyMesh',
  'positionsNotTriples',
  'indicesNotTriples',
  'missingUvs',
  'uvCountMismatch',
  'groupCountMismatch',
  'cornerUvCountMismatch',
  'indexOutOfRange',
  'nonFinitePosition',
  'nonFiniteUv',
  'noUsableCageTriangle',
  'tooLarge',
  'badOption',
  'resultMismatch',
  'outOfMemory',
] as const;

/**
 * What went wrong, for programs.
 *
 * - `emptyMesh`: a mesh without vertices or without triangles.
 * - `positionsNotTriples`, `indicesNotTriples`: an array whose length is not a multiple of three.
 * - `missingUvs`: the cage has no UVs.
 * - `uvCountMismatch`, `groupCountMismatch`: UVs are not two, groups not one per vertex.
 * - `cornerUvCountMismatch`: UVs per corner are not two per index.
 * - `indexOutOfRange`, `nonFinitePosition`, `nonFiniteUv`: `at` is the place in the array.
 * - `noUsableCageTriangle`: every triangle of the cage has zero area.
 * - `tooLarge`: too many elements, or (`at`: the place in `positions`) coordinates out of all proportion.
 * - `badOption`: an option of a wrong type, out of its range, or of no known name.
 * - `badArgument`: an argument of a wrong type.
 * - `resultMismatch`: a result that is not of the target it is given with.
 * - `outOfMemory`: the work does not fit into memory; the next call starts afresh.
 * - `notInitialised`: `init()` has not resolved yet.
 * - `unsupported`: this host cannot run the WebAssembly module.
 * - `aborted`: the call was given up through its `AbortSignal`.
 * - `internal`: a defect of Cagecast; please report it.
 */
export type Code =
  | (typeof coreCodes)[number]
  | 'badArgument'
  | 'notInitialised'
  | 'unsupported'
  | 'aborted'
  | 'internal';

/** The one error that Cagecast throws. Its message names the function, the argument, the value and the limit. */
export class CagecastError extends Error {
  override readonly name = 'CagecastError';
  /** What went wrong, for programs. */
  readonly code: Code;
  /** The element at fault, counted in the array that the message names; how many there are, where that is the fault; else 0. */
  readonly at: number;

  constructor(code: Code, message: string, at = 0, options?: ErrorOptions) {
    super(message, options);
    this.code = code;
    this.at = at;
  }
}

/** Names a value in a message: what it is, and how much of it. */
export function show(value: unknown): string {
  if (typeof value === 'string') return JSON.stringify(value.length > 40 ? `${value.slice(0, 40)}…` : value);
  if (value === null || value === undefined || typeof value === 'number' || typeof value === 'boolean')
    return String(value);
  if (typeof value === 'object') return `of type ${value.constructor?.name ?? 'object'}`;
  return `of type ${typeof value}`;
}
