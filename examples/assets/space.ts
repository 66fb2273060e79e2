import { BufferAttribute, BufferGeometry, DoubleSide, Ray, Vector3 } from 'three'
import { MeshBVH } from 'three-mesh-bvh'
import { type Mesh, diagonalOf, faceNormal, openEdges, point } from './mesh.ts'
import { type Vec3, add, clamp, dot, length, scale, sub, unit } from './vec.ts'

/** Questions about a mesh in space. */
export interface Space {
  /** The nearest point of the surface, its triangle, and the signed distance from the triangle's plane (+ is outside). */
  nearest(p: Vec3): { point: Vec3; triangle: number; distance: number; side: number }
  /** Whether a ray hits the mesh, from either side. */
  hits(from: Vec3, direction: Vec3): boolean
}

export const spaceOf = (mesh: Mesh): Space => {
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3))
  geometry.setIndex(new BufferAttribute(mesh.indices.slice(), 1))
  const bvh = new MeshBVH(geometry, { indirect: true })
  const ray = new Ray()
  const query = new Vector3()
  return {
    nearest(p) {
      const hit = bvh.closestPointToPoint(query.set(...p))
      if (!hit) throw new Error('spaceOf: the mesh has no triangles')
      const q: Vec3 = [hit.point.x, hit.point.y, hit.point.z]
      return { point: q, triangle: hit.faceIndex, distance: hit.distance, side: dot(sub(p, q), unit(faceNormal(mesh, hit.faceIndex))) }
    },
    hits(from, direction) {
      ray.origin.set(...from)
      ray.direction.set(...direction)
      return bvh.raycastFirst(ray, DoubleSide) !== null
    },
  }
}

/** A function that says whether a point of the surface lies on one of the mesh's open edges. */
export const onOpenEdge = (mesh: Mesh): ((p: Vec3) => boolean) => {
  const edges = openEdges(mesh).map(([a, b]) => [point(mesh, a), point(mesh, b)] as const)
  const near = 1e-5 * diagonalOf(mesh.positions)
  return (p) =>
    edges.some(([a, b]) => {
      const ab = sub(b, a)
      const t = clamp(dot(sub(p, a), ab) / dot(ab, ab))
      return length(sub(p, add(a, scale(ab, t)))) < near
    })
}
