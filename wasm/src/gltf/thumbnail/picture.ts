import { colorByte, type Image, linearOf } from '../../bake/image.js';
import type { Vector } from '../../inspect/geometry.js';
import { Raster } from './raster.js';
import type { View } from './views.js';

/** Red, green, blue; 0 … 255. */
export type Rgb = readonly [number, number, number];

/**
 * Finds the colour of a spot of a triangle: red, green and blue in linear light, and alpha, all 0..1. With an alpha of 0 the spot is not there.
 * @param q, r  The weights of the second and the third corner there.
 */
export type Shade = (q: number, r: number, out: Float32Array) => void;

/** Which triangle of a mesh is seen at each sample; -1 for none. */
export interface Sight {
  readonly triangles: Int32Array;
  readonly depths: Float32Array;
  lightOf(triangle: number): number;
}

/** What is shown, and how finely. */
export interface Framing {
  /** Pixels along each side. */
  size: number;
  view: View;
  /** The point that is shown in the middle. */
  middle: Vector;
  /** How much of the scene around it fits into the picture. */
  radius: number;
  /** Samples along each side of a pixel. Default: 1. */
  samples?: number;
  /** Red, green, blue, alpha of what nothing is drawn on; 0 … 255. Default: transparent. */
  background?: readonly number[] | undefined;
}

/** What is blended over a surface may lie so much behind it, in samples: the same triangle from another corner on. */
const kTie = 1e-3;
/** The share of light that what is seen from the side has. */
const kAmbient = 0.35;

/** How bright a surface is under a light at the eye. @param facing  The cosine of the angle between its normal and the eye. */
export const lit = (facing: number): number => kAmbient + (1 - kAmbient) * Math.min(1, Math.max(0, facing));

/** The cosine of the angle between the normal of a projected triangle and the eye; negative for its back. */
export function facingOf(p: Vector, q: Vector, r: Vector): number {
  const [ux, uy, uz] = [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
  const [vx, vy, vz] = [r[0] - p[0], r[1] - p[1], r[2] - p[2]];
  const area = uy * vx - ux * vy; // rows grow downwards
  return area / (Math.hypot(area, uy * vz - uz * vy, uz * vx - ux * vz) || 1);
}

/** An orthographic picture with a depth buffer, drawn without a GPU. Memory: 8 bytes for each sample. */
export class Picture {
  /** Samples along each side. */
  readonly side: number;
  readonly #samples: number;
  /** Red, green, blue in sRGB, not premultiplied, and alpha of every sample, from the top left. */
  readonly #colors: Uint8ClampedArray<ArrayBuffer>;
  readonly #depths: Float32Array;
  readonly #view: View;
  readonly #middle: Vector;
  readonly #scale: number;
  readonly #byteOf = colorByte();
  readonly #color = new Float32Array(4);
  readonly #raster: Raster;

  constructor({ size, view, middle, radius, samples = 1, background = [] }: Framing) {
    this.#samples = samples;
    this.side = samples * size;
    this.#colors = new Uint8ClampedArray(4 * this.side ** 2);
    if (background.length > 0) for (let i = 0; i < this.#colors.length; i += 4) this.#colors.set(background, i);
    this.#depths = new Float32Array(this.side ** 2).fill(-Infinity);
    this.#raster = new Raster(this.side);
    this.#view = view;
    this.#middle = middle;
    this.#scale = this.side / 2 / (radius || 1);
  }

  /** Column, row, and height towards the eye of a point, all in samples. The middles of samples have whole numbers. */
  project(p: Vector): Vector {
    const { right, up, eye } = this.#view;
    const [x, y, z] = [p[0] - this.#middle[0], p[1] - this.#middle[1], p[2] - this.#middle[2]];
    const on = (axis: Vector) => this.#scale * (axis[0] * x + axis[1] * y + axis[2] * z);
    return [this.side / 2 + on(right) - 0.5, this.side / 2 - on(up) - 0.5, on(eye)];
  }

  /**
   * Draws a mesh that covers nothing yet, each triangle in one colour, both sides, lit from the eye.
   * @param seen  What is seen of it, in this picture or another one of the same framing.
   */
  mesh(seen: Sight, colorOf: (triangle: number) => Rgb): void {
    this.#depths.set(seen.depths);
    const colors = this.#colors;
    let [last, red, green, blue] = [-1, 0, 0, 0];
    for (let at = 0; at < seen.triangles.length; ++at) {
      const triangle = seen.triangles[at]!;
      if (triangle < 0) continue;
      if (triangle !== last) {
        const light = seen.lightOf(triangle);
        [red, green, blue] = colorOf(triangle).map((byte) => Math.round(byte * light)) as [number, number, number];
        last = triangle;
      }
      colors[4 * at] = red;
      colors[4 * at + 1] = green;
      colors[4 * at + 2] = blue;
      colors[4 * at + 3] = 255;
    }
  }

  /**
   * Draws a projected triangle.
   * @param blends  Whether its colours are laid over what is there, in linear light; then it hides nothing.
   * @throws {InputError} once triangles cover the whole picture too often.
   */
  fill(p: Vector, second: Vector, third: Vector, shade: Shade, blends = false): void {
    const raster = this.#raster;
    if (!raster.begin(p, second, third)) return;
    const { isTurned } = raster;
    const [q, r] = isTurned ? [third, second] : [second, third];
    const slack = blends ? kTie : 0;
    for (let row = raster.first; row <= raster.last; ++row) {
      raster.row(row);
      for (let column = raster.from; column <= raster.to; ++column) {
        const [s, t] = [raster.second(column, row), raster.third(column, row)];
        const depth = Math.fround(p[2] + s * (q[2] - p[2]) + t * (r[2] - p[2]));
        const at = row * this.side + column;
        if (depth < this.#depths[at]! - slack) continue;
        shade(isTurned ? t : s, isTurned ? s : t, this.#color);
        if (!(this.#color[3]! > 0)) continue;
        if (blends) this.#layOver(4 * at, this.#color);
        else this.#set(at, depth, this.#color);
      }
    }
  }

  /** Draws a line, a pixel wide, in front of what it lies on. @throws {InputError} as `fill`, lines counted, too. */
  line(a: Vector, b: Vector, color: Rgb): void {
    const [p, q] = [this.project(a), this.project(b)];
    const steps = Math.min(4 * this.side, Math.ceil(Math.max(Math.abs(q[0] - p[0]), Math.abs(q[1] - p[1]), 1)));
    this.#raster.spend(steps);
    const drawn = Float32Array.of(linearOf[color[0]]!, linearOf[color[1]]!, linearOf[color[2]]!, 1);
    for (let i = 0; i <= steps; ++i) {
      const t = i / steps;
      const [column, row] = [Math.round(p[0] + t * (q[0] - p[0])), Math.round(p[1] + t * (q[1] - p[1]))];
      if (column < 0 || row < 0 || column >= this.side || row >= this.side) continue;
      const depth = p[2] + t * (q[2] - p[2]) + 0.5;
      const at = row * this.side + column;
      if (depth >= this.#depths[at]!) this.#set(at, depth, drawn);
    }
  }

  /** What is drawn: the mean of the samples of each pixel, in linear light. */
  image(): Image & { data: Uint8ClampedArray<ArrayBuffer> } {
    const [samples, side] = [this.#samples, this.side];
    const size = side / samples;
    if (samples === 1) return { width: size, height: size, data: this.#colors };
    const data = new Uint8ClampedArray(4 * size * size);
    for (let to = 0; to < size * size; ++to) {
      const first = samples * (Math.floor(to / size) * side + (to % size));
      let [red, green, blue, alpha] = [0, 0, 0, 0];
      for (let s = 0; s < samples * samples; ++s) {
        const at = 4 * (first + Math.floor(s / samples) * side + (s % samples));
        const weight = this.#colors[at + 3]!;
        red += weight * linearOf[this.#colors[at]!]!;
        green += weight * linearOf[this.#colors[at + 1]!]!;
        blue += weight * linearOf[this.#colors[at + 2]!]!;
        alpha += weight;
      }
      if (alpha === 0) continue;
      data[4 * to] = this.#byteOf(red / alpha);
      data[4 * to + 1] = this.#byteOf(green / alpha);
      data[4 * to + 2] = this.#byteOf(blue / alpha);
      data[4 * to + 3] = Math.round(alpha / samples ** 2);
    }
    return { width: size, height: size, data };
  }

  #set(at: number, depth: number, color: Float32Array): void {
    this.#depths[at] = depth;
    for (let k = 0; k < 3; ++k) this.#colors[4 * at + k] = this.#byteOf(color[k]!);
    this.#colors[4 * at + 3] = 255;
  }

  #layOver(at: number, color: Float32Array): void {
    const colors = this.#colors;
    const below = (colors[at + 3]! / 255) * (1 - color[3]!);
    const alpha = color[3]! + below;
    for (let k = 0; k < 3; ++k)
      colors[at + k] = this.#byteOf((color[k]! * color[3]! + linearOf[colors[at + k]!]! * below) / alpha);
    colors[at + 3] = Math.round(255 * alpha);
  }
}
