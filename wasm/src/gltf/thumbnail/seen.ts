import type { Vector } from '../../inspect/geometry.js';
import { facingOf, lit, type Picture, type Sight } from './picture.js';
import { Raster } from './raster.js';

/** The triangles of what is seen. */
interface Triangles {
  positions: ArrayLike<number>;
  indices: ArrayLike<number>;
}

/**
 * Which triangle of a mesh is seen at each sample of a picture, for pictures that show the same in other colours. A colour is found only for
 * what is seen in the end, so that layers behind each other cost little.
 */
export class Seen implements Sight {
  /** By sample, from the top left; -1 for none. */
  readonly triangles: Int32Array;
  readonly depths: Float32Array;
  readonly #indices: ArrayLike<number>;
  /** Columns, rows and heights of all vertices. */
  readonly #projected: Float64Array;
  readonly #corners: [p: Place, q: Place, r: Place] = [
    [0, 0, 0],
    [0, 0, 0],
    [0, 0, 0],
  ];

  /** @throws {InputError} if triangles cover the whole picture too often. */
  constructor(picture: Picture, { positions, indices }: Triangles) {
    this.#indices = indices;
    this.#projected = new Float64Array(positions.length);
    for (let at = 0; at + 2 < positions.length; at += 3)
      this.#projected.set(picture.project([positions[at]!, positions[at + 1]!, positions[at + 2]!]), at);
    const { side } = picture;
    this.triangles = new Int32Array(side ** 2).fill(-1);
    this.depths = new Float32Array(side ** 2).fill(-Infinity);
    const raster = new Raster(side);
    for (let triangle = 0; 3 * triangle < indices.length; ++triangle) this.#draw(triangle, raster);
  }

  /** The light on a triangle, from the eye. */
  lightOf(triangle: number): number {
    const [p, q, r] = this.#cornersOf(triangle);
    return lit(Math.abs(facingOf(p, q, r)));
  }

  #draw(triangle: number, raster: Raster): void {
    const [p, second, third] = this.#cornersOf(triangle);
    if (!raster.begin(p, second, third)) return;
    const [q, r] = raster.isTurned ? [third, second] : [second, third];
    const { depths, triangles } = this;
    for (let row = raster.first; row <= raster.last; ++row) {
      raster.row(row);
      for (let column = raster.from; column <= raster.to; ++column) {
        const [s, t] = [raster.second(column, row), raster.third(column, row)];
        const depth = Math.fround(p[2] + s * (q[2] - p[2]) + t * (r[2] - p[2]));
        const at = row * raster.side + column;
        if (depth < depths[at]!) continue;
        depths[at] = depth;
        triangles[at] = triangle;
      }
    }
  }

  /** The projected corners, in arrays that are used again. */
  #cornersOf(triangle: number): readonly [Vector, Vector, Vector] {
    for (let k = 0; k < 3; ++k) {
      const from = 3 * this.#indices[3 * triangle + k]!;
      for (let axis = 0; axis < 3; ++axis) this.#corners[k]![axis] = this.#projected[from + axis]!;
    }
    return this.#corners;
  }
}

type Place = [number, number, number];
