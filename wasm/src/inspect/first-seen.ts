import type { Mesh } from '../api/index.js';
import type { Vector } from './geometry.js';

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
  // In cells, so that the middles of cells are whole numbers; depth in units of the input. Arrays of three would take ten times as long.
  const flat = new Float64Array(positions.length);
  for (let v = 0; v < flat.length; v += 3) {
    const dx = positions[v]! - middle[0];
    const dy = positions[v + 1]! - middle[1];
    const dz = positions[v + 2]! - middle[2];
    for (let k = 0; k < 3; ++k) {
      const axis = axes[k]!;
      const along = dx * axis[0] + dy * axis[1] + dz * axis[2];
      flat[v + k] = k < 2 ? (along - low[k]!) / step[k]! - 0.5 : along;
    }
  }
  for (let t = 0; 3 * t < indices.length; ++t) {
    const [i, j, k] = [3 * indices[3 * t]!, 3 * indices[3 * t + 1]!, 3 * indices[3 * t + 2]!];
    const [ax, ay, bx, by, cx, cy] = [flat[i]!, flat[i + 1]!, flat[j]!, flat[j + 1]!, flat[k]!, flat[k + 1]!];
    const whole = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    const fromX = Math.max(0, Math.ceil(Math.min(ax, bx, cx)));
    const toX = Math.min(cells - 1, Math.floor(Math.max(ax, bx, cx)));
    const toY = Math.min(cells - 1, Math.floor(Math.max(ay, by, cy)));
    for (let y = Math.max(0, Math.ceil(Math.min(ay, by, cy))); y <= toY; ++y)
      for (let x = fromX; x <= toX; ++x) {
        const u = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / whole;
        const v = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / whole;
        const depth = u * flat[i + 2]! + v * flat[j + 2]! + (1 - u - v) * flat[k + 2]!;
        const cell = y * cells + x;
        if (u < 0 || v < 0 || u + v > 1 || !(depth > depths[cell]!)) continue;
        depths[cell] = depth;
        first[cell] = t;
      }
  }
  return first;
}
