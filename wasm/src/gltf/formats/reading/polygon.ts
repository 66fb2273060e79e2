import { ShapeUtils, Vector2, Vector3 } from 'three';

/** The triangles of a polygon in space, 3 of its corners for each: a fan from its first corner, unless it is not convex. */
export function triangulated(places: readonly Vector3[]): number[] {
  const fan = Array.from({ length: Math.max(0, places.length - 2) }, (_, k) => [0, k + 1, k + 2]);
  const [from, to] = [new Vector3(), new Vector3()];
  const normalAt = (a: Vector3, b: Vector3, c: Vector3): Vector3 =>
    new Vector3().crossVectors(from.subVectors(b, a), to.subVectors(c, b));
  const normal = new Vector3();
  for (const corners of fan) normal.add(normalAt(...(corners.map((k) => places[k]!) as [Vector3, Vector3, Vector3])));
  const at = (k: number): Vector3 => places[(k + places.length) % places.length]!;
  const isConvex = places.every((place, k) => normalAt(at(k - 1), place, at(k + 1)).dot(normal) >= 0);
  if (isConvex || !(normal.lengthSq() > 0)) return fan.flat();
  const axis = Math.abs(normal.x) < Math.abs(normal.y) ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
  const right = axis.cross(normal).normalize();
  const up = normal.clone().normalize().cross(right);
  const found = ShapeUtils.triangulateShape(
    places.map((place) => new Vector2(place.dot(right), place.dot(up))),
    [],
  );
  return (found.length === fan.length ? found : fan).flat();
}
