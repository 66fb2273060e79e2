import type { Mesh, TransferResult } from '../api/index.js';
import { CagecastError, show } from '../core/error.js';
import { type Image, wrongArgument } from './image.js';
import { type Baked, checkFill, type FillOptions, fill, type Layout, paintedOnly } from './layout.js';

/** The model: what `transfer` was given, with UVs of its own; positions are needed for normal maps only. */
export type BakeTarget = Pick<Mesh, 'indices' | 'uvs'> & Partial<Pick<Mesh, 'positions'>>;

/** What is needed of a result of `transfer`. A cut target has it, too; its UVs are those of its vertices. */
export type BakeResult = Pick<TransferResult, 'uvs' | 'cornerUvs' | 'cosmeticTriangles'> &
  Partial<Pick<TransferResult, 'distances'>>;

/** A part of a model: a range of its triangles. */
export interface BakePart {
  name: string;
  firstTriangle: number;
  triangleCount: number;
}

/** Options of `bakeTexture` and `cageTexture`. */
export interface BakeOptions extends FillOptions {
  /** The parts that have this texture; other triangles are left out. Default: all, as one part called "target". */
  parts?: readonly BakePart[] | undefined;
}

/**
 * Bakes a paint into a model's own UVs. All triangles of the parts take their place in the texture, and those that may be painted
 * show the paint. Where they overlap, the first one has the texels; `overlap` says how much, and which parts.
 *
 * A normal map is turned from the tangent space of the cage's UVs into that of the model's, a triangle at a time.
 *
 * Cost: 4 to 16 samples a texel, or one from 4 × 4 texels if the image is no finer; 0.3 to 0.5 s for 1024². Memory: 32 bytes a texel.
 *
 * @param paint  In the cage's UVs; it repeats.
 * @throws {CagecastError} `badArgument` if the target has no UVs, or one that is not finite, if the result does not belong to it,
 * or for a size that is not 1 to 8192; `badOption`.
 *
 * @example
 * const result = transfer(cage, head);
 * const { data } = bakeTexture(head, result, { width: 2048, height: 2048, data: rgba }, { width: 1024 });
 */
export function bakeTexture(target: BakeTarget, result: BakeResult, paint: Image, options: BakeOptions = {}): Baked {
  const read = layoutsOf('bakeTexture', target, result, options);
  return fill('bakeTexture', read, paint, options);
}

/**
 * The way back: what is painted on a model, as a texture in the cage's UVs, which paints any other model with this cage. What of
 * the cage lies over nothing that may be painted stays transparent, but for the gutter. Where parts of the model lie over each
 * other, the one nearest to the cage is seen. Texels of the atlas that are not painted do not show at borders.
 *
 * Cost and errors as for `bakeTexture`, and a third as much for each texel of the atlas.
 *
 * @param atlas  The model's own texture; it repeats.
 *
 * @example
 * const moved = bakeTexture(other, transfer(cage, other), cageTexture(head, transfer(cage, head), headTexture));
 */
export function cageTexture(target: BakeTarget, result: BakeResult, atlas: Image, options: BakeOptions = {}): Baked {
  const there = layoutsOf('cageTexture', target, result, options);
  const parts = partsOf('cageTexture', target, options);
  const image = paintedOnly('cageTexture', there, atlas, options);
  const layouts = there.map((layout, p) => {
    const order = [...layout.painted.keys()].filter((t) => layout.painted[t] === 1);
    return reversed(layout, result.distances ? nearestFirst(order, target, result.distances, parts[p]!) : order);
  });
  return fill('cageTexture', layouts, image, options);
}

/** Triangles of a part by their mean distance from the cage; as they were, where it is the same. */
export function nearestFirst(
  order: number[],
  { indices }: Pick<BakeTarget, 'indices'>,
  distances: Float32Array,
  { firstTriangle }: Pick<BakePart, 'firstTriangle'>,
): number[] {
  const distance = (t: number) => {
    const at = 3 * (firstTriangle + t);
    return distances[indices[at]!]! + distances[indices[at + 1]!]! + distances[indices[at + 2]!]!;
  };
  return order.sort((a, b) => distance(a) - distance(b));
}

/** The layout that fills the cage's texture by that of the model, with some triangles, all painted. */
function reversed({ name, to, from, positions }: Layout, order: readonly number[]): Layout {
  const all = Uint32Array.from({ length: 3 * order.length }, (_, i) => 3 * order[Math.floor(i / 3)]! + (i % 3));
  return {
    name,
    to: cornersOf(from, all, 2),
    from: cornersOf(to, all, 2),
    painted: new Uint8Array(order.length).fill(1),
    positions: positions && cornersOf(positions, all, 3),
  };
}

function partsOf(fn: string, { indices }: BakeTarget, { parts }: BakeOptions): readonly BakePart[] {
  const triangles = indices.length / 3;
  if (parts === undefined) return [{ name: 'target', firstTriangle: 0, triangleCount: triangles }];
  if (!Array.isArray(parts)) throw new CagecastError('badOption', fn, `options.parts is ${show(parts)}, not an array`);
  parts.forEach((part: Partial<BakePart> | null, p) => {
    const [first, count] = [part?.firstTriangle as number, part?.triangleCount as number];
    if (!(Number.isInteger(first) && Number.isInteger(count) && first >= 0 && count >= 0 && first + count <= triangles))
      throw new CagecastError(
        'badOption',
        fn,
        `options.parts[${p}] is not { name, firstTriangle, triangleCount } within the ${triangles} triangles of target`,
        { at: p },
      );
  });
  return parts;
}

/** Checks target and result, and lays the triangles of each part out. */
function layoutsOf(fn: string, target: BakeTarget, result: BakeResult, options: BakeOptions): Layout[] {
  const { kind } = checkFill(fn, options);
  if (typeof target !== 'object' || target === null)
    throw wrongArgument(fn, 'target', `is ${show(target)}, not a mesh { indices, uvs }`);
  if (typeof result !== 'object' || result === null)
    throw wrongArgument(fn, 'result', `is ${show(result)}; pass what transfer() returned`);
  const { indices, uvs, positions } = target;
  if (!ArrayBuffer.isView(indices)) throw wrongArgument(fn, 'target.indices', `is ${show(indices)}, not a typed array`);
  if (!ArrayBuffer.isView(uvs) || uvs.length === 0)
    throw wrongArgument(fn, 'target', 'has no UVs; give those of its own texture as target.uvs');
  const [triangles, vertices] = [indices.length / 3, uvs.length / 2];
  if (!Number.isInteger(triangles))
    throw wrongArgument(fn, 'target.indices', `has ${indices.length} entries, not 3 per triangle`);
  const bad = uvs.findIndex((value) => !Number.isFinite(value));
  if (bad >= 0) throw wrongArgument(fn, `target.uvs[${bad}]`, `is ${uvs[bad]}, not a finite number`, bad);
  const stray = indices.findIndex((vertex) => vertex >= vertices);
  if (stray >= 0)
    throw wrongArgument(fn, `target.indices[${stray}]`, `= ${indices[stray]} is out of range (${vertices} UVs)`, stray);
  if (kind === 'normal' && positions?.length !== 3 * vertices)
    throw wrongArgument(
      fn,
      'target.positions',
      `has ${positions?.length ?? 0} numbers, not 3 for each of ${vertices} vertices; normal maps need them`,
    );
  const { cornerUvs, cosmeticTriangles } = result;
  const lengths = {
    uvs: 2 * vertices,
    cosmeticTriangles: triangles,
    ...(cornerUvs?.length !== 0 && { cornerUvs: 6 * triangles }),
  };
  for (const [name, length] of Object.entries(lengths)) {
    const found = result[name as keyof BakeResult]?.length;
    if (found !== length)
      throw new CagecastError(
        'resultMismatch',
        fn,
        `result.${name} has ${found ?? 'no'} entries, the target needs ${length}`,
        { argument: 'result', at: found ?? 0 },
      );
  }
  return partsOf(fn, target, options).map(({ name, firstTriangle: first, triangleCount: count }): Layout => {
    const own = indices.subarray(3 * first, 3 * (first + count));
    return {
      name,
      to: cornersOf(uvs, own, 2),
      from: cornerUvs.length > 0 ? cornerUvs.subarray(6 * first, 6 * (first + count)) : cornersOf(result.uvs, own, 2),
      painted: cosmeticTriangles.subarray(first, first + count),
      positions: kind === 'normal' ? cornersOf(positions!, own, 3) : undefined,
    };
  });
}

/** `size` numbers per vertex, for every corner. */
export function cornersOf(values: ArrayLike<number>, indices: ArrayLike<number>, size: number): Float32Array {
  const out = new Float32Array(size * indices.length);
  for (let i = 0; i < indices.length; ++i)
    for (let k = 0; k < size; ++k) out[size * i + k] = values[size * indices[i]! + k]!;
  return out;
}
