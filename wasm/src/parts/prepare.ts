import {
  type CutTarget,
  cutBorders,
  type Mesh,
  type TransferOptions,
  type TransferResult,
  transfer,
} from '../index.js';
import { type CutPieces, cutPart } from './cut-part.js';
import { separatePaint, withCopies } from './separate-paint.js';
import { type PartGeometry, type SplitPart, splitPart, turnOver } from './split-part.js';

/** Where a part is in the arrays of a target. */
export type PartRange = Omit<PartGeometry, 'localIndices'>;

/** What is to be done to a part's geometry. */
export interface PreparedPart {
  /** If borders were cut. */
  pieces: CutPieces | undefined;
  split: SplitPart;
}

/** The result of a transfer, and all that follows from it for the parts of its target: plain data. */
export interface Prepared {
  result: TransferResult;
  /** The number of triangles added by cutting borders; `undefined` if they were not cut. */
  cutTriangles: number | undefined;
  parts: PreparedPart[];
}

export interface PrepareInput {
  /** Not needed for a `result` whose borders are not cut. */
  cage: Mesh | undefined;
  target: Mesh;
  parts: readonly PartRange[];
  options: TransferOptions;
  /** A result that is known already. */
  result: TransferResult | undefined;
  cuts: boolean;
  /** Whether vertices are also split where painted triangles meet others. */
  paints: boolean;
}

/** Transfers, cuts borders and splits vertices. Needs `init`. @throws {CagecastError} as `transfer` does. */
export function prepare({ cage, target, parts, options, result: known, cuts, paints }: PrepareInput): Prepared {
  const result = known ?? transfer(cage!, target, options);
  const cut = cuts ? cutBorders(cage!, target, result, options) : undefined;
  return {
    result,
    cutTriangles: cut && (cut.indices.length - target.indices.length) / 3,
    parts: parts.map((range) => preparePart(range, target, result, cut, paints)),
  };
}

function preparePart(
  range: PartRange,
  target: Mesh,
  result: TransferResult,
  cut: CutTarget | undefined,
  paints: boolean,
): PreparedPart {
  const pieces = cut && cutPart(range, cut, target.positions.length / 3);
  const split = pieces
    ? splitPart(pieces.geometry, pieces.result)
    : splitPart({ ...range, localIndices: localIndices(range, target.indices) }, result);
  const { firstTriangle, triangleCount } = range;
  const cosmetic =
    pieces?.result.cosmeticTriangles ?? result.cosmeticTriangles.subarray(firstTriangle, firstTriangle + triangleCount);
  const copies = paints ? separatePaint(split.indices, cosmetic, split.sources.length) : undefined;
  return {
    pieces: pieces && {
      blends: pieces.blends,
      origins: pieces.origins,
      result: { zones: pieces.result.zones, cosmeticTriangles: cosmetic },
    },
    split: copies ? withCopies(split, copies) : split,
  };
}

/** The triangles of a part, in its own numbers and winding. */
export function localIndices(
  { firstVertex, firstTriangle, triangleCount, mirrored }: PartRange,
  indices: Mesh['indices'],
) {
  const local = Uint32Array.from(
    indices.subarray(3 * firstTriangle, 3 * (firstTriangle + triangleCount)),
    (v) => v - firstVertex,
  );
  if (mirrored) turnOver(local);
  return local;
}
