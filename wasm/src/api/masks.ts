import { CagecastError, isRecord, show } from '../core/error.js';
import { plainArray, showArray } from '../core/typed-arrays.js';
import { Zone } from '../generated/zone.js';
import { count } from './mesh.js';
import type { Classification } from './result.js';

/**
 * Where the target is never painted (−1) or always (1), whatever the method says; 0 leaves it to the method. For what no lock can
 * name, such as the eyes of a scan in one piece. −1 overrides 1. Segments, their scores and holes are not affected.
 *
 * A vertex of −1 gets `Zone.Culled`, and no triangle at it is painted. A vertex of 1 gets `Zone.Cosmetic`, and a triangle is painted
 * if its vertices say so then. Triangles are decided after vertices: the vertices of a painted triangle of 1 become cosmetic, and
 * those all of whose triangles are −1 become culled.
 *
 * Where the cage has no place for what is painted, as over a hole, it shows the nearest of the cage, stretched.
 */
export interface Masks {
  /** 1 per target vertex. Vertices that lie at the same place may differ. */
  vertices?: Int8Array | undefined;
  /** 1 per target triangle. */
  triangles?: Int8Array | undefined;
}

/**
 * Checks the types and values of masks.
 * @throws {CagecastError} `badOption`
 */
export function checkMasks(fn: string, masks: unknown): Masks | undefined {
  if (masks === undefined) return undefined;
  const wrong = (text: string, at = 0) => new CagecastError('badOption', fn, `options.masks${text}`, { at });
  if (!isRecord(masks)) throw wrong(` is ${show(masks)}, not an object`);
  const out: Masks = {};
  for (const [field, value] of Object.entries(masks)) {
    if (field !== 'vertices' && field !== 'triangles')
      throw wrong(`.${field} is unknown; there are: vertices, triangles`);
    if (value === undefined) continue;
    const array = plainArray(value, 'Int8Array');
    if (!array) throw wrong(`.${field} is ${showArray(value, 'Int8Array')}, not an Int8Array`);
    const bad = array.findIndex((one) => one < -1 || one > 1);
    if (bad >= 0) throw wrong(`.${field}[${bad}] = ${array[bad]} is not -1 (never), 0 or 1 (always)`, bad);
    out[field] = array.slice(); // `reuse` may overwrite its memory
  }
  return out;
}

/** Checks that masks belong to a target. @throws {CagecastError} `badOption` */
export function checkMaskLengths(fn: string, masks: Masks | undefined, vertices: number, triangles: number): void {
  for (const [field, length, one] of [
    ['vertices', vertices, 'vertex'],
    ['triangles', triangles, 'triangle'],
  ] as const) {
    const found = masks?.[field]?.length;
    if (found !== undefined && found !== Math.floor(length))
      throw new CagecastError(
        'badOption',
        fn,
        `options.masks.${field} has ${found} entries, not 1 for each of ${count(length, one)} of target`,
        { at: found },
      );
  }
}

/** How a triangle is decided from the zones of its corners: as step 8 of the method does. */
function isCosmetic(zones: Uint8Array, indices: ArrayLike<number>, t: number, isPartial: boolean): boolean {
  const corners = [zones[indices[3 * t]!]!, zones[indices[3 * t + 1]!]!, zones[indices[3 * t + 2]!]!];
  const isFree = (zone: number) => zone === Zone.Cosmetic || (isPartial && zone === Zone.Occluded);
  return corners.every(isFree) && corners.includes(Zone.Cosmetic);
}

/** What masks say of a triangle: 1 or 0 whether it is painted; undefined if nothing. */
function decided(
  { vertices, triangles }: Masks,
  indices: ArrayLike<number>,
  zones: Uint8Array,
  t: number,
  isPartial: boolean,
): 0 | 1 | undefined {
  const of = (corner: number) => vertices?.[indices[3 * t + corner]!] ?? 0;
  if (of(0) < 0 || of(1) < 0 || of(2) < 0 || triangles?.[t] === -1) return 0;
  if (triangles?.[t] === 1) return 1;
  return of(0) + of(1) + of(2) > 0 ? (isCosmetic(zones, indices, t, isPartial) ? 1 : 0) : undefined;
}

/**
 * Applies masks to a classification, in place.
 * @param isPartial  `steps.partialTriangles`.
 */
export function applyMasks(
  masks: Masks | undefined,
  indices: ArrayLike<number>,
  { zones, cosmeticTriangles }: Pick<Classification, 'zones' | 'cosmeticTriangles'>,
  isPartial: boolean,
): void {
  if (!masks) return;
  const { vertices, triangles } = masks;
  vertices?.forEach((mask, v) => {
    if (mask !== 0) zones[v] = mask < 0 ? Zone.Culled : Zone.Cosmetic;
  });
  for (let t = 0; t < cosmeticTriangles.length; ++t)
    cosmeticTriangles[t] = decided(masks, indices, zones, t, isPartial) ?? cosmeticTriangles[t]!;
  if (!triangles) return;
  // Vertices go with their triangles: painted at one that always is, culled where all are masked.
  const others = new Uint8Array(zones.length);
  for (let i = 0; i < indices.length; ++i) if (triangles[Math.floor(i / 3)] !== -1) others[indices[i]!] = 1;
  for (let i = 0; i < indices.length; ++i) {
    const [v, t] = [indices[i]!, Math.floor(i / 3)];
    if (triangles[t] === 1 && cosmeticTriangles[t] === 1) zones[v] = Zone.Cosmetic;
    else if (others[v] === 0) zones[v] = Zone.Culled;
  }
}

/** The parts of a cut target that masks change. */
interface Cut {
  sources: Uint32Array;
  weights: Float32Array;
  triangles: Uint32Array;
  zones: Uint8Array;
  cosmeticTriangles: Uint8Array;
}

/** Applies masks to a cut target, in place: pieces of a masked triangle are decided as the whole triangle was. */
export function applyMasksToCut(
  masks: Masks | undefined,
  indices: ArrayLike<number>,
  whole: Uint8Array,
  cut: Cut,
  isPartial: boolean,
): void {
  if (!masks) return;
  const targetVertexCount = whole.length;
  const isMasked = new Uint8Array(targetVertexCount);
  for (let t = 0; t < indices.length / 3; ++t)
    if (decided(masks, indices, whole, t, isPartial) !== undefined)
      for (let i = 3 * t; i < 3 * t + 3; ++i) isMasked[indices[i]!] = 1;
  for (let v = 0; v < cut.zones.length; ++v) {
    const source = v < targetVertexCount ? v : heaviestOf(cut, v - targetVertexCount);
    const mask = masks.vertices?.[source] ?? 0;
    if (mask !== 0 || (v < targetVertexCount && masks.triangles && isMasked[v] === 1)) cut.zones[v] = whole[source]!;
  }
  for (let piece = 0; piece < cut.cosmeticTriangles.length; ++piece)
    cut.cosmeticTriangles[piece] =
      decided(masks, indices, whole, cut.triangles[piece]!, isPartial) ?? cut.cosmeticTriangles[piece]!;
}

/** The source of a new vertex with the greatest weight. */
export function heaviestOf({ sources, weights }: Pick<Cut, 'sources' | 'weights'>, n: number): number {
  let best = 3 * n;
  for (let i = best + 1; i < 3 * n + 3; ++i) if (weights[i]! > weights[best]!) best = i;
  return sources[best]!;
}
