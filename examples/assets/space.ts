import { BufferAttribute, BufferGeometry, DoubleSide, Ray, Vector3 } from 'three';
import { MeshBVH } from 'three-mesh-bvh';
import { diagonalOf, faceNormal, type Mesh, openEdges, point } from './mesh.ts';
import { add, clamp, dot, length, scale, sub, unit, type Vec3 } from './vec.ts';

export interface Nearest {
  point: Vec3;
  triangle: number;
  distance: number;
  side: number;
}

/** Questions about a mesh in space. */
export interface Space {
  /**
   * The nearest point of the surface, its triangle, and the signed distance from the triangle's plane (+ is outside). Where
   * several triangles share the point, the one whose plane is farthest: its side is the true one.
   */
  nearest(p: Vec3): Nearest;
  /** Where a ray first hits the mesh, from either side. */
  hit(from: Vec3, direction: Vec3): Vec3 | undefined;
  /** Whether a ray hits the mesh, from either side. */
  hits(from: Vec3, direction: Vec3): boolean;
}

export const spaceOf = (mesh: Mesh): Space => {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3));
  geometry.setIndex(new BufferAttribute(mesh.indices.slice(), 1));
  const bvh = new MeshBVH(geometry, { indirect: true });
  const ray = new Ray();
  const query = new Vector3();
  const found = new Vector3();
  const tie = 1e-6 * diagonalOf(mesh.positions);
  return {
    nearest(p) {
      const hit = bvh.closestPointToPoint(query.set(...p));
      if (!hit) throw new Error('spaceOf: the mesh has no triangles');
      const q: Vec3 = [hit.point.x, hit.point.y, hit.point.z];
      const sideOf = (triangle: number): number => dot(sub(p, q), unit(faceNormal(mesh, triangle)));
      const best = { point: q, triangle: hit.faceIndex, distance: hit.distance, side: sideOf(hit.faceIndex) };
      // Straight above the inside of a triangle there is no other.
      if (Math.abs(best.side) > 0.9999 * hit.distance) return best;
      const limit = hit.distance + tie;
      bvh.shapecast({
        intersectsBounds: (bounds) => bounds.distanceToPoint(query) <= limit,
        intersectsTriangle: (triangle, index) => {
          if (triangle.closestPointToPoint(query, found).distanceTo(query) > limit) return false;
          const side = sideOf(index);
          if (Math.abs(side) > Math.abs(best.side)) Object.assign(best, { triangle: index, side });
          return false;
        },
      });
      return best;
    },
    hit(from, direction) {
      ray.origin.set(...from);
      ray.direction.set(...unit(direction));
      const first = bvh.raycastFirst(ray, DoubleSide);
      return first ? [first.point.x, first.point.y, first.point.z] : undefined;
    },
    hits(from, direction) {
      ray.origin.set(...from);
      ray.direction.set(...direction);
      return bvh.raycastFirst(ray, DoubleSide) !== null;
    },
  };
};

/** A function that says whether a point of the surface lies on one of the mesh's open edges. */
export const onOpenEdge = (mesh: Mesh): ((p: Vec3) => boolean) => {
  const edges = openEdges(mesh).map(([a, b]) => [point(mesh, a), point(mesh, b)] as const);
  const near = 1e-5 * diagonalOf(mesh.positions);
  return (p) =>
    edges.some(([a, b]) => {
      const ab = sub(b, a);
      const t = clamp(dot(sub(p, a), ab) / dot(ab, ab));
      return length(sub(p, add(a, scale(ab, t)))) < near;
    });
};
