import type { Vector } from '../../inspect/geometry.js';
import { InputError } from '../../scene/input-error.js';

/** Corners lie on a grid of so many places per sample, so that it is exact which side of an edge a sample is on. */
const kGrid = 256;
/** How often triangles may cover the whole picture. Figures with hair in many layers stay below 10; a hostile file need not. */
const kMaxLayers = 64;
/** Samples of each triangle that do not count: a million small triangles are no reason to stop. */
const kFreeSamples = 16;

const onGrid = (x: number): number => Math.round(kGrid * x);

/**
 * Finds the samples of one triangle after the other, row by row. A sample on an edge that two triangles share belongs to exactly one of
 * them.
 */
export class Raster {
  /** The rows of the triangle. */
  first = 0;
  last = -1;
  /** The columns of the row. */
  from = 0;
  to = -1;
  /** Whether the triangle goes round the other way: its second and third corner have changed places. */
  isTurned = false;
  #left: number;
  /** The columns of the triangle. */
  #from = 0;
  #to = -1;
  #area = 1;
  /** Opposite of each corner. */
  readonly #edges = [new Edge(), new Edge(), new Edge()] as const;

  /** @param side  Samples along each side. */
  constructor(readonly side: number) {
    this.#left = kMaxLayers * side ** 2;
  }

  /**
   * Begins with a triangle, by the columns and rows of its corners.
   * @returns whether it has any area.
   * @throws {InputError} once triangles cover the whole picture too often.
   */
  begin(p: Vector, second: Vector, third: Vector): boolean {
    const [[px, py], [qx, qy], [rx, ry]] = [p, second, third];
    const area =
      (onGrid(qx) - onGrid(px)) * (onGrid(ry) - onGrid(py)) - (onGrid(qy) - onGrid(py)) * (onGrid(rx) - onGrid(px));
    this.isTurned = area < 0;
    this.#area = Math.abs(area);
    if (!(this.#area > 0)) return false;
    this.first = Math.max(0, Math.floor(Math.min(py, qy, ry)));
    this.last = Math.min(this.side - 1, Math.ceil(Math.max(py, qy, ry)));
    this.#from = Math.max(0, Math.floor(Math.min(px, qx, rx)));
    this.#to = Math.min(this.side - 1, Math.ceil(Math.max(px, qx, rx)));
    const samples = Math.max(0, this.#to + 1 - this.#from) * Math.max(0, this.last + 1 - this.first);
    this.spend(samples - kFreeSamples);
    const [q, r] = this.isTurned ? [third, second] : [second, third];
    const [ofP, ofQ, ofR] = this.#edges;
    ofP.set(q, r);
    ofQ.set(r, p);
    ofR.set(p, q);
    return true;
  }

  /** Counts samples that are looked at. @throws {InputError} once there are too many. */
  spend(samples: number): void {
    this.#left -= Math.max(0, samples);
    if (this.#left < 0)
      throw new InputError(
        `cannot be drawn: its triangles cover the picture more than ${kMaxLayers} times; leave out what lies in many layers`,
      );
  }

  /** Finds the columns of a row: none if `to` is less than `from`. */
  row(row: number): void {
    this.from = this.#from;
    this.to = this.#to;
    for (const edge of this.#edges) {
      const spare = edge.at(0, row) - edge.least;
      const step = edge.step;
      if (step > 0) this.from = Math.max(this.from, Math.ceil(-spare / step));
      else if (step < 0) this.to = Math.min(this.to, Math.floor(spare / -step));
      else if (spare < 0) this.to = -1;
    }
  }

  /** The weight of the second corner as it goes round, at a sample. */
  second(column: number, row: number): number {
    return this.#edges[1].at(column, row) / this.#area;
  }

  /** The weight of the third corner as it goes round. */
  third(column: number, row: number): number {
    return this.#edges[2].at(column, row) / this.#area;
  }
}

/** An edge of a triangle: for a sample, twice the area of the triangle that it makes with the edge, on the grid. */
class Edge {
  /** From which area on a sample is inside: of those on the edge itself, the upper and the left ones are. */
  least: 0 | 1 = 0;
  #x = 0;
  #y = 0;
  #dx = 0;
  #dy = 0;

  set(from: Vector, to: Vector): void {
    this.#x = onGrid(from[0]);
    this.#y = onGrid(from[1]);
    this.#dx = onGrid(to[0]) - this.#x;
    this.#dy = onGrid(to[1]) - this.#y;
    this.least = this.#dy < 0 || (this.#dy === 0 && this.#dx > 0) ? 0 : 1;
  }

  /** How much it grows from column to column. */
  get step(): number {
    return -this.#dy * kGrid;
  }

  at(column: number, row: number): number {
    return this.#dx * (kGrid * row - this.#y) - this.#dy * (kGrid * column - this.#x);
  }
}
