import { callCore, dropInstance, type Answer, type ProjectAnswer } from './engine.js';
import { CagecastError, coreCodes, show } from './error.js';
import { checkMesh, count, type CheckedMesh, type Mesh } from './mesh.js';
import { resolveOptions, type ClassifyOptions, type ProjectOptions, type ResolvedOptions, type TransferOptions } from './options.js';

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
  /** Step 4: connected components, and their areas. */
  segments: number;
  /** Step 5: the threshold; 0 after `project`. */
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
  /** Too little of it is covered: none of it may be painted. `false` until decided. */
  culled: boolean;
}

/** What `project` and `transfer` both find out. Every array is the caller's own. */
export interface Projected {
  /** 2 per target vertex: its place in the cage's texture, NCZ or not. */
  uvs: Float32Array<ArrayBuffer>;
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

/** The part of the answer that does not depend on the threshold; plain data that can be kept, sent or stored. */
export interface Projection extends Projected {
  /** The target's, 3 per triangle: what `classify` needs to decide per triangle. */
  indices: Uint32Array<ArrayBuffer>;
}

/** The part of the answer that depends on the threshold. Every array is the caller's own. */
export interface Classification {
  /** 1 per target vertex, a `Zone`. */
  zones: Uint8Array<ArrayBuffer>;
  /** 1 per target triangle: 1 if all three corners may be painted. */
  cosmeticTriangles: Uint8Array<ArrayBuffer>;
  /** 1 per segment, with `culled` decided. */
  segmentStats: SegmentStats[];
}

/** Everything about a transfer. */
export interface TransferResult extends Projected, Classification {}

const statsStride = 4;

/**
 * Carries the cage's UVs to the target and finds its Non-Cosmetic Zones, the vertices that must not be painted.
 *
 * @param cage    The mesh that the texture was drawn for; it must have UVs.
 * @param target  The mesh that receives it, in the same space and unit.
 * @throws {CagecastError} for anything unusable in the meshes or options, and `outOfMemory`.
 *
 * @example
 * await init();
 * const { uvs, zones } = transfer(cage, target, { threshold: 0.5 });
 */
export function transfer(cage: Mesh, target: Mesh, options?: TransferOptions): TransferResult {
  const resolved = resolveOptions('transfer', options);
  const cageMesh = checkMesh('transfer', 'cage', cage);
  const targetMesh = checkMesh('transfer', 'target', target);
  const answer = callCore('transfer', (core) =>
    core.transfer(cageMesh, targetMesh, resolved.projection, resolved.weldTolerance, resolved.threshold),
  );
  check('transfer', answer, cageMesh, targetMesh, resolved);
  return {
    ...projected(answer, answer.culledSegments),
    cosmeticTriangles: answer.cosmeticTriangles,
  };
}

/**
 * Does the costly part of `transfer`, which does not depend on the threshold: steps 1 to 4 of the method.
 * Give the result to `classify`, for as many thresholds as you like.
 * @throws {CagecastError} as `transfer` does.
 */
export function project(cage: Mesh, target: Mesh, options?: ProjectOptions): Projection {
  const resolved = resolveOptions('project', options);
  const cageMesh = checkMesh('project', 'cage', cage);
  const targetMesh = checkMesh('project', 'target', target);
  const answer = callCore('project', (core) => core.project(cageMesh, targetMesh, resolved.projection, resolved.weldTolerance));
  check('project', answer, cageMesh, targetMesh, resolved);
  return { ...projected(answer), indices: Uint32Array.from<number>(targetMesh.indices) };
}

/**
 * Decides which segments pass the threshold, and so the zone of every vertex, in microseconds.
 * @throws {CagecastError} `badArgument` if `projection` is not what `project` returned, `badThreshold`.
 */
export function classify(projection: Projection, options?: ClassifyOptions): Classification {
  const resolved = resolveOptions('classify', options);
  const stats = checkProjection(projection);
  const answer = callCore('classify', (core) =>
    core.classify(projection.zones, projection.segments, stats, projection.indices, resolved.threshold),
  );
  check('classify', answer, undefined, undefined, resolved);
  return {
    zones: answer.zones,
    cosmeticTriangles: answer.cosmeticTriangles,
    segmentStats: segmentStats(stats, answer.culledSegments),
  };
}

function projected(answer: ProjectAnswer, culled?: Uint8Array): Projected {
  const [weld = 0, build = 0, project = 0, occluded = 0, covered = 0, segments = 0, classify = 0, total = 0] = answer.timings;
  return {
    uvs: answer.uvs,
    zones: answer.zones,
    triangles: answer.triangles,
    distances: answer.distances,
    segments: answer.segments,
    segmentStats: segmentStats(answer.segmentStats, culled),
    timings: { weld, build, project, occluded, covered, segments, classify, total },
    peakBytes: answer.peakBytes,
  };
}

function segmentStats(numbers: Float64Array, culled?: Uint8Array): SegmentStats[] {
  return Array.from({ length: numbers.length / statsStride }, (_, s) => {
    const [points = 0, area = 0, exposedArea = 0, coveredArea = 0] = numbers.subarray(s * statsStride, (s + 1) * statsStride);
    const coverage = exposedArea > 0 ? coveredArea / exposedArea : 0;
    return { points, area, exposedArea, coveredArea, coverage, culled: culled?.[s] === 1 };
  });
}

/**
 * Checks that `projection` is whole: it is plain data, which may have been stored or sent, and the core trusts it.
 * @returns its `segmentStats` as numbers for the core.
 */
function checkProjection(projection: Projection): Float64Array {
  const wrong = (text: string, at = 0) => new CagecastError('badArgument', `classify: projection${text}; pass what project() returned`, at);
  if (typeof projection !== 'object' || projection === null) throw wrong(` is ${show(projection)}`);
  const { zones, segments, segmentStats, indices } = projection;
  if (!(zones instanceof Uint8Array)) throw wrong(`.zones is ${show(zones)}, not a Uint8Array`);
  if (!(segments instanceof Uint32Array)) throw wrong(`.segments is ${show(segments)}, not a Uint32Array`);
  if (!(indices instanceof Uint32Array)) throw wrong(`.indices is ${show(indices)}, not a Uint32Array`);
  if (!Array.isArray(segmentStats)) throw wrong(`.segmentStats is ${show(segmentStats)}, not an array`);
  if (zones.length !== segments.length) throw wrong(` has ${zones.length} zones but ${segments.length} segments`);
  if (indices.length % 3 !== 0) throw wrong(`.indices has ${indices.length} entries, not 3 per triangle`);
  for (let v = 0; v < segments.length; ++v) {
    if (segments[v]! >= segmentStats.length) {
      throw wrong(`.segments[${v}] = ${segments[v]} is out of range (${segmentStats.length} segments)`, v);
    }
    if (zones[v]! > 2) throw wrong(`.zones[${v}] = ${zones[v]} is not a zone that project() gives (0..2)`, v);
  }
  for (let i = 0; i < indices.length; ++i) {
    if (indices[i]! >= zones.length) throw wrong(`.indices[${i}] = ${indices[i]} is out of range (${count(zones.length, 'vertex')})`, i);
  }
  const numbers = new Float64Array(segmentStats.length * statsStride);
  segmentStats.forEach((stats, s) => {
    const { points, area, exposedArea, coveredArea } = stats ?? {};
    const row = [points, area, exposedArea, coveredArea];
    if (!row.every(Number.isFinite)) throw wrong(`.segmentStats[${s}] is not { points, area, exposedArea, coveredArea, … }`, s);
    numbers.set(row, s * statsStride);
  });
  return numbers;
}

/** Throws what the core reports, in words: function, argument, element, value and limit. */
function check(fn: string, answer: Answer, cage: CheckedMesh | undefined, target: CheckedMesh | undefined, options: ResolvedOptions): void {
  if (answer.code === 0) return;
  const code = coreCodes[answer.code - 1] ?? 'internal';
  if (code === 'outOfMemory') dropInstance();
  const name = answer.argument === 1 ? 'cage' : 'target';
  const { at } = answer;
  throw new CagecastError(code, `${fn}: ${describe(code, at, name, name === 'cage' ? cage : target, options)}`, at);
}

function describe(code: string, at: number, name: string, mesh: CheckedMesh | undefined, options: ResolvedOptions): string {
  if (code === 'badThreshold') return `options.threshold = ${options.threshold} is not within 0..1`;
  if (code === 'badWeldTolerance') return `options.weldTolerance = ${options.weldTolerance} is not within 0..0.01`;
  if (code === 'outOfMemory') return 'not enough memory for this target and cage';
  if (mesh === undefined) return `failed (${code})`;
  const { positions, indices, uvs, groups } = mesh;
  const vertices = count(positions.length / 3, 'vertex');
  switch (code) {
    case 'emptyMesh':
      return `${name} has no ${positions.length === 0 ? 'vertices' : 'triangles'}; at least one is needed`;
    case 'positionsNotTriples':
      return `${name}.positions has ${positions.length} numbers, not 3 per vertex`;
    case 'indicesNotTriples':
      return `${name}.indices has ${indices.length} entries, not 3 per triangle`;
    case 'missingUvs':
      return `${name}.uvs is missing: the texture is drawn in the cage's UVs, 2 per vertex`;
    case 'uvCountMismatch':
      return `${name}.uvs has ${uvs.length} numbers, not 2 for each of ${vertices}`;
    case 'groupCountMismatch':
      return `${name}.groups has ${groups.length} entries, not 1 for each of ${vertices}`;
    case 'indexOutOfRange':
      return `${name}.indices[${at}] = ${indices[at]} is out of range (${vertices})`;
    case 'nonFinitePosition':
      return `${name}.positions[${at}] = ${positions[at]} is not a finite number`;
    case 'nonFiniteUv':
      return `${name}.uvs[${at}] = ${uvs[at]} is not a finite number`;
    case 'noUsableCageTriangle':
      return 'cage has no triangle with an area';
    case 'tooLarge':
      return at < positions.length && positions.length / 3 <= 2 ** 28 && indices.length / 3 <= 2 ** 28
        ? `${name}.positions[${at}] = ${positions[at]} is out of all proportion (farther from the origin than 1e8 diagonals of the target)`
        : `${name} has ${vertices} and ${count(indices.length / 3, 'triangle')}, more than ${2 ** 28} of a kind`;
    default:
      return `failed (${code})`;
  }
}
