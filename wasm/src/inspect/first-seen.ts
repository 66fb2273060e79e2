import type { Mesh } from '../api/index.js';
import { dot, minus, pointAt, type Vector } from './geometry.js';

/** A grid of spots in the plane of a view, around its middle. */
export interface Grid {
  /** The middle of the view's plane, and axes to the right, up and towards the eye. */
  middle: Vector;
  axes: readonly [across: Vector, up: Vector, front: Vector];
  /** The corners of the grid, and the number of its cells along each side. */
  low: readonly [x: number, y: number];
  high: readonly [x: number, y: number];
  cells: number;
}

/** The triangle of a target that is seen first at the middle of each cell, row by row from below; -1 where there is none. */
export function firstSeen({ positions, indices }: Mesh, { middle, axes, low, high, cells }: Grid): Int32Array {
  const first = new Int32Array(cells * cells).fill(-1);
  const depths = new Float64Array(first.length).fill(-Infinity);
  const step = [0, 1].map((k) => (high[k]! - low[k]!) / cells) as [number, number];
  // In cells, so that the middles of cells are whole numbers; depth in units of the input.
  const flat = (v: number): Vector => {
    const d = minus(pointAt(positions, v), middle);
    return [(dot(d, axes[0]) - low[0]) / step[0] - 0.5, (dot(d, axes[1]) - low[1]) / step[1] - 0.5, dot(d, axes[2])];
  };
  for (let t = 0; 3 * t < indices.length; ++t) {
    const [a, b, c] = [0, 1, 2].map((k) => flat(indices[3 * t + k]!)) as [Vector, Vector, Vector];
    const whole = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    const from = ([0, 1] as const).map((k) => Math.max(0, Math.ceil(Math.min(a[k], b[k], c[k]))));
    const to = ([0, 1] as const).map((k) => Math.min(cells - 1, Math.floor(Math.max(a[k], b[k], c[k]))));
    for (let y = from[1]!; y <= to[1]!; ++y)
      for (let x = from[0]!; x <= to[0]!; ++x) {
        const u = ((b[0] - x) * (c[1] - y) - (c[0] - x) * (b[1] - y)) / whole;
        const v = ((c[0] - x) * (a[1] - y) - (a[0] - x) * (c[1] - y)) / whole;
        const depth = u * a[2] + v * b[2] + (1 - u - v) * c[2];
        const cell = y * cells + x;
        if (u < 0 || v < 0 || u + v > 1 || !(depth > depths[cell]!)) continue;
        depths[cell] = depth;
        first[cell] = t;
      }
  }
  return first;
}
