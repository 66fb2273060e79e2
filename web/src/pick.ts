import { BackSide, DoubleSide, Raycaster, Triangle, Vector3, type BufferAttribute, type Camera, type InterleavedBufferAttribute, type Vector2 } from 'three'
import type { ExtractedMesh, Part } from './extract'
import { firstHit, type Side } from './ray'

/** A spot on the surface of a target. */
export interface Spot {
  /** The number of its triangle. */
  triangle: number
  /** What share each corner has in it, in the order of the target's indices. */
  weights: [number, number, number]
  /** Where it is in the model as it was transferred, in its space. */
  point: Vector3
  /** Where it is seen, in the studio: elsewhere than `point` says if the model is posed. */
  seen: Vector3
}

/**
 * Finds what of a target is seen at a place of the picture, skins and morphs as they are posed.
 * @param at From −1 to 1 from the left to the right, and from the lower edge to the upper.
 */
export function pick(target: ExtractedMesh, camera: Camera, at: Vector2): Spot | undefined {
  const raycaster = new Raycaster()
  raycaster.setFromCamera(at, camera)
  let nearest: { part: Part; hit: PartHit } | undefined
  for (const part of target.parts) {
    const hit = isPlain(part) ? hitPlain(part, raycaster) : hitPosed(part, raycaster)
    if (hit && (!nearest || hit.distance < nearest.hit.distance)) nearest = { part, hit }
  }
  return nearest && spotOf(target, nearest.part, nearest.hit)
}

interface PartHit {
  /** Of the part. */
  triangle: number
  point: Vector3
  distance: number
}

/** Whether what is drawn of a part are the vertices it has, moved as a whole. */
function isPlain({ mesh }: Part): boolean {
  const isPosed = 'isSkinnedMesh' in mesh || mesh.morphTargetInfluences?.some((influence) => influence !== 0)
  return !isPosed && mesh.geometry.index !== null && mesh.geometry.hasAttribute('position')
}

/** A tenth of the time of the other, which must ask for every vertex where it is. */
function hitPlain({ mesh }: Part, { ray }: Raycaster): PartHit | undefined {
  const { index, attributes } = mesh.geometry
  const local = ray.clone().applyMatrix4(mesh.matrixWorld.clone().invert())
  const surface = { positions: packed(attributes.position as BufferAttribute | InterleavedBufferAttribute), indices: index!.array }
  const hit = firstHit(surface, local.origin, local.direction, 0, sideOf(mesh))
  if (!hit) return undefined
  const point = mesh.localToWorld(local.at(hit.length, new Vector3()))
  return { triangle: hit.triangle, point, distance: point.distanceTo(ray.origin) }
}

/** What was unpacked, until it changes. */
const unpacked = new WeakMap<object, { version: number; values: Float32Array }>()

/** The numbers of an attribute one after the other, as floats. */
function packed(attribute: BufferAttribute | InterleavedBufferAttribute): Float32Array {
  const buffer = 'isInterleavedBufferAttribute' in attribute ? attribute.data : attribute
  if (buffer === attribute && buffer.array instanceof Float32Array) return buffer.array
  const { version } = buffer as BufferAttribute
  const known = unpacked.get(attribute)
  if (known?.version === version) return known.values
  const values = Float32Array.from({ length: 3 * attribute.count }, (_, i) => attribute.getComponent(Math.floor(i / 3), i % 3))
  unpacked.set(attribute, { version, values })
  return values
}

function hitPosed({ mesh }: Part, raycaster: Raycaster): PartHit | undefined {
  const [hit] = raycaster.intersectObject(mesh, false)
  return hit && { triangle: hit.faceIndex!, point: hit.point, distance: hit.distance }
}

/** Which sides of a mesh are drawn; of one in several materials as of the first. */
function sideOf({ material }: Part['mesh']): Side {
  const { side } = [material].flat()[0]!
  return side === DoubleSide ? 'both' : side === BackSide ? 'back' : 'front'
}

function spotOf({ positions, indices }: ExtractedMesh, { mesh, firstVertex, firstTriangle }: Part, hit: PartHit): Spot {
  const triangle = firstTriangle + hit.triangle
  const corners = [0, 1, 2].map((corner) => indices[3 * triangle + corner]!) as [number, number, number]
  // The corners as they are posed; in the order of the target's indices, which are turned where the part is mirrored.
  const posed = corners.map((vertex) => mesh.localToWorld(mesh.getVertexPosition(vertex - firstVertex, new Vector3()))) as [Vector3, Vector3, Vector3]
  const weights = Triangle.getBarycoord(hit.point, ...posed, new Vector3()) ?? new Vector3(1, 0, 0)
  const stored = corners.map((vertex) => new Vector3().fromArray(positions, 3 * vertex)) as [Vector3, Vector3, Vector3]
  const point = new Vector3()
  stored.forEach((corner, i) => point.addScaledVector(corner, weights.getComponent(i)))
  return { triangle, weights: weights.toArray(), point, seen: hit.point }
}
