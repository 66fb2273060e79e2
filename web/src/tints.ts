import type { Classification } from 'cagecast'
import { colorAt, kDiverging, kSequential, type ColorMap, type Rgb } from './colors'
import type { ExtractedMesh } from './extract'
import { segmentColors } from './segments'
import type { Shown } from './session'
import { diagonalOf } from './surface'

/** What colours stand for: a scale from one end to the other. */
export interface Scale {
  title: string
  map: ColorMap
  /** Evenly apart, from the first colour to the last. */
  ticks: string[]
}

/** Colours for a target, 3 bytes per triangle corner, and what they stand for, where that can be said. */
export interface Tint {
  colors: Uint8Array
  scale?: Scale
}

/** What may not be painted, where only paint is judged. */
const kClay: Rgb = [154, 167, 179]
const kFarthest = 0.98 // of what may be painted lies within the scale: an inside far away would make all of it look alike
const kDoublings = 2 // either way, from the middle of the scale of stretch to its ends

/** Each segment in a colour of its own. */
export function tintSegments(shown: Shown): Tint {
  const colors = segmentColors(shown)
  const { segments } = shown.projection
  return { colors: perCorner(shown.target.mesh, (vertex) => colors[segments[vertex]!]!) }
}

/** How far each vertex is from the cage. */
export function tintDistance({ target: { mesh }, projection: { distances } }: Shown, { zones }: Classification): Tint {
  const diagonal = diagonalOf(mesh) || 1
  const cosmetic = distances.filter((_, vertex) => zones[vertex] === 0)
  const sorted = (cosmetic.length > 0 ? cosmetic : distances).toSorted()
  const longest = roundedUp((100 * sorted[Math.floor(kFarthest * (sorted.length - 1))]!) / diagonal)
  const colors = perCorner(mesh, (vertex) => colorAt(kSequential, (100 * distances[vertex]!) / diagonal / longest))
  const ticks = [0, 0.25, 0.5, 0.75, 1].map((share) => `${share === 1 ? '≥ ' : ''}${Number((share * longest).toPrecision(3))}`)
  return { colors, scale: { title: 'Distance to the cage, % of the model’s diagonal', map: kSequential, ticks } }
}

/**
 * How far the paint is stretched over each triangle that may be painted: how long one step in the texture becomes on the
 * model in the direction where that is longest, against what is usual there.
 */
export function tintStretch({ target: { mesh }, projection }: Shown, { cosmeticTriangles }: Classification): Tint {
  const stretch = stretches(mesh, projection)
  const usual = medianOf(stretch.filter((value, triangle) => cosmeticTriangles[triangle] === 1 && Number.isFinite(value))) || 1
  const colors = perCorner(mesh, (_, triangle) => {
    if (cosmeticTriangles[triangle] !== 1) return kClay
    return colorAt(kDiverging, 0.5 + Math.log2(stretch[triangle]! / usual) / (2 * kDoublings))
  })
  const ticks = ['≤ ¼×', '½×', '1×', '2×', '≥ 4×']
  return { colors, scale: { title: 'Stretch of the paint, against the usual', map: kDiverging, ticks } }
}

/** 1 per triangle: the larger singular value of the map from the texture to its surface; infinite where it has no area in the texture. */
function stretches({ positions, indices }: ExtractedMesh, { uvs, cornerUvs }: Shown['projection']): Float64Array {
  return Float64Array.from({ length: indices.length / 3 }, (_, triangle) => {
    const corner = (c: number): [number, number, number, number, number] => {
      const at = 3 * triangle + c
      const vertex = indices[at]!
      const [u, v] = cornerUvs.length > 0 ? cornerUvs.subarray(2 * at, 2 * at + 2) : uvs.subarray(2 * vertex, 2 * vertex + 2)
      return [positions[3 * vertex]!, positions[3 * vertex + 1]!, positions[3 * vertex + 2]!, u!, v!]
    }
    const [a, b, c] = [corner(0), corner(1), corner(2)]
    const area = (b[3] - a[3]) * (c[4] - a[4]) - (c[3] - a[3]) * (b[4] - a[4])
    if (area === 0) return Infinity
    // How the place on the surface moves with u and with v; after Sander et al., Texture Mapping Progressive Meshes, 2001.
    let [uu, uv, vv] = [0, 0, 0]
    for (const axis of [0, 1, 2] as const) {
      const alongU = ((b[axis] - a[axis]) * (c[4] - a[4]) - (c[axis] - a[axis]) * (b[4] - a[4])) / area
      const alongV = ((c[axis] - a[axis]) * (b[3] - a[3]) - (b[axis] - a[axis]) * (c[3] - a[3])) / area
      uu += alongU * alongU
      uv += alongU * alongV
      vv += alongV * alongV
    }
    return Math.sqrt((uu + vv + Math.hypot(uu - vv, 2 * uv)) / 2)
  })
}

function perCorner({ indices }: ExtractedMesh, colorOf: (vertex: number, triangle: number) => Rgb): Uint8Array {
  const colors = new Uint8Array(3 * indices.length)
  indices.forEach((vertex, corner) => colors.set(colorOf(vertex, Math.floor(corner / 3)), 3 * corner))
  return colors
}

function medianOf(values: Float64Array): number {
  return values.toSorted()[Math.floor(values.length / 2)] ?? 0
}

/** The next of 1, 2, 4, 6, 8 and 10 times a power of ten: they part well in four. */
function roundedUp(value: number): number {
  if (!(value > 0)) return 1
  const power = 10 ** Math.floor(Math.log10(value))
  return power * [1, 2, 4, 6, 8, 10].find((step) => step * power >= value)!
}
