import type { Vector } from '../../inspect/geometry.js';

/** Red, green, blue; 0 … 255. */
export type Rgb = readonly [number, number, number];

/** The axes of a picture: right, up and towards the eye, as orthogonal unit vectors. */
export interface View {
  right: Vector;
  up: Vector;
  eye: Vector;
}

/** An orthographic picture with a depth buffer. */
export class Picture {
  readonly size: number;
  /** Red, green, blue, alpha of every pixel, from the top left; transparent in the background. */
  readonly pixels: Uint8Array;
  readonly #depths: Float32Array;
  readonly #view: View;
  readonly #middle: Vector;
  readonly #scale: number;

  /**
   * @param size    Pixels along each side.
   * @param middle  The point that is shown in the middle.
   * @param radius  How much of the scene around it fits into the picture.
   */
  constructor(size: number, view: View, middle: Vector, radius: number) {
    this.size = size;
    this.pixels = new Uint8Array(4 * size * size);
    this.#depths = new Float32Array(size * size).fill(-Infinity);
    this.#view = view;
    this.#middle = middle;
    this.#scale = size / 2 / (radius || 1);
  }

  /** Pixel column, pixel row, and height towards the eye, all in pixels. */
  #project(p: Vector): Vector {
    const { right, up, eye } = this.#view;
    const [x, y, z] = [p[0] - this.#middle[0], p[1] - this.#middle[1], p[2] - this.#middle[2]];
    const on = (axis: Vector) => this.#scale * (axis[0] * x + axis[1] * y + axis[2] * z);
    return [this.size / 2 + on(right) - 0.5, this.size / 2 - on(up) - 0.5, on(eye)];
  }

  /** Draws a triangle, both sides, lit from the eye. */
  triangle(a: Vector, b: Vector, c: Vector, color: Rgb): void {
    const [p, q, r] = [this.#project(a), this.#project(b), this.#project(c)];
    const [ux, uy, uz] = [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
    const [vx, vy, vz] = [r[0] - p[0], r[1] - p[1], r[2] - p[2]];
    const area = ux * vy - uy * vx;
    if (area === 0) return;
    const light = 0.35 + (0.65 * Math.abs(area)) / Math.hypot(area, uy * vz - uz * vy, uz * vx - ux * vz);
    const lit: Rgb = [color[0] * light, color[1] * light, color[2] * light];
    const last = this.size - 1;
    const [left, right] = [
      Math.max(0, Math.ceil(Math.min(p[0], q[0], r[0]))),
      Math.min(last, Math.floor(Math.max(p[0], q[0], r[0]))),
    ];
    const [top, bottom] = [
      Math.max(0, Math.ceil(Math.min(p[1], q[1], r[1]))),
      Math.min(last, Math.floor(Math.max(p[1], q[1], r[1]))),
    ];
    for (let row = top; row <= bottom; ++row) {
      for (let column = left; column <= right; ++column) {
        const [x, y] = [column - p[0], row - p[1]];
        const [s, t] = [(x * vy - y * vx) / area, (ux * y - uy * x) / area];
        if (s >= 0 && t >= 0 && s + t <= 1) this.#set(column, row, p[2] + s * uz + t * vz, lit);
      }
    }
  }

  /** Draws a line, a pixel wide, in front of what it lies on. */
  line(a: Vector, b: Vector, color: Rgb): void {
    const [p, q] = [this.#project(a), this.#project(b)];
    const steps = Math.min(4 * this.size, Math.ceil(Math.max(Math.abs(q[0] - p[0]), Math.abs(q[1] - p[1]), 1)));
    for (let i = 0; i <= steps; ++i) {
      const t = i / steps;
      const [column, row] = [Math.round(p[0] + t * (q[0] - p[0])), Math.round(p[1] + t * (q[1] - p[1]))];
      if (column >= 0 && row >= 0 && column < this.size && row < this.size)
        this.#set(column, row, p[2] + t * (q[2] - p[2]) + 0.5, color);
    }
  }

  #set(column: number, row: number, depth: number, [red, green, blue]: Rgb): void {
    const at = row * this.size + column;
    if (depth < this.#depths[at]!) return;
    this.#depths[at] = depth;
    this.pixels[4 * at] = red;
    this.pixels[4 * at + 1] = green;
    this.pixels[4 * at + 2] = blue;
    this.pixels[4 * at + 3] = 255;
  }
}
