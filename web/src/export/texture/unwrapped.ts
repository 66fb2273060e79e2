import type { Pixels } from './pixels';

/** How a texture goes on beyond its edges. */
export type Wrap = 'repeat' | 'mirror' | 'clamp';

const kFewestSamples = 2; // per texel and direction: an edge of the paint is soft then
const kMostSamples = 4;
const kMargin = 1 / 64; // of the longer side: what is painted around islands, for what filters and shrinks the texture

/** Linear light, 0..1, for each byte of sRGB. */
const kLinear = Float32Array.from({ length: 256 }, (_, byte) =>
  byte <= 10 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4,
);

const toByte = (linear: number): number =>
  255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);

/**
 * The paint on a model's surface, unwrapped by the model's own UVs: put together triangle by triangle, then laid over the
 * model's own texture. Of places that share a texel, the one that comes first has it.
 */
export class Unwrapped {
  readonly #width: number;
  readonly #height: number;
  readonly #paint: Pixels;
  readonly #samples: number;
  readonly #columnOf: (column: number) => number;
  readonly #rowOf: (row: number) => number;
  /** 4 per texel: colour in linear light, multiplied by alpha, and alpha; sums over samples, later means. */
  readonly #colors: Float32Array;
  /** 1 per texel: the share of it that lies on the surface. */
  readonly #covered: Float32Array;
  #refused = 0;
  #painted = 0;

  /**
   * @param size    Of the texture, in texels.
   * @param paint   In the cage's UVs; it repeats.
   * @param density How many texels of the paint come to one of the texture, along a side.
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
    this.#columnOf = placeIn(width, wraps[0]);
    this.#rowOf = placeIn(height, wraps[1]);
    this.#colors = new Float32Array(4 * width * height);
    this.#covered = new Float32Array(width * height);
  }

  /** What share of the paint has no place, because another place of the surface has its texels. */
  get crowded(): number {
    return this.#refused === 0 ? 0 : this.#refused / (this.#refused + this.#painted);
  }

  /**
   * Lays a triangle of the surface. Samples on an edge belong to one of the two triangles that share it.
   * @param own  6 numbers: the model's own UVs.
   * @param cage 6 numbers: the cage's UVs; undefined where there is to be no paint.
   */
  draw(own: ArrayLike<number>, cage: ArrayLike<number> | undefined): void {
    const n = this.#samples;
    // In a grid of samples, whose places are whole numbers.
    const [x0, x1, x2] = [0, 2, 4].map((at) => own[at]! * this.#width * n - 0.5) as [number, number, number];
    const [y0, y1, y2] = [1, 3, 5].map((at) => own[at]! * this.#height * n - 0.5) as [number, number, number];
    const area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
    if (area === 0) return;
    const slopes = cage && [0, 1].map((k) => slopeOf(cage[k]!, cage[2 + k]!, cage[4 + k]!));
    /** Of a number that is linear on the triangle: how it grows to the right and downwards. */
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
        // The same for both triangles of an edge, whichever way they go along it.
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

  /** Adds a sample to a texel, unless that is full. @param u,v Its place in the paint, if it has any. */
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

  /** Adds the paint at a place, between its four nearest texels. */
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
   * Lays the paint over a texture of this size, in its place; its alpha stays. What is not painted stays to the byte, unless
   * there is a factor. Islands get a margin of what is at their edge. To be called once.
   * @param factor What the texture's colours are multiplied by, in linear light.
   */
  layOver({ data }: Pixels, factor: readonly [number, number, number]): void {
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

  /** A texel at the edge of an island gets all of what it has a part of. */
  #average(): void {
    this.#covered.forEach((share, texel) => {
      if (share === 0 || share === 1) return;
      for (let at = 4 * texel; at < 4 * texel + 4; at++) this.#colors[at]! /= share;
    });
  }

  /** Paints a margin around the islands, ring by ring: each texel of it is the mean of its neighbours further in. */
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

  /** The texels without a place on the surface that are next to those that have one. */
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

/** What finds the place of a texel that may lie beyond the edges; −1 for none. */
function placeIn(size: number, wrap: Wrap): (place: number) => number {
  if (wrap === 'repeat') return (place) => modulo(place, size);
  if (wrap === 'clamp') return (place) => (place >= 0 && place < size ? place : -1);
  return (place) => {
    const there = modulo(place, 2 * size);
    return there < size ? there : 2 * size - 1 - there;
  };
}
