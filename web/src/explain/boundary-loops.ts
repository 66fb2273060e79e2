import { Line3, Triangle, Vector3 } from 'three';
import { cornersOf, type Surface, weldedVertices } from '../state/surface';

/** The boundary edges of a cage: those of exactly one triangle with area. Vertices at equal positions count as one. */
export class BoundaryLoops {
  readonly #cage: Surface;
  readonly #point: Uint32Array;
  readonly #boundary = new Set<string>();
  readonly #ends = new Set<number>();
  /** The ends of every boundary edge, in pairs. */
  readonly lines: Vector3[] = [];

  constructor(cage: Surface) {
    this.#cage = cage;
    const { positions, indices } = cage;
    this.#point = weldedVertices(positions);
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
      this.#boundary.add(edge);
      for (const end of this.#endsOf(corner!)) {
        this.#ends.add(end);
        this.lines.push(new Vector3().fromArray(positions, 3 * end));
      }
    }
  }

  /** Whether a point of a cage triangle lies on one of its boundary edges, or at a corner of one. @param tolerance A distance. */
  has(triangle: number, point: Vector3, tolerance: number): boolean {
    const corners = cornersOf(this.#cage, triangle);
    return corners.some((corner, c) => {
      const at = 3 * triangle + c;
      if (this.#ends.has(this.#endsOf(at)[0]) && point.distanceTo(corner) <= tolerance) return true;
      if (!this.#boundary.has(this.#edge(at))) return false;
      const edge = new Line3(corner, corners[(c + 1) % 3]!);
      return edge.closestPointToPoint(point, true, new Vector3()).distanceTo(point) <= tolerance;
    });
  }

  /** The ends of the edge that starts at a corner, as welded vertices. */
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
