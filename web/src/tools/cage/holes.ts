import { type Ray, Vector3 } from 'three';
import { weldedVertices } from '../../state/surface';
import { firstHit } from '../../view/ray';

/** A cage: UVs have a vertex for each side of a seam. */
interface CageArrays {
  positions: Float32Array;
  indices: Uint32Array;
  uvs: Float32Array;
}

/** The vertices around each hole, in the order of the triangles beside it; with `undefined` where a UV seam ends. */
function loopsOf({ positions, indices }: CageArrays): (number | undefined)[][] {
  const welded = weldedVertices(positions);
  const ends = (corner: number): [number, number] => [
    indices[corner]!,
    indices[corner % 3 === 2 ? corner - 2 : corner + 1]!,
  ];
  const edges = new Map<string, number>();
  for (let corner = 0; corner < indices.length; corner++)
    edges.set(
      ends(corner)
        .map((vertex) => welded[vertex])
        .join(),
      corner,
    );
  const next = new Map<number, number>();
  for (const [key, corner] of edges)
    if (!edges.has(key.split(',').reverse().join())) next.set(welded[ends(corner)[0]]!, corner);
  const loops: (number | undefined)[][] = [];
  for (const begin of [...next.keys()]) {
    const loop: (number | undefined)[] = [];
    let last: number | undefined;
    for (let at = begin, corner = next.get(at); corner !== undefined; corner = next.get(at)) {
      next.delete(at);
      const [from, to] = ends(corner);
      loop.push(last !== undefined && last !== from ? undefined : from);
      last = to;
      at = welded[to]!;
    }
    if (loop.length > 2) {
      if (last !== loop[0]) loop[0] = undefined;
      loops.push(loop);
    }
  }
  return loops;
}

/** What a click on a cage does: opens a triangle, or closes a hole. */
type HoleChange = { indices: Uint32Array; opened: boolean } | { seam: true } | undefined;

/** Opens the cage where a ray meets it, or closes the hole that it passes first. */
export function changeHole(cage: CageArrays, ray: Ray): HoleChange {
  const hit = firstHit(cage, ray.origin, ray.direction, 0);
  let nearest = hit?.length ?? Infinity;
  let hole: (number | undefined)[] | undefined;
  const at = new Vector3();
  for (const loop of loopsOf(cage)) {
    const points = pointsOf(cage, loop);
    const middle = points.reduce((sum, point) => sum.add(point), new Vector3()).divideScalar(points.length);
    points.forEach((point, i) => {
      if (!ray.intersectTriangle(middle, point, points[(i + 1) % points.length]!, false, at)) return;
      const length = at.distanceTo(ray.origin);
      if (length < nearest) [nearest, hole] = [length, loop];
    });
  }
  if (hole) {
    const whole = hole.filter((vertex): vertex is number => vertex !== undefined);
    if (whole.length < hole.length) return { seam: true };
    return { indices: Uint32Array.from([...cage.indices, ...fill(cage.uvs, whole.reverse())]), opened: false };
  }
  if (!hit) return undefined;
  const { triangle } = hit;
  return { indices: cage.indices.filter((_, corner) => Math.floor(corner / 3) !== triangle), opened: true };
}

function pointsOf({ positions }: CageArrays, loop: (number | undefined)[]): Vector3[] {
  return loop.flatMap((vertex) => (vertex === undefined ? [] : [new Vector3().fromArray(positions, 3 * vertex)]));
}

/** Triangles that fill a polygon of the UVs, by cutting ears. */
function fill(uvs: Float32Array, polygon: number[]): number[] {
  const area = (a: number, b: number, c: number): number =>
    (uvs[2 * b]! - uvs[2 * a]!) * (uvs[2 * c + 1]! - uvs[2 * a + 1]!) -
    (uvs[2 * b + 1]! - uvs[2 * a + 1]!) * (uvs[2 * c]! - uvs[2 * a]!);
  let whole = 0;
  for (let i = 1; i + 1 < polygon.length; i++) whole += area(polygon[0]!, polygon[i]!, polygon[i + 1]!);
  const side = Math.sign(whole);
  const left = [...polygon];
  const triangles: number[] = [];
  while (left.length > 3) {
    const corners = left.map((_, i) => [left.at(i - 1)!, left[i]!, left[(i + 1) % left.length]!] as const);
    const isEar = ([a, b, c]: readonly [number, number, number]): boolean =>
      side * area(a, b, c) > 0 &&
      !left.some(
        (v) =>
          v !== a && v !== b && v !== c && [area(a, b, v), area(b, c, v), area(c, a, v)].every((one) => side * one > 0),
      );
    // A polygon that crosses itself has none: any corner will do.
    const ear = Math.max(0, corners.findIndex(isEar));
    triangles.push(...corners[ear]!);
    left.splice(ear, 1);
  }
  return [...triangles, ...left];
}
