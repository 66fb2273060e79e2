import type { Pixels } from './pixels';

/** Wrap mode of a texture. */
export type Wrap = 'repeat' | 'mirror' | 'clamp';

const kFewestSamples = 2; // per texel and direction, for antialiased edges
const kMostSamples = 4;
const kMargin = 1 / 64; // of the longer side: the margin painted around UV charts, for filtering and mipmaps

/** Linear light, 0..1, for each byte of sRGB. */
const kLinear = Float32Array.from({ length: 256 }, (_, byte) =>
  byte <= 10 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4,
);

const toByte = (linear: number): number =>
  255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);

/**
 * The paint resampled into a model's own UVs, triangle by triangle, and then blended into the model's texture. Where triangles
 * overlap in UV space, the first one wins.
 */
export class Unwrapped {
  readonly #width: number;
  readonly #height: number;
  readonly #paint: Pixels;
  readonly #samples: number;
  readonly #columnOf: (column: number) => number;
  readonly #rowOf: (row: number) => number;
  /** 4 per texel: premultiplied linear RGBA; sums over samples, then means. */
  readonly #colors: Float32Array;
  /** 1 per texel: the covered share. */
  readonly #covered: Float32Array;
  #refused = 0;
  #painted = 0;

  /**
   * @param size    Size of the texture, in texels.
   * @param paint   In the cage's UVs; it repeats.
   * @param density Texels of the paint per texel of the texture, in one direction.
   */
  constructor(
    { width, height }: { width: number; height: number },
    wraps: readonly [Wrap, Wrap],
    paint: Pixels,
    density: number,
  ) {
    this.#width = width;
    this.#height = height;
    this.#paint = paint;
    this.#samples = Math.max(kFewestSamples, Math.min(kMostSamples, Math.ceil(density)));
    this.#columnOf = wrapper(width, wraps[0]);
    this.#rowOf = wrapper(height, wraps[1]);
    this.#colors = new Float32Array(4 * width * height);
    this.#covered = new Float32Array(width * height);
  }

  /** Share of the paint that was left out, because its texels were taken. */
  get overlapping(): number {
    return this.#refused === 0 ? 0 : this.#refused / (this.#refused + this.#painted);
  }

  /**
   * Rasterises a triangle. Samples on a shared edge belong to exactly one triangle.
   * @param own  6 numbers: the model's own UVs.
   * @param cage 6 numbers: the cage's UVs; undefined for unpainted triangles.
   */
  draw(own: ArrayLike<number>, cage: ArrayLike<number> | undefined): void {
    const n = this.#samples;
    // In sample coordinates: samples lie at integers.
    const [x0, x1, x2] = [0, 2, 4].map((at) => own[at]! * this.#width * n - 0.5) as [number, number, number];
    const [y0, y1, y2] = [1, 3, 5].map((at) => own[at]! * this.#height * n - 0.5) as [number, number, number];
    const area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
    if (area === 0) return;
    const slopes = cage && [0, 1].map((k) => slopeOf(cage[k]!, cage[2 + k]!, cage[4 + k]!));
    /** The gradient of a value that is linear on the triangle. */
    function slopeOf(v0: number, v1: number, v2: number): [number, number] {
      return [
        ((v1 - v0) * (y2 - y0) - (v2 - v0) * (y1 - y0)) / area,
        ((v2 - v0) * (x1 - x0) - (v1 - v0) * (x2 - x0)) / area,
      ];
    }
    const edges = [
      [x0, y0, x1, y1],
      [x1, y1, x2, y2],
      [x2, y2, x0, y0],
    ] as const;
    const end = Math.ceil(Math.max(y0, y1, y2));
    for (let y = Math.ceil(Math.min(y0, y1, y2)); y < end; y++) {
      let [left, right] = [Infinity, -Infinity];
      for (const [ax, ay, bx, by] of edges) {
        // Independent of the direction of the edge, so equal for both of its triangles.
        const [px, py, qx, qy] = ay < by ? [ax, ay, bx, by] : [bx, by, ax, ay];
        if (!(py <= y && y < qy)) continue;
        const x = px + ((qx - px) * (y - py)) / (qy - py);
        left = Math.min(left, x);
        right = Math.max(right, x);
      }
      const row = this.#rowOf(Math.floor(y / n));
      if (row < 0) continue;
      for (let x = Math.ceil(left); x < right; x++) {
        const column = this.#columnOf(Math.floor(x / n));
        if (column < 0) continue;
        const texel = row * this.#width + column;
        if (!slopes) this.#add(texel);
        else
          this.#add(
            texel,
            cage[0]! + slopes[0]![0] * (x - x0) + slopes[0]![1] * (y - y0),
            cage[1]! + slopes[1]![0] * (x - x0) + slopes[1]![1] * (y - y0),
          );
      }
    }
  }

  /** Adds a sample to a texel, unless that is fully covered. @param u,v UVs in the paint; absent for unpainted triangles. */
  #add(texel: number, u?: number, v?: number): void {
    const share = 1 / this.#samples ** 2;
    if (this.#covered[texel]! > 1 - 0.5 * share) {
      if (u !== undefined || this.#colors[4 * texel + 3]! > 0) this.#refused += share;
      return;
    }
    this.#covered[texel]! += share;
    if (u === undefined) return;
    this.#painted += share;
    this.#addPaint(4 * texel, u, v!, share);
  }

  /** Adds a bilinear sample of the paint. */
  #addPaint(to: number, u: number, v: number, share: number): void {
    const { width, height, data } = this.#paint;
    const [x, y] = [u * width - 0.5, v * height - 0.5];
    const [column, row] = [Math.floor(x), Math.floor(y)];
    for (let corner = 0; corner < 4; corner++) {
      const [right, down] = [corner & 1, corner >> 1];
      const weight = (right ? x - column : 1 - x + column) * (down ? y - row : 1 - y + row);
      const from = 4 * (modulo(row + down, height) * width + modulo(column + right, width));
      const alpha = (share * weight * data[from + 3]!) / 255;
      if (alpha === 0) continue;
      for (let k = 0; k < 3; k++) this.#colors[to + k]! += alpha * kLinear[data[from + k]!]!;
      this.#colors[to + 3]! += alpha;
    }
  }

  /**
   * Blends the paint into a texture of this size, in place; its alpha is kept. Unpainted texels are unchanged, unless there is a
   * factor. Charts get a margin in the colour of their edge. Call it once.
   * @param factor The texture's base colour factor, in linear light.
   */
  blendInto({ data }: Pixels, factor: readonly [number, number, number]): void {
    this.#average();
    this.#spread();
    const plain = factor.every((share) => share === 1);
    for (let texel = 0; texel < this.#covered.length; texel++) {
      const at = 4 * texel;
      const below = 1 - this.#colors[at + 3]!;
      if (plain && below === 1) continue;
      for (let k = 0; k < 3; k++)
        data[at + k] = toByte(this.#colors[at + k]! + below * factor[k]! * kLinear[data[at + k]!]!);
    }
  }

  /** Normalises partly covered texels at the edges of charts. */
  #average(): void {
    this.#covered.forEach((share, texel) => {
      if (share === 0 || share === 1) return;
      for (let at = 4 * texel; at < 4 * texel + 4; at++) this.#colors[at]! /= share;
    });
  }

  /** Paints a margin around the charts, ring by ring: each texel is the mean of its neighbours in the ring before. */
  #spread(): void {
    const width = Math.ceil(kMargin * Math.max(this.#width, this.#height));
    let ring = this.#ringAround(Uint32Array.from(this.#covered.keys()));
    for (let step = 0; step < width && ring.length > 0; step++) {
      for (const texel of ring) {
        const inner = this.#neighbours(texel).filter((neighbour) => this.#covered[neighbour]! > 0);
        for (let k = 0; k < 4; k++) {
          this.#colors[4 * texel + k] =
            inner.reduce((sum, neighbour) => sum + this.#colors[4 * neighbour + k]!, 0) / inner.length;
        }
      }
      for (const texel of ring) this.#covered[texel] = 1;
      ring = this.#ringAround(ring);
    }
  }

  /** The uncovered texels next to covered ones. */
  #ringAround(texels: Iterable<number>): number[] {
    const found = new Set<number>();
    for (const texel of texels) {
      if (this.#covered[texel] === 0) continue;
      for (const neighbour of this.#neighbours(texel)) if (this.#covered[neighbour] === 0) found.add(neighbour);
    }
    return [...found];
  }

  /** The texels around one. Cost: called once for every texel. */
  #neighbours(texel: number): number[] {
    const width = this.#width;
    const [x, y] = [texel % width, Math.floor(texel / width)];
    if (x > 0 && x < width - 1 && y > 0 && y < this.#height - 1) {
      return [
        texel - width - 1,
        texel - width,
        texel - width + 1,
        texel - 1,
        texel + 1,
        texel + width - 1,
        texel + width,
        texel + width + 1,
      ];
    }
    const [columns, rows] = [[x - 1, x, x + 1].map(this.#columnOf), [y - 1, y, y + 1].map(this.#rowOf)];
    return rows.flatMap((row) => columns.flatMap((column) => (row < 0 || column < 0 ? [] : row * width + column)));
  }
}

const modulo = (a: number, b: number): number => a - b * Math.floor(a / b);

/** Maps a texel coordinate that may lie outside the texture into it; −1 for none. */
function wrapper(size: number, wrap: Wrap): (place: number) => number {
  if (wrap === 'repeat') return (place) => modulo(place, size);
  if (wrap === 'clamp') return (place) => (place >= 0 && place < size ? place : -1);
  return (place) => {
    const there = modulo(place, 2 * size);
    return there < size ? there : 2 * size - 1 - there;
  };
}
