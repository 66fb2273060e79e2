import { Triangle, Vector3 } from 'three';

/** A mesh of triangles. */
export interface Surface {
  /** 3 per vertex. */
  positions: ArrayLike<number>;
  /** 3 per triangle. */
  indices: ArrayLike<number>;
}

/** The corners of a triangle, in double precision. */
export function cornersOf({ positions, indices }: Surface, triangle: number): [Vector3, Vector3, Vector3] {
  const corner = (c: number): Vector3 => new Vector3().fromArray(positions, 3 * indices[3 * triangle + c]!);
  return [corner(0), corner(1), corner(2)];
}

/** The closest point of a triangle, and the triangle's normal. */
export function closestPointOnTriangle(
  surface: Surface,
  triangle: number,
  point: Vector3,
): { closest: Vector3; normal: Vector3 } {
  const corners = new Triangle(...cornersOf(surface, triangle));
  return { closest: corners.closestPointToPoint(point, new Vector3()), normal: corners.getNormal(new Vector3()) };
}

/** Equal for vertices at equal positions. */
export function weldedVertices(positions: ArrayLike<number>): Uint32Array {
  const first = new Map<string, number>();
  return Uint32Array.from({ length: positions.length / 3 }, (_, vertex) => {
    const key = [0, 1, 2].map((axis) => positions[3 * vertex + axis]).join(); // −0 and 0 are the same text
    if (!first.has(key)) first.set(key, vertex);
    return first.get(key)!;
  });
}

export interface Box {
  low: number[];
  high: number[];
}

/** The bounding box. */
export function boxOf(positions: ArrayLike<number>): Box {
  const box: Box = { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
  for (let i = 0; i < positions.length; i++) {
    box.low[i % 3] = Math.min(box.low[i % 3]!, positions[i]!);
    box.high[i % 3] = Math.max(box.high[i % 3]!, positions[i]!);
  }
  return box;
}

export const diagonalOfBox = ({ low, high }: Box): number =>
  Math.hypot(...high.map((value, axis) => value - low[axis]!));

/** The diagonal of the bounding box. */
export const diagonalOf = ({ positions }: Pick<Surface, 'positions'>): number => diagonalOfBox(boxOf(positions));
