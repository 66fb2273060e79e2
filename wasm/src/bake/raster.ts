import { CagecastError } from '../core/error.js';
import { fillGutter, type Wrapping } from './gutter.js';
import { type Image, linearOf, shareOf } from './image.js';

/** How a texture goes on beyond its border, as in glTF. */
export type Wrap = 'repeat' | 'mirror' | 'clamp';

/** What an image holds: colours in sRGB, other values (roughness, say), or a normal map. */
export type Kind = 'color' | 'data' | 'normal';

/** Samples per texel and direction: two for edges, more where the image is finer than the texture. */
const kFewestSamples = 2;
const kMaxSamples = 4;
/**
 * If the image has fewer texels per texel than this, a texel shows one place, as a mean would blur the image: its middle in the
 * triangle that has most of it, or else the middle of what each triangle has. Samples are cubic, as bilinear ones blur too.
 */
const kCoarse = 1.5;
/** How cubic samples weigh the outer texels: −1/2 is the smoothest kernel, −1 the sharpest one in use. */
const kSharpness = -0.75;

/** A triangle larger than this, in textures, would be drawn for minutes; its UVs are a mistake. */
const kMaxRepeats = 64;

/** Where the corners of triangles are in a texture. */
export type Corners = ArrayLike<number>;

/** What a painted triangle shows. */
interface Shown {
  /** 6 numbers: the UVs of its corners in the image that is sampled. Undefined if only the mask is wanted. */
  corners?: Corners | undefined;
  /** For normal maps, 4 numbers: the matrix, row by row, from the tangent space of the image to that of the texture. */
  turn?: readonly [number, number, number, number] | undefined;
}

/**
 * An image resampled into other UVs, triangle by triangle. Where triangles overlap, the first one wins. Samples on a shared edge
 * belong to exactly one triangle.
 */
export class Raster {
  readonly width: number;
  readonly height: number;
  readonly #image: Image;
  readonly #samples: number;
  readonly #isCoarse: boolean;
  /** Where columns and rows are that lie beyond the border. */
  readonly columnOf: Wrapping;
  readonly rowOf: Wrapping;
  /** What a byte of the image stands for. */
  readonly table: Float32Array;
  /** 4 per texel: premultiplied RGBA, linear; sums over samples, and means once finished. */
  readonly colors: Float32Array;
  /** 1 per texel: how many of its samples are covered. */
  readonly #covered: Uint8Array;
  /** 1 per texel: how many of these are painted. */
  readonly #painted: Uint8Array;
  /** 1 per texel: 1 if one triangle has most of it, whose colour it has. */
  readonly #isSettled: Uint8Array;
  /** 1 per texel: the part that came first, counted from 1. */
  readonly #owners: Uint16Array;
  /** 1 per texel: samples that came second. */
  readonly #second: Uint8Array;
  /** 1 per part: whether it shares texels with itself or another. */
  readonly #sharing = new Set<number>();
  /** Spans of the rows of samples in a row of texels. */
  readonly #lefts = new Float64Array(kMaxSamples);
  readonly #rights = new Float64Array(kMaxSamples);
  /** Premultiplied RGBA, linear, of the last sample. */
  readonly #sum = new Float64Array(4);
  /** What a cubic sample works on. */
  readonly #cubic = {
    across: new Float64Array(4),
    down: new Float64Array(4),
    columns: new Int32Array(4),
    rows: new Int32Array(4),
  };
  #refused = 0;
  #laid = 0;

  /**
   * @param size     Of the texture, in texels.
   * @param image    What is sampled; it repeats.
   * @param density  Texels of the image per texel of the texture, in one direction.
   */
  constructor(
    { width, height }: { width: number; height: number },
    wraps: readonly [Wrap, Wrap],
    image: Image,
    density: number,
    kind: Kind,
  ) {
    this.width = width;
    this.height = height;
    this.#image = image;
    this.#samples = Math.max(kFewestSamples, Math.min(kMaxSamples, Math.ceil(density)));
    this.#isCoarse = density < kCoarse;
    this.columnOf = wrapping(width, wraps[0]);
    this.rowOf = wrapping(height, wraps[1]);
    this.table = kind === 'color' ? linearOf : shareOf;
    const texels = width * height;
    this.colors = new Float32Array(4 * texels);
    this.#covered = new Uint8Array(texels);
    this.#painted = new Uint8Array(texels);
    this.#isSettled = new Uint8Array(texels);
    this.#owners = new Uint16Array(texels);
    this.#second = new Uint8Array(texels);
  }

  /** Share of the paint that was left out, because its texels were taken. */
  get lost(): number {
    return this.#refused === 0 ? 0 : this.#refused / (this.#refused + this.#laid);
  }

  /** The covered texels of which at least half is claimed twice, as a share of all covered ones, and the numbers of parts there. */
  claimedTwice(): { share: number; parts: number[] } {
    const half = 0.5 * this.#samples ** 2;
    let [twice, all] = [0, 0];
    for (let texel = 0; texel < this.#covered.length; ++texel) {
      if (this.#covered[texel] !== 0) ++all;
      if (this.#second[texel]! >= half) ++twice;
    }
    return { share: all === 0 ? 0 : twice / all, parts: [...this.#sharing].sort((a, b) => a - b) };
  }

  /**
   * Draws a triangle.
   * @param own    6 numbers: the UVs of its corners in the texture.
   * @param shown  Its place in the image; undefined for unpainted triangles, which only take room.
   * @param part   The number of the part that it belongs to.
   */
  draw(own: Corners, shown: Shown | undefined, part: number): void {
    const n = this.#samples;
    const [width, height] = [this.width * n, this.height * n];
    // In sample coordinates: samples lie at integers.
    const [x0, x1, x2] = [own[0]! * width - 0.5, own[2]! * width - 0.5, own[4]! * width - 0.5];
    const [y0, y1, y2] = [own[1]! * height - 0.5, own[3]! * height - 0.5, own[5]! * height - 0.5];
    const area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
    if (area === 0) return;
    const [top, end] = [Math.ceil(Math.min(y0, y1, y2)), Math.ceil(Math.max(y0, y1, y2))];
    if (Math.abs(area) > kMaxRepeats * 2 * width * height || end - top > kMaxRepeats * height)
      throw new CagecastError(
        'badArgument',
        '',
        `a triangle extends over more than ${kMaxRepeats} textures in UV space`,
      );
    // UVs are linear on the triangle.
    let [u, ux, uy, v, vx, vy] = [0, 0, 0, 0, 0, 0];
    if (shown?.corners) {
      const c = shown.corners;
      const [u1, u2, v1, v2] = [c[2]! - c[0]!, c[4]! - c[0]!, c[3]! - c[1]!, c[5]! - c[1]!];
      ux = (u1 * (y2 - y0) - u2 * (y1 - y0)) / area;
      uy = (u2 * (x1 - x0) - u1 * (x2 - x0)) / area;
      vx = (v1 * (y2 - y0) - v2 * (y1 - y0)) / area;
      vy = (v2 * (x1 - x0) - v1 * (x2 - x0)) / area;
      u = c[0]! - ux * x0 - uy * y0;
      v = c[1]! - vx * x0 - vy * y0;
    }
    const edges = [x0, y0, x1, y1, x1, y1, x2, y2, x2, y2, x0, y0];
    const [lefts, rights] = [this.#lefts, this.#rights];
    for (let y = Math.floor(top / n); y < end / n; ++y) {
      const row = this.rowOf(y);
      if (row < 0) continue;
      let [left, right] = [Infinity, -Infinity];
      for (let k = 0; k < n; ++k) {
        spanOf(edges, y * n + k, k, lefts, rights);
        left = Math.min(left, lefts[k]!);
        right = Math.max(right, rights[k]!);
      }
      for (let x = Math.floor(left / n); x < right / n; ++x) {
        const column = this.columnOf(x);
        if (column < 0) continue;
        let [count, across, down] = [0, 0, 0];
        for (let k = 0; k < n; ++k) {
          const [first, stop] = [Math.max(lefts[k]!, x * n), Math.min(rights[k]!, (x + 1) * n)];
          if (stop <= first) continue;
          count += stop - first;
          across += 0.5 * (stop - first) * (first + stop - 1);
          down += (stop - first) * (y * n + k);
        }
        if (count === 0) continue;
        const texel = row * this.width + column;
        const taken = this.#claim(texel, count, shown !== undefined, part);
        if (!shown?.corners || taken === 0) continue;
        if (this.#isCoarse) {
          const isMost = 2 * count > n * n;
          const times = this.#timesOf(texel, taken, isMost);
          if (times === 0) continue;
          const sx = isMost ? (x + 0.5) * n - 0.5 : across / count;
          const sy = isMost ? (y + 0.5) * n - 0.5 : down / count;
          this.#addCubic(4 * texel, u + ux * sx + uy * sy, v + vx * sx + vy * sy, times, shown.turn);
          continue;
        }
        for (let k = 0, left = taken; k < n && left > 0; ++k) {
          const stop = Math.min(rights[k]!, (x + 1) * n);
          for (let sx = Math.max(lefts[k]!, x * n); sx < stop && left > 0; ++sx, --left) {
            const sy = y * n + k;
            this.#addSample(4 * texel, u + ux * sx + uy * sy, v + vx * sx + vy * sy, shown.turn);
          }
        }
      }
    }
  }

  /** Claims samples of a texel. @returns how many of them were free. */
  #claim(texel: number, count: number, isPainted: boolean, part: number): number {
    const before = this.#covered[texel]!;
    const taken = Math.min(count, this.#samples ** 2 - before);
    if (taken < count) {
      if (isPainted || this.#painted[texel] !== 0) this.#refused += count - taken;
      this.#second[texel] = Math.min(255, this.#second[texel]! + count - taken);
      this.#sharing.add(part).add(this.#owners[texel]! - 1);
    }
    if (before === 0) this.#owners[texel] = part + 1;
    this.#covered[texel] = before + taken;
    if (isPainted) {
      this.#painted[texel]! += taken;
      this.#laid += taken;
    }
    return taken;
  }

  /** How many samples a triangle stands for. The one with most of a texel stands for all that are painted, which `finish` counts. */
  #timesOf(texel: number, taken: number, isMost: boolean): number {
    if (this.#isSettled[texel] === 1) return 0;
    if (!isMost) return taken;
    this.#isSettled[texel] = 1;
    if (taken < this.#painted[texel]!) this.colors.fill(0, 4 * texel, 4 * texel + 4);
    return 1;
  }

  /** Adds a bilinear sample of the image. */
  #addSample(to: number, u: number, v: number, turn: Shown['turn']): void {
    const { width, height, data } = this.#image;
    const [x, y] = [u * width - 0.5, v * height - 0.5];
    const [column, row] = [Math.floor(x), Math.floor(y)];
    const [right, down] = [x - column, y - row];
    const isInner = column >= 0 && row >= 0 && column < width - 1 && row < height - 1;
    const c0 = isInner ? column : modulo(column, width);
    const c1 = isInner ? column + 1 : modulo(column + 1, width);
    const r0 = width * (isInner ? row : modulo(row, height));
    const r1 = isInner ? r0 + width : width * modulo(row + 1, height);
    const [a, b, c, d] = [4 * (r0 + c0), 4 * (r0 + c1), 4 * (r1 + c0), 4 * (r1 + c1)];
    const wa = ((1 - right) * (1 - down) * data[a + 3]!) / 255;
    const wb = (right * (1 - down) * data[b + 3]!) / 255;
    const wc = ((1 - right) * down * data[c + 3]!) / 255;
    const wd = (right * down * data[d + 3]!) / 255;
    const alpha = wa + wb + wc + wd;
    if (alpha === 0) return;
    const [table, sum] = [this.table, this.#sum];
    for (let k = 0; k < 3; ++k)
      sum[k] =
        wa * table[data[a + k]!]! + wb * table[data[b + k]!]! + wc * table[data[c + k]!]! + wd * table[data[d + k]!]!;
    sum[3] = alpha;
    this.#add(to, 1, turn);
  }

  /**
   * Adds a cubic sample of the image, from 4 × 4 texels. It stays between the four nearest ones, so that no edge has a halo.
   * @param times  How many samples it stands for.
   */
  #addCubic(to: number, u: number, v: number, times: number, turn: Shown['turn']): void {
    const { width, height, data } = this.#image;
    const { across, down, columns, rows } = this.#cubic;
    const table = this.table;
    const [x, y] = [u * width - 0.5, v * height - 0.5];
    const [column, row] = [Math.floor(x), Math.floor(y)];
    cubicWeights(x - column, across);
    cubicWeights(y - row, down);
    for (let i = 0; i < 4; ++i) {
      columns[i] = 4 * modulo(column - 1 + i, width);
      rows[i] = 4 * width * modulo(row - 1 + i, height);
    }
    const [a, b, c, d] = [
      rows[1]! + columns[1]!,
      rows[1]! + columns[2]!,
      rows[2]! + columns[1]!,
      rows[2]! + columns[2]!,
    ];
    // Between four transparent texels lies nothing.
    if (data[a + 3]! + data[b + 3]! + data[c + 3]! + data[d + 3]! === 0) return;
    let [red, green, blue, alpha] = [0, 0, 0, 0];
    for (let j = 0; j < 4; ++j) {
      for (let i = 0; i < 4; ++i) {
        const at = rows[j]! + columns[i]!;
        const weight = (across[i]! * down[j]! * data[at + 3]!) / 255;
        red += weight * table[data[at]!]!;
        green += weight * table[data[at + 1]!]!;
        blue += weight * table[data[at + 2]!]!;
        alpha += weight;
      }
    }
    const valueAt = (at: number, k: number): number => (data[at + 3]! / 255) * (k === 3 ? 1 : table[data[at + k]!]!);
    /** Keeps a sum between the four nearest values, and a colour below its alpha. */
    const clamp = (sum: number, most: number, k: number): number => {
      const p = valueAt(a, k);
      const q = valueAt(b, k);
      const r = valueAt(c, k);
      const s = valueAt(d, k);
      return Math.min(most, Math.max(p, q, r, s), Math.max(Math.min(p, q, r, s), sum));
    };
    const share = clamp(alpha, 1, 3);
    this.#sum.set([clamp(red, share, 0), clamp(green, share, 1), clamp(blue, share, 2), share]);
    this.#add(to, times, turn);
  }

  /** Adds what was sampled last, turned if it is a normal. */
  #add(to: number, times: number, turn: Shown['turn']): void {
    const [sum, colors] = [this.#sum, this.colors];
    if (turn) {
      const half = 0.5 * sum[3]!;
      const [across, up] = [sum[0]! - half, sum[1]! - half];
      sum[0] = turn[0] * across + turn[1] * up + half;
      sum[1] = turn[2] * across + turn[3] * up + half;
    }
    for (let k = 0; k < 4; ++k) colors[to + k]! += times * sum[k]!;
  }

  /**
   * Makes means of sums, and fills the gutter. Call it once, after all triangles.
   * @returns 1 per texel: how much of what is covered is painted, 0 to 255, without the gutter.
   */
  finish(gutter: number): Uint8Array<ArrayBuffer> {
    const [colors, covered, painted] = [this.colors, this.#covered, this.#painted];
    const mask = new Uint8Array(covered.length);
    for (let texel = 0; texel < covered.length; ++texel) {
      if (painted[texel] === 0) continue;
      const share = painted[texel]! / covered[texel]!;
      mask[texel] = Math.round(255 * share);
      const scale = this.#isSettled[texel] === 1 ? share : 1 / covered[texel]!;
      for (let at = 4 * texel; at < 4 * texel + 4; ++at) colors[at]! *= scale;
    }
    fillGutter(this, covered, gutter);
    return mask;
  }
}

/** The weights of four texels in a row, for a place between the two in the middle: Keys' cubic convolution. */
function cubicWeights(t: number, out: Float64Array): void {
  const a = kSharpness;
  out[0] = a * t * (1 - t) ** 2;
  out[1] = 1 + t * t * ((a + 2) * t - a - 3);
  out[3] = a * t * t * (1 - t);
  out[2] = 1 - out[0]! - out[1]! - out[3]!;
}

/** Where a row of samples meets a triangle: from the first sample inside to the first one beyond. */
function spanOf(edges: readonly number[], y: number, k: number, lefts: Float64Array, rights: Float64Array): void {
  let [left, right] = [Infinity, -Infinity];
  for (let e = 0; e < 12; e += 4) {
    // Independent of the direction of the edge, so equal for both of its triangles.
    const isDown = edges[e + 1]! < edges[e + 3]!;
    const [p, q] = isDown ? [e, e + 2] : [e + 2, e];
    const [py, qy] = [edges[p + 1]!, edges[q + 1]!];
    if (!(py <= y && y < qy)) continue;
    const x = edges[p]! + ((edges[q]! - edges[p]!) * (y - py)) / (qy - py);
    if (x < left) left = x;
    if (x > right) right = x;
  }
  lefts[k] = Math.ceil(left);
  rights[k] = Math.ceil(right);
}

export const modulo = (a: number, b: number): number => a - b * Math.floor(a / b);

function wrapping(size: number, wrap: Wrap): Wrapping {
  if (wrap === 'repeat') return (at) => (at >= 0 && at < size ? at : modulo(at, size));
  if (wrap === 'clamp') return (at) => (at >= 0 && at < size ? at : -1);
  return (at) => {
    const there = modulo(at, 2 * size);
    return there < size ? there : 2 * size - 1 - there;
  };
}
