import type { HoleShare, SegmentStats, Timings } from '../core/records.js';
import type { Preset } from './options.js';

/** What `project` and `transfer` both return. The caller owns every array. */
export interface Projected {
  /** 2 per target vertex, in every zone: its UV in the cage's texture. */
  uvs: Float32Array<ArrayBuffer>;
  /**
   * 2 per triangle corner, in the order of `target.indices`, with `seams: 'corner'`; else, and with `steps.projection:
   * 'nearestVertex'`, empty. They differ from `uvs` only where a seam of the cage's texture runs through a triangle. `splitVertices`
   * makes a mesh from them.
   */
  cornerUvs: Float32Array<ArrayBuffer>;
  /** 1 per vertex: the nearest triangle of the cage; with `steps.projection: 'nearestVertex'` the first at the nearest vertex. */
  triangles: Uint32Array<ArrayBuffer>;
  /** 1 per vertex: the distance to it, or to that vertex, in units of the input. */
  distances: Float32Array<ArrayBuffer>;
  /** 1 per vertex: its segment. Segments are numbered by their first vertex. */
  segments: Uint32Array<ArrayBuffer>;
  /** 1 per segment. */
  segmentStats: SegmentStats[];
  /** How long each step took. */
  timings: Timings;
  /** Peak memory of the core during the call, and the size of the results, in bytes; without the inputs. */
  peakBytes: number;
}

/** The part of the result that does not depend on the threshold: plain data that can be kept, sent or stored. */
export interface Projection extends Projected {
  /** The preset of the projection, which is also the default preset for `classify`. */
  preset: Preset;
  /** 1 per vertex, a `Visibility`. */
  visibility: Uint8Array<ArrayBuffer>;
  /**
   * 1 per vertex, with `steps.recheck` or `steps.holes`; else, and with `nearestVertex`, empty. Whether an occluded or uncovered
   * vertex becomes cosmetic if its segment is kept: 0 never, 1 always, 2 and above if a culled segment lies behind hole number
   * `value - 2` and explains it. If the vertex has a record in `hiders`, what hides it must be culled as well.
   */
  recovery: Uint32Array<ArrayBuffer>;
  /** 1 per vertex: where its record in `hiders` begins; 0 if its recovery depends on no other segment. Empty if none does. */
  hiddenBy: Uint32Array<ArrayBuffer>;
  /**
   * With `steps.recheck` and not `nearestVertex`, what hides occluded vertices. One record after the other, from 1 on: where an earlier
   * record begins that is enough as well, or 0; how many rays must hit nothing but culled segments, how many rays follow, and for each
   * the number of segments that it hits, and the segments.
   */
  hiders: Uint32Array<ArrayBuffer>;
  /** 1 per hole and segment near it, with `steps.holes` and not `nearestVertex`; ordered by hole. */
  holeShares: HoleShare[];
  /** The target's indices, 3 per triangle. */
  indices: Uint32Array<ArrayBuffer>;
}

/** The part of the result that depends on the threshold. The caller owns every array. */
export interface Classification {
  /** 1 per target vertex, a `Zone`. */
  zones: Uint8Array<ArrayBuffer>;
  /** 1 per target triangle: 1 if it may be painted; see `steps.partialTriangles`. */
  cosmeticTriangles: Uint8Array<ArrayBuffer>;
  /** 1 per segment, with its verdict: `ratios`, `score`, `culled` and `culledBy`. */
  segmentStats: SegmentStats[];
}

/** The result of `transfer`. */
export interface TransferResult extends Projected, Classification {}
