import type { Part } from './glb.ts';
import { diagonalOf, join, type Mesh, point, triangleCount, vertexCount } from './mesh.ts';
import { onOpenEdge, spaceOf } from './space.ts';
import { add, dot, scale, type Vec3 } from './vec.ts';

/** What a perfect transfer would do, per vertex of the target, its parts one after the other. */
export interface Truth {
  vertexCount: number;
  ncz: number[]; // 1 = must not be painted
  ignore: number[]; // 1 = not scored: hidden, ambiguous, or exposed to less than a quarter of the hemisphere about its normal
  hidden: number[]; // 1 = part of the skin that nothing outside sees
  offCage: number[]; // 1 = the nearest cage point is on an open border: the cage says nothing about it
  parts: {
    name: string;
    firstVertex: number;
    vertexCount: number;
    triangleCount: number;
    ncz: boolean;
    ambiguous: boolean;
  }[];
}

const kGolden = Math.PI * (3 - Math.sqrt(5));

/** Directions spread evenly over the sphere. */
const spread = (count: number): Vec3[] =>
  Array.from({ length: count }, (_, k) => {
    const z = 1 - (2 * (k + 0.5)) / count;
    const r = Math.sqrt(1 - z * z);
    return [r * Math.cos(k * kGolden), r * Math.sin(k * kGolden), z];
  });

/**
 * Finds the truth about a model from what each part is for and from what of it can be seen.
 * @param inside  Says of a point of an otherwise paintable part that it belongs to the inside of the model (a mouth's lining), where
 *                painting it or not is a matter of taste.
 * @param rays  Directions that a vertex is looked at from: over the whole sphere, half of them on its own side.
 */
export const truthOf = (parts: readonly Part[], cage: Mesh, inside: (p: Vec3) => boolean, rays: number): Truth => {
  const directions = spread(rays);
  const whole = join(...parts.map((p) => p.mesh));
  const count = vertexCount(whole);
  const space = spaceOf(whole);
  const lift = 1e-4 * diagonalOf(whole.positions);
  const truth: Truth = {
    vertexCount: count,
    ncz: [],
    ignore: [],
    hidden: [],
    offCage: offCageOf(parts, cage),
    parts: [],
  };
  for (const part of parts) {
    truth.parts.push({
      name: part.name,
      firstVertex: truth.ncz.length,
      vertexCount: vertexCount(part.mesh),
      triangleCount: triangleCount(part.mesh),
      ncz: part.ncz !== false,
      ambiguous: part.ambiguous ?? false,
    });
    for (let v = 0; v < vertexCount(part.mesh); v++) {
      const p = point(part.mesh, v);
      const n: Vec3 = [part.mesh.normals![3 * v]!, part.mesh.normals![3 * v + 1]!, part.mesh.normals![3 * v + 2]!];
      const from = add(p, scale(n, lift));
      const free = directions.filter((d) => dot(d, n) > 0 && !space.hits(from, d)).length;
      const ncz = typeof part.ncz === 'function' ? part.ncz(p) : part.ncz;
      const hidden = !ncz && free === 0;
      const exposed = free >= rays / 8; // a quarter of the half that is on its side
      truth.ncz.push(ncz ? 1 : 0);
      truth.hidden.push(hidden ? 1 : 0);
      truth.ignore.push((!ncz && (!exposed || inside(p))) || part.ambiguous ? 1 : 0);
    }
  }
  return truth;
};

/** For each vertex of the parts 1 if its nearest cage point is on an open border. */
export const offCageOf = (parts: readonly Part[], cage: Mesh): number[] => {
  const space = spaceOf(cage);
  const onBorder = onOpenEdge(weldPositions(cage));
  return parts.flatMap(({ mesh }) =>
    Array.from({ length: vertexCount(mesh) }, (_, v) => (onBorder(space.nearest(point(mesh, v)).point) ? 1 : 0)),
  );
};

/** The same triangles over vertices that differ in position, so that a cut in the UVs is no border. */
export const weldPositions = (mesh: Mesh): Mesh => {
  const place = new Map<string, number>();
  const positions: number[] = [];
  const indices = mesh.indices.map((v) => {
    const p = point(mesh, v);
    const key = p.join();
    let at = place.get(key);
    if (at === undefined) {
      place.set(key, (at = positions.length / 3));
      positions.push(...p);
    }
    return at;
  });
  return { positions: Float32Array.from(positions), indices };
};
