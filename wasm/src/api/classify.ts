import { callCore, useCore } from '../core/engine.js';
import { CagecastError, show } from '../core/error.js';
import type { CoreProjection } from '../core/module.js';
import type { HoleShare, SegmentStats } from '../core/records.js';
import { type ArrayKind, plainArray, showArray } from '../core/typed-arrays.js';
import { Visibility } from '../generated/enums.js';
import { count } from './mesh.js';
import { type ClassifyOptions, checkOptions } from './options.js';
import type { Classification, Projection } from './result.js';
import { checkReuse, handOver, type Reuse } from './reuse.js';

/**
 * Decides which segments are culled, and so the zone of every vertex.
 *
 * Cost: linear; about a millisecond for 10,000 triangles.
 *
 * @param options  With `reuse`, an earlier classification is overwritten and returned.
 * @throws {CagecastError} `badArgument` if `projection` is not what `project` returned; `badOption`.
 */
export function classify(projection: Projection, options?: ClassifyOptions & Reuse<Classification>): Classification {
  if (typeof projection !== 'object' || projection === null) throw wrong(` is ${show(projection)}`);
  const { core, overrides } = checkOptions('classify', options, projection.preset);
  const arrays = checkReuse('classify', options?.reuse);
  // Last: getters of the options may have written to it.
  const whole = checkProjection(projection);
  const result = callCore('classify', ({ workspace }) => workspace.classify(whole, core, overrides), arrays);
  return handOver(result, options?.reuse);
}

const wrong = (text: string, at = 0) =>
  new CagecastError('badArgument', 'classify', `projection${text}; pass what project() returned`, {
    argument: 'projection',
    at,
  });

/**
 * Checks that `projection` is complete and consistent, because it is plain data that may have been stored or sent. (The core checks
 * it as well, but cannot say which number is wrong.)
 * @returns the projection in the form that the core takes.
 */
function checkProjection(projection: Projection): CoreProjection {
  const arrayOf = <Kind extends ArrayKind>(name: keyof Projection, kind: Kind) => {
    const array = plainArray(projection[name], kind);
    if (!array) throw wrong(`.${name} is ${showArray(projection[name], kind)}, not a ${kind}`);
    return array;
  };
  const visibility = arrayOf('visibility', 'Uint8Array');
  const segments = arrayOf('segments', 'Uint32Array');
  const recovery = arrayOf('recovery', 'Uint32Array');
  const hiddenBy = arrayOf('hiddenBy', 'Uint32Array');
  const hiders = arrayOf('hiders', 'Uint32Array');
  const indices = arrayOf('indices', 'Uint32Array');
  const { segmentStats, holeShares } = projection;
  for (const [name, array] of Object.entries({ segmentStats, holeShares }))
    if (!Array.isArray(array)) throw wrong(`.${name} is ${show(array)}, not an array`);
  const vertices = visibility.length;
  if (segments.length !== vertices)
    throw wrong(` has ${vertices} entries of visibility but ${segments.length} of segments`);
  for (const [name, { length }] of Object.entries({ recovery, hiddenBy }))
    if (length !== 0 && length !== vertices)
      throw wrong(` has ${vertices} entries of visibility but ${length} of ${name}`);
  if (indices.length % 3 !== 0) throw wrong(`.indices has ${indices.length} entries, not 3 per triangle`);
  const { none, ignore, throughHole, maxTriangles } = useCore('classify', ({ module }) => ({
    none: module['CulledBy']!['none']!,
    ignore: module['CulledBy']!['ignore']!,
    throughHole: module.throughHole,
    maxTriangles: module.maxTriangles,
  }));
  const stats = Array.from(segmentStats, (segment, s) => ({
    ...checkSegment(segment, s),
    culledBy: segment.culledBy === 'ignore' ? ignore : none,
  }));
  const { shares, holes } = checkShares(holeShares, segmentStats.length, maxTriangles);

  const outOfRange = (name: string, array: Uint32Array | Uint8Array, limit: number, what: string) => {
    for (let i = 0; i < array.length; ++i)
      if (array[i]! >= limit) throw wrong(`.${name}[${i}] = ${array[i]} is out of range (${what})`, i);
  };
  outOfRange('segments', segments, stats.length, `${stats.length} segments`);
  outOfRange('recovery', recovery, throughHole + holes, `${holes} holes`);
  outOfRange('indices', indices, vertices, count(vertices, 'vertex'));
  outOfRange('visibility', visibility, Visibility.Beyond + 1, `0..${Visibility.Beyond}`);
  checkHiders(hiddenBy, hiders, stats.length);
  return { visibility, segments, segmentStats: stats, recovery, hiddenBy, hiders, holeShares: shares, indices };
}

const isBelow = (value: unknown, limit: number) =>
  Number.isInteger(value) && (value as number) >= 0 && (value as number) < limit;

function checkSegment(segment: SegmentStats, s: number): SegmentStats {
  const { points, area, beyondArea, exposedArea, coveredArea, depth, group } = segment ?? {};
  if (![points, area, beyondArea, exposedArea, coveredArea, depth, group].every(Number.isFinite))
    throw wrong(`.segmentStats[${s}] is not { points, area, exposedArea, coveredArea, … }`, s);
  // Fields that `classify` computes may be missing.
  const ratios = { threshold: Infinity, floor: Infinity, depth: Infinity, hole: Infinity };
  const computed = { ratios, coverage: 0, score: Infinity, confidence: 1, culled: false, culledBy: 'none' as const };
  return { points, area, beyondArea, exposedArea, coveredArea, depth, group, ...computed };
}

/** Whether there is a whole record at a place, and those that are enough as well. */
function isRecord(hiders: Uint32Array, start: number, segments: number): boolean {
  for (let record = start; record !== 0; record = hiders[record]!) {
    let at = record + 3;
    if (at > hiders.length || hiders[record]! >= record) return false;
    for (let rays = hiders[record + 2]!; rays > 0; --rays) {
      const end = at + 1 + (hiders[at] ?? Infinity);
      if (end > hiders.length || hiders.subarray(at + 1, end).some((segment) => segment >= segments)) return false;
      at = end;
    }
  }
  return true;
}

/** Checks that each vertex has 0 or a whole record. */
function checkHiders(hiddenBy: Uint32Array, hiders: Uint32Array, segments: number): void {
  let last = 0;
  for (let v = 0; v < hiddenBy.length; ++v) {
    if (hiddenBy[v] === last || hiddenBy[v] === 0) continue;
    last = hiddenBy[v]!;
    if (!isRecord(hiders, last, segments)) throw wrong(`.hiddenBy[${v}] = ${last} is no record of hiders`, v);
  }
}

/**
 * @param mostHoles  A limit no cage exceeds: the core allocates memory for as many holes as the largest number says.
 * @returns the number of holes, and plain copies of the shares.
 */
function checkShares(
  holeShares: readonly HoleShare[],
  segments: number,
  mostHoles: number,
): { shares: HoleShare[]; holes: number } {
  let holes = 0;
  const shares = Array.from(holeShares, (share, i) => {
    const { hole, segment, exposedArea, uncoveredArea, hiddenArea } = share ?? {};
    const isOrdered = isBelow(hole, mostHoles) && hole >= holes - 1;
    if (!isOrdered || !isBelow(segment, segments) || ![exposedArea, uncoveredArea, hiddenArea].every(Number.isFinite)) {
      throw wrong(
        `.holeShares[${i}] is not { hole, segment, exposedArea, uncoveredArea, hiddenArea } in the order of holes`,
        i,
      );
    }
    holes = hole + 1;
    return { hole, segment, exposedArea, uncoveredArea, hiddenArea };
  });
  return { shares, holes };
}
