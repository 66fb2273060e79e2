import { counted, type Finding, percent } from './finding.js';
import { UnionFind } from './geometry.js';
import type { Scene } from './scene.js';
import { countSets, type Edge } from './surface.js';

/** Samples along each side of the texture by which overlaps are found. */
const kSamples = 1024;
/** A UV triangle smaller than this, in units of the texture's area, shows nothing of it: a hundredth of a pixel of 4096². */
const kMinArea = 6e-10;
/** A cage is unfit if more than this share of its area has no UV area. */
const kMaxWithoutArea = 0.2;
/** Overlaps weigh half at this share of the used area; a mirrored layout uses all of it twice. */
const kMaxOverlap = 0.05;

/** The properties of a cage's UVs. */
export interface UvLayout {
  /** Vertices whose UV lies outside 0 … 1, and the share of the cage's vertices. */
  outside: { vertices: number; share: number };
  /** Triangles whose UVs have no area, and their share of the cage's own area. */
  withoutArea: { triangles: number; share: number };
  /** Share of the texture's used area that belongs to more than one triangle, and the maximum number of triangles. */
  overlap: { share: number; layers: number };
  /** Number of charts: connected components over edges that are shared in UV. */
  charts: number;
  /** Edges where charts meet, or a chart meets itself; and their share of the length of all inner edges. */
  seams: { edges: number; share: number };
  /** Share of the texture (0 … 1) that is used. */
  used: number;
}

/** Whether an edge has different UVs in its triangles, so that charts meet there, or a chart meets itself. */
export function isSeam({ uses }: Edge, indices: ArrayLike<number>, uvs: ArrayLike<number>): boolean {
  const ends = uses.map(({ triangle, corner, forward }) => {
    const [from, to] = [indices[3 * triangle + corner]!, indices[3 * triangle + ((corner + 1) % 3)]!];
    return forward ? ([from, to] as const) : ([to, from] as const);
  });
  const sameUv = (v: number, w: number) => uvs[2 * v] === uvs[2 * w] && uvs[2 * v + 1] === uvs[2 * w + 1];
  return !ends.every(([from, to]) => sameUv(from, ends[0]![0]) && sameUv(to, ends[0]![1]));
}

/** Measures a cage's UVs. */
export function uvLayoutOf({ surface, cage }: Scene): UvLayout {
  const { indices, positions } = cage;
  const uvs = cage.uvs ?? new Float32Array((positions.length / 3) * 2);
  let outside = 0;
  for (let v = 0; v < uvs.length; v += 2)
    if (Math.min(uvs[v]!, uvs[v + 1]!) < 0 || Math.max(uvs[v]!, uvs[v + 1]!) > 1) ++outside;

  let [flat, flatArea] = [0, 0];
  for (let t = 0; t < surface.areas.length; ++t) {
    if (surface.areas[t] === 0) continue;
    const [a, b, c] = [2 * indices[3 * t]!, 2 * indices[3 * t + 1]!, 2 * indices[3 * t + 2]!];
    const area =
      Math.abs((uvs[b]! - uvs[a]!) * (uvs[c + 1]! - uvs[a + 1]!) - (uvs[c]! - uvs[a]!) * (uvs[b + 1]! - uvs[a + 1]!)) /
      2;
    if (area >= kMinArea) continue;
    ++flat;
    flatArea += surface.areas[t]!;
  }

  const charts = new UnionFind(surface.areas.length);
  let [seams, seamLength, innerLength] = [0, 0, 0];
  for (const edge of surface.edges) {
    const { a, b, uses } = edge;
    if (uses.length < 2) continue;
    const size = Math.hypot(...[0, 1, 2].map((k) => positions[3 * a + k]! - positions[3 * b + k]!));
    innerLength += size;
    if (!isSeam(edge, indices, uvs)) for (const { triangle } of uses) charts.join(triangle, uses[0]!.triangle);
    else {
      ++seams;
      seamLength += size;
    }
  }
  const { used, share, layers } = coverageOf(
    uvs,
    indices,
    surface.areas.map((area, t) => (surface.doubled[t] === 1 ? 0 : area)),
  );
  return {
    outside: { vertices: outside, share: uvs.length > 0 ? outside / (uvs.length / 2) : 0 },
    withoutArea: { triangles: flat, share: surface.area > 0 ? flatArea / surface.area : 0 },
    overlap: { share, layers },
    charts: countSets(surface, charts),
    seams: { edges: seams, share: innerLength > 0 ? seamLength / innerLength : 0 },
    used,
  };
}

/** Whether UVs are so far outside of 0 … 1 that they may be in pixels. */
const areVast = (uvs: Float32Array): boolean => uvs.some((value) => value < -8 || value > 9);

/** The most rows of the grid that triangles may have together. Cages have less than a million; a hostile one need not. */
const kMaxRows = 2 ** 23;

/**
 * Counts, at the centres of a grid of pixels over the texture, which repeats, how many UV triangles use each.
 * A pixel on a shared edge belongs to one of its triangles alone: the edges of each are half open, as in rasterisers.
 * Cost: a few steps for each row of a triangle, however long it is and however often it goes round the texture; where triangles have too
 * many rows together, the grid is coarser.
 */
function coverageOf(
  uvs: Float32Array,
  indices: ArrayLike<number>,
  areas: Float64Array,
): { used: number; share: number; layers: number } {
  // UVs in pixels would take too long: then the whole layout is scaled to the grid.
  let [low, high] = [Infinity, -Infinity];
  for (const value of uvs) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  const vast = areVast(uvs);
  const [from, extent] = vast ? [low, high - low] : [0, 1];
  let rows = 0;
  for (let t = 0; t < areas.length; ++t) {
    if (areas[t] === 0) continue;
    const [a, b, c] = [0, 1, 2].map((k) => uvs[2 * indices[3 * t + k]! + 1]!) as [number, number, number];
    rows += ((Math.max(a, b, c) - Math.min(a, b, c)) / extent) * kSamples;
  }
  let samples = kSamples;
  for (; rows > kMaxRows && samples > 1; rows /= 2) samples /= 2;
  const scale = vast ? (samples - 1) / extent : samples;
  const grid = new RepeatingGrid(samples);
  const [x, y] = [new Float64Array(3), new Float64Array(3)];
  for (let t = 0; t < areas.length; ++t) {
    if (areas[t] === 0) continue;
    for (let k = 0; k < 3; ++k) {
      const v = 2 * indices[3 * t + k]!;
      x[k] = (uvs[v]! - from) * scale - 0.5;
      y[k] = (uvs[v + 1]! - from) * scale - 0.5;
    }
    fill(x, y, grid);
  }
  const { used, twice, layers } = grid.counts();
  return { used: vast ? 0 : used / samples ** 2, share: used > 0 ? twice / used : 0, layers };
}

/** Counts how often each pixel of a texture that repeats is covered by runs of pixels. */
class RepeatingGrid {
  /** By pixel, and one more in each row: how much more often it is covered than the pixel before it. */
  readonly #steps: Int32Array;
  /** By row: how often all of it is covered. */
  readonly #whole: Float64Array;

  constructor(readonly samples: number) {
    this.#steps = new Int32Array((samples + 1) * samples);
    this.#whole = new Float64Array(samples);
  }

  /** Covers pixels of a row, from one to before another. */
  cover(row: number, from: number, to: number): void {
    const { samples } = this;
    const line = modulo(row, samples);
    const rounds = Math.floor((to - from) / samples);
    this.#whole[line]! += rounds;
    const first = line * (samples + 1) + modulo(from, samples);
    const last = first + (to - from) - rounds * samples;
    const end = (line + 1) * (samples + 1) - 1;
    ++this.#steps[first]!;
    if (last <= end) --this.#steps[last]!;
    else {
      // Goes round.
      --this.#steps[end]!;
      ++this.#steps[line * (samples + 1)]!;
      --this.#steps[last - samples]!;
    }
  }

  /** How many pixels are covered, and more than once; and how often at most. */
  counts(): { used: number; twice: number; layers: number } {
    let [used, twice, layers] = [0, 0, 0];
    for (let row = 0; row < this.samples; ++row) {
      let count = this.#whole[row]!;
      for (let column = 0; column < this.samples; ++column) {
        count += this.#steps[row * (this.samples + 1) + column]!;
        if (count > 0) ++used;
        if (count > 1) ++twice;
        if (count > layers) layers = count;
      }
    }
    return { used, twice, layers };
  }
}

const modulo = (value: number, by: number): number => ((value % by) + by) % by;

/** Covers every whole point inside a triangle, row by row; of its edges, the left ones belong to it. */
function fill(x: ArrayLike<number>, y: ArrayLike<number>, grid: RepeatingGrid): void {
  const firstRow = Math.ceil(Math.min(y[0]!, y[1]!, y[2]!));
  const lastRow = Math.ceil(Math.max(y[0]!, y[1]!, y[2]!)) - 1;
  for (let row = firstRow; row <= lastRow; ++row) {
    let [left, right] = [Infinity, -Infinity];
    for (let k = 0; k < 3; ++k) {
      // From the lower end up, so that both triangles of an edge compute the same crossing.
      const next = (k + 1) % 3;
      const upward = y[k]! < y[next]! || (y[k] === y[next] && x[k]! < x[next]!);
      const [from, to] = upward ? [k, next] : [next, k];
      if (!(y[from]! <= row && row < y[to]!)) continue;
      const crossing = x[from]! + ((row - y[from]!) / (y[to]! - y[from]!)) * (x[to]! - x[from]!);
      if (crossing < left) left = crossing;
      if (crossing > right) right = crossing;
    }
    if (Math.ceil(left) < Math.ceil(right)) grid.cover(row, Math.ceil(left), Math.ceil(right));
  }
}

/** UVs outside the texture, without area, overlapping, in too many charts, or of a set that may be the wrong one. */
export function checkUvs(
  { surface, cage }: Scene,
  { outside, withoutArea, overlap, charts, seams }: UvLayout,
): Finding[] {
  const findings: Finding[] = [];
  if (withoutArea.triangles > 0) {
    findings.push({
      code: 'uvsWithoutArea',
      weight: withoutArea.share / kMaxWithoutArea,
      sentence: `${percent(withoutArea.share)} of the cage's area (${counted(withoutArea.triangles, 'triangle')}) has UVs without area, so a single point of the texture is smeared over it`,
      advice: 'Unwrap these triangles.',
      numbers: { share: withoutArea.share, triangles: withoutArea.triangles },
    });
  }
  if (outside.vertices > 0) {
    const vast = areVast(cage.uvs!);
    findings.push({
      code: 'uvsOutside',
      weight: vast ? 1.5 : 0.1 + 0.8 * outside.share,
      sentence: `${counted(outside.vertices, 'vertex', 'vertices')} of the cage (${percent(outside.share)}) ${outside.vertices === 1 ? 'has its UV' : 'have their UVs'} outside 0 … 1${vast ? ', some so far that they may be in pixels' : ''}`,
      advice: 'This is fine if the texture should repeat; otherwise move the UVs into 0 … 1.',
      numbers: { vertices: outside.vertices, share: outside.share },
    });
  }
  // A pixel or two at an edge may come from rounding.
  if (overlap.share > 1e-4) {
    findings.push({
      code: 'uvsOverlap',
      weight: overlap.layers > 4 && overlap.share > 0.5 ? 1.2 : Math.min(0.9, (0.5 * overlap.share) / kMaxOverlap),
      sentence: `${percent(overlap.share)} of the used area of the texture belongs to more than one triangle of the cage, at most to ${overlap.layers}`,
      advice: 'This is fine if both sides should look alike (a mirrored layout); otherwise unwrap without overlaps.',
      numbers: { share: overlap.share, layers: overlap.layers },
    });
  }
  const others = cage.otherUvSets ?? [];
  if (others.length > 0) {
    findings.push({
      code: 'uvsUnknown',
      weight: 0.5,
      sentence: `Nothing tells in which UV set of the cage the texture was drawn; besides the one that was taken, with other UVs: ${others.join(', ')}`,
      advice: 'Choose the set by its number, or leave no other in the file of the cage.',
      numbers: { others: [...others] },
    });
  }
  const perChart = surface.areas.length / charts;
  if (charts > 8 && perChart < 12) {
    findings.push({
      code: 'uvsInPieces',
      weight: perChart < 3 ? 0.6 : 0.3,
      sentence: `The cage's UVs are in ${charts} charts of ${perChart.toFixed(1)} triangles on average; ${percent(seams.share)} of its edges, by length, are seams`,
      advice: 'Unwrap it into fewer, larger charts: every seam may be visible, and makes the texture harder to draw.',
      numbers: { charts, seams: seams.share },
    });
  }
  return findings;
}
