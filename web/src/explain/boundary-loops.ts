import { Line3, Triangle, Vector3 } from 'three';
import { cornersOf, type Surface } from '../scene/surface';

/** The open edges of a cage: those of exactly one triangle that has an area. Vertices at equal places are one. */
export class Rims {
  readonly #cage: Surface;
  readonly #point: Uint32Array;
  readonly #open = new Set<string>();
  readonly #ends = new Set<number>();
  /** Both ends of every open edge, one after the other. */
  readonly lines: Vector3[] = [];

  constructor(cage: Surface) {
    this.#cage = cage;
    const { positions, indices } = cage;
    const seen = new Map<string, number>();
    this.#point = Uint32Array.from({ length: positions.length / 3 }, (_, vertex) => {
      // Adding 0 makes −0 the same as 0.
      const place = [0, 1, 2].map((axis) => positions[3 * vertex + axis]! + 0).join();
      if (!seen.has(place)) seen.set(place, vertex);
      return seen.get(place)!;
    });
    const users = new Map<string, number[]>();
    for (let triangle = 0; 3 * triangle < indices.length; triangle++) {
      if (new Triangle(...cornersOf(cage, triangle)).getArea() === 0) continue;
      for (let corner = 3 * triangle; corner < 3 * triangle + 3; corner++) {
        const edge = this.#edge(corner);
        users.set(edge, [...(users.get(edge) ?? []), corner]);
      }
    }
    for (const [edge, [corner, another]] of users) {
      if (another !== undefined) continue;
      this.#open.add(edge);
      for (const end of this.#endsOf(corner!)) {
        this.#ends.add(end);
        this.lines.push(new Vector3().fromArray(positions, 3 * end));
      }
    }
  }

  /** Whether a place on a triangle of the cage lies on an open edge of it, or at a corner where one ends. @param near How near is on. */
  has(triangle: number, place: Vector3, near: number): boolean {
    const corners = cornersOf(this.#cage, triangle);
    return corners.some((corner, c) => {
      const at = 3 * triangle + c;
      if (this.#ends.has(this.#endsOf(at)[0]) && place.distanceTo(corner) <= near) return true;
      if (!this.#open.has(this.#edge(at))) return false;
      const edge = new Line3(corner, corners[(c + 1) % 3]!);
      return edge.closestPointToPoint(place, true, new Vector3()).distanceTo(place) <= near;
    });
  }

  /** The ends of the edge that begins at a corner. */
  #endsOf(corner: number): [number, number] {
    const next = corner % 3 === 2 ? corner - 2 : corner + 1;
    const { indices } = this.#cage;
    return [this.#point[indices[corner]!]!, this.#point[indices[next]!]!];
  }

  #edge(corner: number): string {
    return this.#endsOf(corner)
      .sort((a, b) => a - b)
      .join();
  }
}
