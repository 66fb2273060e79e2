import { type Mesh, withMeshNormals } from './mesh.ts'
import { type Vec3, add, frame, mix, scale, sub } from './vec.ts'

/** A ball with its pole along `forward` and UVs whose centre (0.5, 0.5) is that pole, so an iris is a disc in the texture. */
export const eyeball = (
  centre: Vec3, radius: number, forward: Vec3, rings: number, segments: number, cornea = 0.06,
): Mesh => {
  const [right, up, front] = frame(forward)
  const positions: number[] = []
  const uvs: number[] = []
  const normals: number[] = []
  const put = (angle: number, turn: number): void => {
    const s = Math.sin(angle)
    const d = add(add(scale(right, s * Math.cos(turn)), scale(up, s * Math.sin(turn))), scale(front, Math.cos(angle)))
    const bulge = angle < 0.6 ? cornea * (1 - (angle / 0.6) ** 2) : 0
    positions.push(...add(centre, scale(d, radius * (1 + bulge))))
    normals.push(...d)
    const r = (0.48 * angle) / Math.PI
    uvs.push(0.5 + r * Math.cos(turn), 0.5 - r * Math.sin(turn))
  }
  put(0, 0)
  // Closer rings in front, where one looks.
  for (let i = 1; i <= rings; i++)
    for (let j = 0; j < segments; j++) put(Math.PI * (i / (rings + 1)) ** 1.25, (2 * Math.PI * (j + (i % 2) / 2)) / segments)
  // The back pole is drawn out into a ring in the texture: one vertex per triangle.
  const back = positions.length / 3
  for (let j = 0; j < segments; j++) put(Math.PI, (2 * Math.PI * (j + 0.5)) / segments)
  const indices: number[] = []
  const at = (i: number, j: number): number => 1 + (i - 1) * segments + (j % segments)
  for (let j = 0; j < segments; j++) {
    indices.push(0, at(1, j), at(1, j + 1))
    for (let i = 1; i < rings; i++) {
      const odd = i % 2 // odd rings are turned by half a step
      if (odd) indices.push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1))
      else indices.push(at(i, j), at(i + 1, j), at(i, j + 1), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1))
    }
    indices.push(at(rings, j), back + j, at(rings, j + 1))
  }
  return { positions: Float32Array.from(positions), normals: Float32Array.from(normals), uvs: Float32Array.from(uvs), indices: Uint32Array.from(indices) }
}

/** One cross-section of a swept shape: its centre, half width and half depth. */
export interface Ring {
  centre: Vec3
  width: number
  depth: number
}

/** A shape swept through rings, ending in a point: a tooth, a claw. Widths go along `across`. The first ring stays open: it is buried in what it grows from. */
export const spike = (rings: readonly Ring[], tip: Vec3, across: Vec3, sides: number): Mesh => {
  const positions: number[] = []
  const uvs: number[] = []
  rings.forEach((ring, i) => {
    const next = rings[i + 1]?.centre ?? tip
    const [right, w] = frame(sub(next, ring.centre), across)
    const d = scale(right, -1)
    for (let s = 0; s < sides; s++) {
      const a = (2 * Math.PI * s) / sides
      positions.push(...add(ring.centre, add(scale(w, ring.width * Math.cos(a)), scale(d, ring.depth * Math.sin(a)))))
      uvs.push(s / sides, 1 - i / rings.length)
    }
  })
  const top = positions.length / 3
  positions.push(...tip)
  uvs.push(0.5, 0)
  const indices: number[] = []
  for (let i = 0; i < rings.length; i++)
    for (let s = 0; s < sides; s++) {
      const [a, b] = [i * sides + s, i * sides + ((s + 1) % sides)]
      if (i + 1 < rings.length) indices.push(a, b, b + sides, a, b + sides, a + sides)
      else indices.push(a, b, top)
    }
  return withMeshNormals({ positions: Float32Array.from(positions), uvs: Float32Array.from(uvs), indices: Uint32Array.from(indices) })
}

/** Points at equal distances along a polyline, ends left out by half a step. */
export const alongLine = (line: readonly Vec3[], count: number): { at: Vec3; ahead: Vec3 }[] => {
  const lengths = line.slice(1).map((p, i) => Math.hypot(...sub(p, line[i]!)))
  const total = lengths.reduce((a, b) => a + b, 0)
  return Array.from({ length: count }, (_, k) => {
    let left = (total * (k + 0.5)) / count
    let i = 0
    while (i < lengths.length - 1 && left > lengths[i]!) left -= lengths[i++]!
    return { at: mix(line[i]!, line[i + 1]!, left / lengths[i]!), ahead: sub(line[i + 1]!, line[i]!) }
  })
}
