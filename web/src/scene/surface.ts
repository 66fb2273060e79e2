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

/** The diagonal of the bounding box. */
export function diagonalOf({ positions }: Surface): number {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i++) {
    low[i % 3] = Math.min(low[i % 3]!, positions[i]!);
    high[i % 3] = Math.max(high[i % 3]!, positions[i]!);
  }
  return Math.hypot(...high.map((value, axis) => value - low[axis]!));
}
