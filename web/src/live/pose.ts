import { Box3, BufferAttribute, Matrix4, Matrix3, Vector3 } from 'three'
import { matrixOf, type ExtractedMesh, type Part } from '../extract'
import { deform, type Deform, type Room } from './deform'

const kStep = 1e-3 // of half the height: how far apart two points are moved to see how a normal turns

/** A model's shape: moves its vertices, in the arrays to transfer with and in the meshes on show, and brings them back. */
export class Pose {
  readonly #mesh: ExtractedMesh
  readonly #rest: Float32Array
  readonly #parts: PartPose[]

  constructor(mesh: ExtractedMesh) {
    this.#mesh = mesh
    this.#rest = mesh.rest ??= mesh.positions.slice()
    this.#parts = mesh.parts.map((part) => new PartPose(part))
  }

  /** The box of the model at rest. */
  get room(): Room {
    const box = new Box3().setFromArray(this.#rest)
    return { center: box.getCenter(new Vector3()), half: Math.max(0.5 * (box.max.y - box.min.y), Number.MIN_VALUE) }
  }

  /** Where the vertices go. @returns 3 per vertex, in the scene's space. */
  positions(how: Deform, amount: number, room: Room): Float32Array {
    const moved = this.#rest.slice()
    if (amount === 0) return moved // to the last bit
    const point = new Vector3()
    for (let at = 0; at < moved.length; at += 3) {
      point.fromArray(moved, at)
      deform(point, how, amount, room)
      point.toArray(moved, at)
    }
    return moved
  }

  /** Moves the vertices there. */
  set(positions: Float32Array, how: Deform, amount: number, room: Room): void {
    this.#mesh.positions.set(positions)
    for (const part of this.#parts) part.set(positions, how, amount, room)
  }
}

/** One mesh of a model, and what its file says of its vertices. */
class PartPose {
  readonly #part: Part
  readonly #inverse: Matrix4
  readonly #toWorld: Matrix3
  readonly #toLocal: Matrix3
  readonly #atRest: { name: 'position' | 'normal'; attribute: BufferAttribute }[]
  #moved = false

  constructor(part: Part) {
    this.#part = part
    const matrix = matrixOf(part.mesh)
    this.#inverse = matrix.clone().invert()
    this.#toWorld = new Matrix3().getNormalMatrix(matrix)
    this.#toLocal = new Matrix3().setFromMatrix4(matrix).transpose()
    const { attributes } = part.mesh.geometry
    this.#atRest = (['position', 'normal'] as const).flatMap((name) => {
      const attribute = attributes[name] as BufferAttribute | undefined
      return attribute ? [{ name, attribute }] : []
    })
  }

  set(positions: Float32Array, how: Deform, amount: number, room: Room): void {
    const { geometry } = this.#part.mesh
    if (amount === 0) {
      if (this.#moved) for (const { name, attribute } of this.#atRest) geometry.setAttribute(name, attribute)
      this.#moved = false
    } else {
      for (const { name, attribute } of this.#atRest) this.#write(name, attribute, positions, how, amount, room)
      this.#moved = true
    }
    geometry.boundingBox = geometry.boundingSphere = null
  }

  #write(name: 'position' | 'normal', rest: BufferAttribute, positions: Float32Array, how: Deform, amount: number, room: Room): void {
    const { mesh, firstVertex, vertexCount } = this.#part
    // One that is quantised or interleaved cannot hold what moves.
    if (!this.#moved) mesh.geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * vertexCount), 3))
    const attribute = mesh.geometry.getAttribute(name) as BufferAttribute
    const vector = new Vector3()
    for (let vertex = 0; vertex < vertexCount; vertex++) {
      const at = 3 * (firstVertex + vertex)
      if (name === 'position') vector.fromArray(positions, at).applyMatrix4(this.#inverse)
      else this.#turnNormal(vector.fromBufferAttribute(rest, vertex), vertex, how, amount, room)
      attribute.setXYZ(vertex, vector.x, vector.y, vector.z)
    }
    attribute.needsUpdate = true
  }

  /** Turns a normal with the surface: two neighbours of its point are moved as well. */
  #turnNormal(normal: Vector3, vertex: number, how: Deform, amount: number, room: Room): void {
    const { attribute } = this.#atRest[0]!
    const point = new Vector3().fromBufferAttribute(attribute, vertex).applyMatrix4(matrixOf(this.#part.mesh))
    const n = normal.applyMatrix3(this.#toWorld).normalize()
    const across = Math.abs(n.x) < 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0)
    const right = across.cross(n).normalize()
    const up = new Vector3().crossVectors(n, right)
    const step = kStep * room.half
    const [a, b] = [right, up].map((direction) => point.clone().addScaledVector(direction, step)) as [Vector3, Vector3]
    for (const one of [point, a, b]) deform(one, how, amount, room)
    normal.crossVectors(a.sub(point), b.sub(point)).applyMatrix3(this.#toLocal).normalize()
  }
}
