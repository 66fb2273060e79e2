import { checkAnswer } from './answer.js';
import type { ClassifyAnswer, CoreProjection, ProjectedAnswer } from './bindings.js';
import { callCore } from './engine.js';
import { CagecastError, show } from './error.js';
import { checkInto, handOver, type Into } from './into.js';
import { checkMesh, count, type Mesh } from './mesh.js';
import {
  type ClassifyOptions,
  checkOptions,
  locksOf,
  type Preset,
  type ProjectOptions,
  type TransferOptions,
} from './options.js';

/** CPU time of each step, in milliseconds. */
export interface Timings {
  /** Checking the input and welding the target's vertices. */
  weld: number;
  /** Building the search trees of cage and target. */
  build: number;
  /** Step 1: the nearest point of the cage for every point of the target. */
  project: number;
  /** Step 2: self-intersection. */
  occluded: number;
  /** Step 3: cage intersection. */
  covered: number;
  /** Step 4: connected components, and their areas; with `votes` and `depths` what they need. */
  segments: number;
  /** Step 6: the occluded points that are seen from elsewhere. */
  secondLook: number;
  /** Step 7: what lies under the holes of the cage. */
  holes: number;
  /** Step 9: UVs per triangle corner. */
  seams: number;
  /** Step 5, and writing the answer out to vertices and triangles; 0 after `project`. */
  classify: number;
  /** All of it, from raw arrays to the answer. */
  total: number;
}

/** What is known of one connected component of the target. Areas are in squared units of the input. */
export interface SegmentStats {
  /** Welded points. */
  points: number;
  /** A: its whole area. */
  area: number;
  /** E: area of the points that the target does not occlude. */
  exposedArea: number;
  /** C: area of the points that the cage covers as well. */
  coveredArea: number;
  /** F = C / E, the share of the exposed area that the cage covers; 0 if nothing is exposed. */
  coverage: number;
  /** D: C, less where it lies deeper under the cage than what else lies there; C without the option `depths`. */
  sunkArea: number;
  /** Of its first vertex, in `target.groups`; 0 if the target has none. */
  group: number;
  /** The first of the segments that it is a copy of, maybe itself; itself without the option `depths`. */
  copyOf: number;
  /** Too little of it is covered, or a hole is meant for it: none of it may be painted. `false` until decided. */
  culled: boolean;
  /** It is culled, although enough of it is covered, because a hole of the cage seems to be meant for it; option `baredParts`. */
  bared: boolean;
  /**
   * How many times what is asked of it, or of it and its copies, it reaches: by its areas it is culled below 1. Infinity where
   * nothing is asked, and until decided.
   */
  margin: number;
}

/** What `project` and `transfer` both find out. Every array is the caller's own. */
export interface Projected {
  /** 2 per target vertex: its place in the cage's texture, NCZ or not. */
  uvs: Float32Array<ArrayBuffer>;
  /**
   * 2 per triangle corner, in the order of `target.indices`, with `seams: 'corner'`; else empty. Those of the vertices, but
   * where a seam of the cage's texture runs through a triangle. `splitVertices` makes a mesh of them.
   */
  cornerUvs: Float32Array<ArrayBuffer>;
  /** 1 per vertex, a `Zone`. After `project` nothing is `Culled` yet. */
  zones: Uint8Array<ArrayBuffer>;
  /** 1 per vertex: the nearest triangle of the cage. */
  triangles: Uint32Array<ArrayBuffer>;
  /** 1 per vertex: the distance to it, in units of the input. */
  distances: Float32Array<ArrayBuffer>;
  /** 1 per vertex: its segment. Segments are numbered by their first vertex. */
  segments: Uint32Array<ArrayBuffer>;
  /** 1 per segment. */
  segmentStats: SegmentStats[];
  /** How long each step took. */
  timings: Timings;
  /** Most memory in use at once during the call, beyond the inputs, in bytes. */
  peakBytes: number;
}

/** What of a segment lies nearest to the rim of a hole of the cage. Areas are in squared units of the input. */
export interface HoleShare {
  /** A connected component of the cage's open edges. */
  hole: number;
  segment: number;
  /** Of points that the target does not occlude. */
  exposedArea: number;
  /** Of those of them that the cage does not cover. */
  uncoveredArea: number;
  /**
   * Of points that the target occludes, and over which the cage is not either; 0 without an end of the self ray, `occlusionReach`,
   * and where nothing of the segment is covered.
   */
  hiddenArea: number;
}

/** The part of the answer that does not depend on the threshold; plain data that can be kept, sent or stored. */
export interface Projection extends Projected {
  /** The set of rules that it was made by, and that `classify` goes on with. */
  preset: Preset;
  /**
   * 1 per vertex, with `secondLook` or `holes`; else empty. Whether the vertex becomes cosmetic if its segment passes: 0 not, 1
   * always, 2 and on if the hole of that number less 2 is meant for what fails behind it.
   */
  restores: Uint32Array<ArrayBuffer>;
  /** With `holes`, ordered by hole: what `classify` needs to know of them. */
  holeShares: HoleShare[];
  /** The target's, 3 per triangle: what `classify` needs to decide per triangle. */
  indices: Uint32Array<ArrayBuffer>;
}

/** The part of the answer that depends on the threshold. Every array is the caller's own. */
export interface Classification {
  /** 1 per target vertex, a `Zone`. */
  zones: Uint8Array<ArrayBuffer>;
  /** 1 per target triangle: 1 if it may be painted; see the option `partialTriangles`. */
  cosmeticTriangles: Uint8Array<ArrayBuffer>;
  /** 1 per segment, with `culled` decided. */
  segmentStats: SegmentStats[];
}

/** Everything about a transfer. */
export interface TransferResult extends Projected, Classification {}

/** Numbers per segment, and per share of a hole, on the way to and from the core. */
const statsStride = 7;
const shareStride = 5;

/**
 * Carries the cage's UVs to the target and finds its Non-Cosmetic Zones, the vertices that must not be painted.
 *
 * @param cage    The mesh that the texture was drawn for; it must have UVs.
 * @param target  The mesh that receives it, in the same space and unit.
 * @param options  With `into`, an earlier result becomes this one.
 * @throws {CagecastError} for anything unusable in the meshes or options, and `outOfMemory`.
 *
 * @example
 * await init();
 * const result = transfer(cage, target, { threshold: 0.5 });
 * // The target moves: for every frame
 * transfer(cage, target, { threshold: 0.5, into: result });
 */
export function transfer(cage: Mesh, target: Mesh, options?: TransferOptions & Into<TransferResult>): TransferResult {
  const checked = checkOptions('transfer', options);
  const into = options?.into;
  const arrays = checkInto('transfer', into);
  const [cageMesh, targetMesh] = [checkMesh('transfer', 'cage', cage), checkMesh('transfer', 'target', target)];
  const { segments, groups } = checked.locks;
  const isLocked = Object.keys({ ...segments, ...groups }).length > 0;
  let locks: Uint8Array | undefined;
  if (isLocked) {
    // Which segments there are is known after the projection.
    const begun = callCore('transfer', (core) => core.beginTransfer(cageMesh, targetMesh, checked.core));
    checkAnswer('transfer', begun, cageMesh, targetMesh, checked);
    locks = locksOf('transfer', checked.locks, segmentStats(begun.segmentStats));
  }
  const answer = callCore('transfer', (core) =>
    locks ? core.endTransfer(locks, arrays) : core.transfer(cageMesh, targetMesh, checked.core, arrays),
  );
  checkAnswer('transfer', answer, cageMesh, targetMesh, checked);
  return handOver({ ...projected(answer, answer), cosmeticTriangles: answer.cosmeticTriangles }, into);
}

/**
 * Does the costly part of `transfer`, which does not depend on the threshold: steps 1 to 4 of the method, and what the later
 * ones need. Give the result to `classify`, for as many thresholds as you like.
 * @param options  With `into`, an earlier projection becomes this one.
 * @throws {CagecastError} as `transfer` does.
 */
export function project(cage: Mesh, target: Mesh, options?: ProjectOptions & Into<Projection>): Projection {
  const checked = checkOptions('project', options);
  const into = options?.into;
  const arrays = checkInto('project', into);
  const [cageMesh, targetMesh] = [checkMesh('project', 'cage', cage), checkMesh('project', 'target', target)];
  const answer = callCore('project', (core) => core.project(cageMesh, targetMesh, checked.core, arrays));
  checkAnswer('project', answer, cageMesh, targetMesh, checked);
  const { restores, indices } = answer;
  return handOver(
    { ...projected(answer), preset: checked.preset, restores, holeShares: holeShares(answer.holeShares), indices },
    into,
  );
}

/**
 * Decides which segments pass the threshold, and so the zone of every vertex, in microseconds.
 * @param options  With `into`, an earlier classification becomes this one.
 * @throws {CagecastError} `badArgument` if `projection` is not what `project` returned; and for unusable options.
 */
export function classify(projection: Projection, options?: ClassifyOptions & Into<Classification>): Classification {
  const whole = checkProjection(projection);
  const checked = checkOptions('classify', options, projection.preset);
  const into = options?.into;
  const arrays = checkInto('classify', into);
  const locks = locksOf('classify', checked.locks, projection.segmentStats);
  const answer = callCore('classify', (core) => core.classify(whole, checked.core, locks, arrays));
  checkAnswer('classify', answer, undefined, undefined, checked);
  const { zones, cosmeticTriangles } = answer;
  return handOver({ zones, cosmeticTriangles, segmentStats: segmentStats(whole.segmentStats, answer) }, into);
}

/** What stands in `culledSegments` for a segment that a hole bares. */
const kBared = 2;

/** What step 5 decided of each segment. */
type Decided = Pick<ClassifyAnswer, 'culledSegments' | 'margins'>;

function projected(answer: ProjectedAnswer, decided?: Decided): Projected {
  const { uvs, cornerUvs, zones, triangles, distances, segments } = answer;
  return {
    uvs,
    cornerUvs,
    zones,
    triangles,
    distances,
    segments,
    segmentStats: segmentStats(answer.segmentStats, decided),
    ...measured(answer.numbers),
  };
}

function measured(numbers: Float64Array): Pick<Projected, 'timings' | 'peakBytes'> {
  const [
    weld = 0,
    build = 0,
    project = 0,
    occluded = 0,
    covered = 0,
    segments = 0,
    secondLook = 0,
    holes = 0,
    seams = 0,
    classify = 0,
    total = 0,
    peakBytes = 0,
  ] = numbers;
  return {
    timings: { weld, build, project, occluded, covered, segments, secondLook, holes, seams, classify, total },
    peakBytes,
  };
}

function segmentStats(numbers: Float64Array, decided?: Decided): SegmentStats[] {
  const stats: SegmentStats[] = [];
  // One by one: an array taken apart would be another for every segment, of which a body may have hundreds.
  for (let s = 0, i = 0; i < numbers.length; ++s, i += statsStride) {
    const [exposedArea, coveredArea] = [numbers[i + 2]!, numbers[i + 3]!];
    stats.push({
      points: numbers[i]!,
      area: numbers[i + 1]!,
      exposedArea,
      coveredArea,
      coverage: exposedArea > 0 ? coveredArea / exposedArea : 0,
      sunkArea: numbers[i + 4]!,
      group: numbers[i + 5]!,
      copyOf: numbers[i + 6]!,
      culled: (decided?.culledSegments[s] ?? 0) !== 0,
      bared: decided?.culledSegments[s] === kBared,
      margin: decided?.margins[s] ?? Infinity,
    });
  }
  return stats;
}

function holeShares(numbers: Float64Array): HoleShare[] {
  const shares: HoleShare[] = [];
  for (let i = 0; i < numbers.length; i += shareStride) {
    shares.push({
      hole: numbers[i]!,
      segment: numbers[i + 1]!,
      exposedArea: numbers[i + 2]!,
      uncoveredArea: numbers[i + 3]!,
      hiddenArea: numbers[i + 4]!,
    });
  }
  return shares;
}

/**
 * Checks that `projection` is whole: it is plain data, which may have been stored or sent, and the core trusts it.
 * @returns it as the core takes it.
 */
function checkProjection(projection: Projection): CoreProjection {
  const wrong = (text: string, at = 0) =>
    new CagecastError('badArgument', `classify: projection${text}; pass what project() returned`, at);
  if (typeof projection !== 'object' || projection === null) throw wrong(` is ${show(projection)}`);
  const { zones, segments, segmentStats, restores, holeShares, indices } = projection;
  if (!(zones instanceof Uint8Array)) throw wrong(`.zones is ${show(zones)}, not a Uint8Array`);
  if (!(segments instanceof Uint32Array)) throw wrong(`.segments is ${show(segments)}, not a Uint32Array`);
  if (!(restores instanceof Uint32Array)) throw wrong(`.restores is ${show(restores)}, not a Uint32Array`);
  if (!(indices instanceof Uint32Array)) throw wrong(`.indices is ${show(indices)}, not a Uint32Array`);
  if (!Array.isArray(segmentStats)) throw wrong(`.segmentStats is ${show(segmentStats)}, not an array`);
  if (!Array.isArray(holeShares)) throw wrong(`.holeShares is ${show(holeShares)}, not an array`);
  if (zones.length !== segments.length) throw wrong(` has ${zones.length} zones but ${segments.length} segments`);
  if (restores.length !== 0 && restores.length !== zones.length)
    throw wrong(` has ${zones.length} zones but ${restores.length} restores`);
  if (indices.length % 3 !== 0) throw wrong(`.indices has ${indices.length} entries, not 3 per triangle`);
  const isSegment = (s: unknown) => Number.isInteger(s) && (s as number) >= 0 && (s as number) < segmentStats.length;

  const stats = new Float64Array(segmentStats.length * statsStride);
  segmentStats.forEach((segment, s) => {
    const { points, area, exposedArea, coveredArea, sunkArea, group, copyOf } = segment ?? {};
    const row = [points, area, exposedArea, coveredArea, sunkArea, group, copyOf];
    if (!row.every(Number.isFinite) || !isSegment(copyOf))
      throw wrong(`.segmentStats[${s}] is not { points, area, exposedArea, coveredArea, … }`, s);
    stats.set(row, s * statsStride);
  });
  const shares = new Float64Array(holeShares.length * shareStride);
  let holes = 0;
  holeShares.forEach((share, i) => {
    const { hole, segment, exposedArea, uncoveredArea, hiddenArea } = share ?? {};
    const areas = [exposedArea, uncoveredArea, hiddenArea];
    // Holes are numbered and in order; more than there are vertices would only ask for memory.
    if (
      !Number.isInteger(hole) ||
      hole < holes - 1 ||
      hole > 2 ** 28 ||
      !isSegment(segment) ||
      !areas.every(Number.isFinite)
    ) {
      throw wrong(
        `.holeShares[${i}] is not { hole, segment, exposedArea, uncoveredArea, hiddenArea } in the order of holes`,
        i,
      );
    }
    holes = hole + 1;
    shares.set([hole, segment, ...areas], i * shareStride);
  });

  const outOfRange = (name: string, array: Uint32Array, limit: number, what: string) => {
    for (let i = 0; i < array.length; ++i)
      if (array[i]! >= limit) throw wrong(`.${name}[${i}] = ${array[i]} is out of range (${what})`, i);
  };
  outOfRange('segments', segments, segmentStats.length, `${segmentStats.length} segments`);
  outOfRange('restores', restores, 2 + holes, `${holes} holes`);
  outOfRange('indices', indices, zones.length, count(zones.length, 'vertex'));
  for (let v = 0; v < zones.length; ++v) {
    if (zones[v]! > 2) throw wrong(`.zones[${v}] = ${zones[v]} is not a zone that project() gives (0..2)`, v);
  }
  return { zones, segments, segmentStats: stats, restores, holeShares: shares, indices };
}
