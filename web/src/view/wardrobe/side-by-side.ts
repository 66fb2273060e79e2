import { Group, Vector3 } from 'three';
import type { Crowd } from '../framing';
import type { Look } from '../overlay/looks';
import type { Beside, Room } from './beside';

const kGap = 1.08; // of the width of a cell

/** What of a look there is for models that are not on the stage. */
const kShown: Partial<Record<Look, Look>> = { colors: 'result', checker: 'result' };

/**
 * Arranges models side by side across the view, in as many rows as make them largest. They turn where they stand when the camera
 * goes around them.
 */
export class SideBySide implements Crowd {
  readonly object = new Group();
  #cells: readonly (Beside | undefined)[] = [];
  #active: Room = { wide: 1, high: 1 };
  #columns = 1;

  /** @param cells  In their order; undefined for the model on the stage. */
  set(cells: readonly (Beside | undefined)[], active: Room): void {
    this.#cells = cells;
    this.#active = active;
    const holders = cells.flatMap((cell) => cell?.holder ?? []);
    for (const child of [...this.object.children]) if (!holders.includes(child as Group)) child.removeFromParent();
    for (const holder of holders) this.object.add(holder);
  }

  get #all(): readonly Room[] {
    return this.#cells.map((cell) => cell ?? this.#active);
  }

  get #width(): number {
    return 2 * kGap * Math.max(...this.#all.map(({ wide }) => wide));
  }

  get #height(): number {
    return 2 * kGap * Math.max(...this.#all.map(({ high }) => high));
  }

  /** The column and the row of each, from the model on the stage. */
  #place(index: number): [number, number] {
    const at = (i: number): [number, number] => {
      const row = Math.floor(i / this.#columns);
      const inRow = Math.min(this.#columns, this.#cells.length - row * this.#columns);
      return [(i % this.#columns) - (inRow - 1) / 2, row];
    };
    const [column, row] = at(index);
    const [ownColumn, ownRow] = at(Math.max(0, this.#cells.indexOf(undefined)));
    return [column - ownColumn, row - ownRow];
  }

  face(camera: { position: Vector3 }): void {
    const theta = Math.atan2(camera.position.x, camera.position.z);
    this.#cells.forEach((cell, index) => {
      if (!cell) return;
      const [column, row] = this.#place(index);
      const x = column * this.#width;
      // They stand on one floor, or on one for each row.
      const y = cell.high - this.#active.high - row * this.#height;
      cell.holder.position.set(Math.cos(theta) * x, y, -Math.sin(theta) * x);
    });
  }

  show(look: Look): void {
    for (const cell of this.#cells) cell?.overlay?.show(cell.isPainted ? (kShown[look] ?? look) : 'bare');
  }

  /** Left, right, upper and lower edge, from the model on the stage. */
  #edges(): [number, number, number, number] {
    const places = this.#cells.map((_, index) => this.#place(index));
    const [columns, rows] = [places.map(([column]) => column), places.map(([, row]) => row)];
    const [half, height, floor] = [this.#width / 2, this.#height, -this.#active.high];
    return [
      Math.min(...columns) * this.#width - half,
      Math.max(...columns) * this.#width + half,
      floor - Math.min(...rows) * height + height,
      floor - Math.max(...rows) * height,
    ];
  }

  extent(theta: number, aspect: number): Float32Array {
    this.#choose(aspect);
    const [left, right, upper, lower] = this.#edges();
    const [x, y, z] = [(right - left) / 2, (upper - lower) / 2, Math.max(...this.#all.map(({ wide }) => wide))];
    const corners = [-1, 1].flatMap((sx) => [-1, 1].flatMap((sy) => [-1, 1].map((sz) => [sx * x, sy * y, sz * z])));
    const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
    return Float32Array.from(corners.flatMap(([a, b, c]) => [cos * a! + sin * c!, b!, cos * c! - sin * a!]));
  }

  middle(theta: number): Vector3 {
    const [left, right, upper, lower] = this.#edges();
    const x = (left + right) / 2;
    return new Vector3(Math.cos(theta) * x, (upper + lower) / 2, -Math.sin(theta) * x);
  }

  /** Chooses the number of columns that makes them largest. */
  #choose(aspect: number): void {
    const count = this.#cells.length;
    const scaleOf = (columns: number): number =>
      Math.min(aspect / (columns * this.#width), 1 / (Math.ceil(count / columns) * this.#height));
    let best = 1;
    for (let columns = 2; columns <= count; columns++) if (scaleOf(columns) > scaleOf(best)) best = columns;
    this.#columns = best;
  }
}
