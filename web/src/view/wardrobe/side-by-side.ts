import { Group, type PerspectiveCamera, Vector3 } from 'three';
import type { Crowd } from '../framing';
import type { Look } from '../overlay/looks';
import type { Beside, Room } from './beside';

const kGap = 1.08; // of the width of a model
const kName = 0.2; // of the height of the highest: the room for a name below its feet
const kRows = 0.8; // of the size that more rows would give, fewer are taken

/** What of a look there is for models that are not on the stage. */
const kShown: Partial<Record<Look, Look>> = {
  colors: 'result',
  checker: 'result',
  left: 'result',
  right: 'result',
};

/**
 * Arranges models side by side across the view, in as few rows as keep them large. They turn where they stand when the camera
 * goes around them.
 */
export class SideBySide implements Crowd {
  readonly object = new Group();
  #cells: readonly (Beside | undefined)[] = [];
  #active: Room = { wide: 1, high: 1 };
  #columns = 1;
  readonly #onFace: (floors: [Vector3, Vector3][], camera: PerspectiveCamera) => void;

  /** @param onFace Called with the left and the right end of the floor of each, in the studio, once they are placed. */
  constructor(onFace: (floors: [Vector3, Vector3][], camera: PerspectiveCamera) => void) {
    this.#onFace = onFace;
  }

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

  /** Of the highest. */
  get #high(): number {
    return 2 * Math.max(...this.#all.map(({ high }) => high));
  }

  /** Of a row. */
  get #height(): number {
    return (kGap + kName) * this.#high;
  }

  /** The row of each, its middle from that of its row, and its width. */
  #places(columns = this.#columns): { row: number; x: number; width: number }[] {
    const widths = this.#all.map(({ wide }) => 2 * kGap * wide);
    const sum = (from: number, to: number): number => widths.slice(from, to).reduce((a, b) => a + b, 0);
    return widths.map((width, index) => {
      const row = Math.floor(index / columns);
      const [from, to] = [row * columns, (row + 1) * columns];
      return { row, x: sum(from, index) + (width - sum(from, to)) / 2, width };
    });
  }

  face(camera: PerspectiveCamera): void {
    const theta = Math.atan2(camera.position.x, camera.position.z);
    const at = (x: number, y: number): Vector3 => new Vector3(Math.cos(theta) * x, y, -Math.sin(theta) * x);
    const places = this.#places();
    const own = places[this.#own]!;
    const floors = this.#cells.map((cell, index): [Vector3, Vector3] => {
      const { row, x, width } = places[index]!;
      // They stand on one floor, or on one for each row.
      const floor = -this.#active.high - (row - own.row) * this.#height;
      cell?.holder.position.copy(at(x - own.x, floor + cell.high));
      const end = (side: number): Vector3 => at(x - own.x + side * width, floor).add(this.object.position);
      return [end(-0.5), end(0.5)];
    });
    camera.updateMatrixWorld();
    this.#onFace(floors, camera);
  }

  show(look: Look): void {
    for (const cell of this.#cells) cell?.overlay?.show(cell.isPainted ? (kShown[look] ?? look) : 'bare');
  }

  /** The place of the model on the stage. */
  get #own(): number {
    return Math.max(0, this.#cells.indexOf(undefined));
  }

  /** Half the width and half the height of all, and their middle from that of the model on the stage. */
  #bounds(): { wide: number; high: number; x: number; y: number } {
    const places = this.#places();
    const own = places[this.#own]!;
    const rows = 1 + Math.max(...places.map(({ row }) => row));
    const wide = Math.max(...places.map(({ x, width }) => Math.abs(x) + width / 2));
    const high = (rows * this.#height) / 2;
    const floor = -this.#active.high - kName * this.#high + (1 - (rows - own.row)) * this.#height;
    return { wide, high, x: -own.x, y: floor + high };
  }

  extent(theta: number, aspect: number): Float32Array {
    this.#choose(aspect);
    const { wide, high } = this.#bounds();
    const deep = Math.max(...this.#all.map(({ wide }) => wide));
    const corners = [-1, 1].flatMap((sx) =>
      [-1, 1].flatMap((sy) => [-1, 1].map((sz) => [sx * wide, sy * high, sz * deep])),
    );
    const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
    return Float32Array.from(corners.flatMap(([a, b, c]) => [cos * a! + sin * c!, b!, cos * c! - sin * a!]));
  }

  middle(theta: number): Vector3 {
    const { x, y } = this.#bounds();
    return new Vector3(Math.cos(theta) * x, y, -Math.sin(theta) * x);
  }

  get floor(): number | undefined {
    return this.#columns < this.#cells.length ? undefined : this.#bounds().wide;
  }

  /** Chooses the number of columns that makes them largest, or nearly, in fewer rows. */
  #choose(aspect: number): void {
    const count = this.#cells.length;
    const scaleOf = (columns: number): number => {
      const width = 2 * Math.max(...this.#places(columns).map(({ x, width }) => Math.abs(x) + width / 2));
      return Math.min(aspect / width, 1 / (Math.ceil(count / columns) * this.#height));
    };
    const all = Array.from({ length: count }, (_, i) => Math.ceil(count / (i + 1)));
    const best = Math.max(...all.map(scaleOf));
    this.#columns = all.find((columns) => scaleOf(columns) >= kRows * best) ?? 1;
  }
}
