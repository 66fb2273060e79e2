import type { Classification } from 'cagecast'
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  GreaterDepth,
  LessEqualDepth,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  SkinnedMesh,
  type Material,
  type Texture,
} from 'three'
import type { Part } from './extract'

/** What lies over the target: the paint alone, everywhere, or what the filter leaves of it. */
export type Look = 'naive' | 'filtered'

/** Colours of the reasons, by zone. After Okabe and Ito, so that colour-blind eyes tell them apart; see style.css. */
const kReasonColors = { 1: '#0072b2', 2: '#e69f00', 3: '#cc79a7' } as const

/** What may be painted, while the zones are looked at: a paint of any colour could be mistaken for one. */
const kClayColor = '#9aa7b3'

// The transferred UVs take a channel that glTF models do not fill, so the base maps keep theirs.
const kUvChannel = 3
const kUvName = `uv${kUvChannel}`

/** The order of a part's triangles: those that may be painted, then the NCZ ones by reason. */
const kZones = [0, 1, 2, 3] as const
const kReasons = [1, 2, 3] as const

// Places in a layer's list of materials: the paint, the three reasons, the three reasons seen through the surface, clay.
const kHidden = 3
const kClay = 7

/**
 * The paint and the zones over a target, one mesh for each of its parts. They share its vertices, skin and morphs, and
 * differ in their UVs and in which triangles they draw.
 */
export class Overlay {
  readonly #layers: Layer[]

  /**
   * Lays nothing yet: call `classify`.
   * @param parts The target's, in the order they were extracted.
   * @param uvs   2 per target vertex, in the paint.
   */
  constructor(parts: readonly Part[], uvs: Float32Array, paint: Texture) {
    this.#layers = parts.filter((part) => part.triangleCount > 0).map((part) => new Layer(part, uvs, paint))
  }

  /** Chooses which triangles are painted, and which are which zone. */
  classify(classification: Classification): void {
    for (const layer of this.#layers) layer.classify(classification)
  }

  setPaint(paint: Texture): void {
    for (const layer of this.#layers) layer.setPaint(paint)
  }

  /** Chooses what the next frame draws. Zones show in the filtered look only, and there in place of the paint. */
  show(look: Look, paint: boolean, zones: boolean): void {
    for (const layer of this.#layers) layer.show(look, paint, zones)
  }

  dispose(): void {
    for (const layer of this.#layers) layer.dispose()
  }
}

class Layer {
  readonly #part: Part
  readonly #mesh: Mesh
  readonly #geometry = new BufferGeometry()
  readonly #paint: MeshStandardMaterial
  readonly #nothing = new MeshBasicMaterial({ visible: false })
  readonly #reasons = kReasons.map((zone) => reasonMaterial(kReasonColors[zone]))
  readonly #clay = onSurface(new MeshStandardMaterial({ color: kClayColor, roughness: 0.85 }))
  readonly #hidden = kReasons.map((zone) => hiddenMaterial(kReasonColors[zone]))

  constructor(part: Part, uvs: Float32Array, paint: Texture) {
    this.#part = part
    const { mesh, firstVertex, vertexCount, triangleCount } = part
    const source = mesh.geometry
    for (const [name, attribute] of Object.entries(source.attributes)) this.#geometry.setAttribute(name, attribute)
    this.#geometry.morphAttributes = source.morphAttributes
    this.#geometry.morphTargetsRelative = source.morphTargetsRelative
    this.#geometry.boundingSphere = source.boundingSphere
    this.#geometry.setAttribute(kUvName, new BufferAttribute(uvs.slice(2 * firstVertex, 2 * (firstVertex + vertexCount)), 2))
    this.#geometry.setIndex(new BufferAttribute(new Uint32Array(3 * triangleCount), 1))

    this.#paint = paintMaterial([mesh.material].flat()[0]!)
    this.setPaint(paint)
    this.#mesh = overlayMesh(mesh, this.#geometry)
    mesh.add(this.#mesh)
  }

  classify(classification: Classification): void {
    const { mesh, triangleCount } = this.#part
    const source = mesh.geometry.index
    const index = this.#geometry.index!
    const reasons = this.#reasonsOf(classification)

    this.#geometry.clearGroups()
    let filled = 0
    for (const zone of kZones) {
      const start = filled
      for (let triangle = 0; triangle < triangleCount; triangle++) {
        if (reasons[triangle] !== zone) continue
        for (let corner = 3 * triangle; corner < 3 * triangle + 3; corner++) index.array[filled++] = source ? source.array[corner]! : corner
      }
      if (filled === start) continue
      const draw = (material: number): void => this.#geometry.addGroup(start, filled - start, material)
      draw(zone)
      if (zone === 0) draw(kClay)
      // Drawn a second time where something lies in front of it: most zones are inside.
      if (zone > 0) draw(kHidden + zone)
    }
    index.needsUpdate = true
  }

  /** 1 per triangle: 0 where it may be painted, else the zone, of those of its corners, that was decided last. */
  #reasonsOf({ zones, cosmeticTriangles }: Classification): Uint8Array {
    const { mesh, firstVertex, firstTriangle, triangleCount } = this.#part
    const source = mesh.geometry.index
    const zoneAt = (corner: number): number => zones[firstVertex + (source ? source.array[corner]! : corner)]!
    const reasons = new Uint8Array(triangleCount)
    for (let triangle = 0; triangle < triangleCount; triangle++) {
      if (cosmeticTriangles[firstTriangle + triangle]) continue
      reasons[triangle] = Math.max(zoneAt(3 * triangle), zoneAt(3 * triangle + 1), zoneAt(3 * triangle + 2))
    }
    return reasons
  }

  setPaint(paint: Texture): void {
    paint.channel = kUvChannel
    this.#paint.map = paint
  }

  show(look: Look, paint: boolean, zones: boolean): void {
    const painted = paint ? this.#paint : this.#nothing
    // A group whose material is missing here is not drawn.
    if (look === 'naive') this.#mesh.material = [painted, painted, painted, painted]
    else if (zones) this.#mesh.material = [this.#nothing, ...this.#reasons, ...this.#hidden, this.#clay]
    else this.#mesh.material = [painted]
  }

  dispose(): void {
    this.#mesh.removeFromParent()
    this.#geometry.dispose()
    for (const material of [this.#paint, this.#nothing, this.#clay, ...this.#reasons, ...this.#hidden]) material.dispose()
  }
}

/** Makes a mesh that moves, bends and morphs as `base` does. */
function overlayMesh(base: Mesh, geometry: BufferGeometry): Mesh {
  let mesh: Mesh
  if (base instanceof SkinnedMesh) {
    const skinned = new SkinnedMesh(geometry)
    skinned.bindMode = base.bindMode
    skinned.bind(base.skeleton, base.bindMatrix)
    mesh = skinned
  } else {
    mesh = new Mesh(geometry)
  }
  if (base.morphTargetInfluences) {
    // The same array, not a copy: it follows every change.
    mesh.morphTargetInfluences = base.morphTargetInfluences
    mesh.morphTargetDictionary = base.morphTargetDictionary!
  }
  mesh.frustumCulled = base.frustumCulled
  mesh.renderOrder = 1
  mesh.receiveShadow = true
  return mesh
}

/** Paint takes the surface's gloss and relief, but neither its colour nor its glow. */
function paintMaterial(base: Material): MeshStandardMaterial {
  const paint = base instanceof MeshStandardMaterial ? new MeshStandardMaterial().copy(base) : new MeshStandardMaterial({ roughness: 0.7 })
  paint.color = new Color('white')
  paint.emissive = new Color('black')
  paint.emissiveMap = paint.alphaMap = paint.lightMap = null
  paint.vertexColors = false
  paint.metalness = 0
  paint.metalnessMap = null
  paint.alphaTest = 0
  paint.opacity = 1
  return onSurface(paint)
}

function reasonMaterial(color: string): Material {
  // Glowing a little and lit less than the rest, so that the legend's colour is met in the light and in the shade.
  const lit = { color: new Color(color).multiplyScalar(0.6), emissive: color, emissiveIntensity: 0.3, roughness: 1 }
  return onSurface(new MeshStandardMaterial({ ...lit, side: DoubleSide }))
}

function hiddenMaterial(color: string): Material {
  const material = onSurface(new MeshBasicMaterial({ color, opacity: 0.28, side: DoubleSide }))
  material.depthFunc = GreaterDepth
  material.polygonOffset = false
  return material
}

/** Lets a material lie on the surface it shares its vertices with. */
function onSurface<M extends Material>(material: M): M {
  material.transparent = true
  material.depthWrite = false
  material.depthFunc = LessEqualDepth
  material.polygonOffset = true
  material.polygonOffsetFactor = -1
  material.polygonOffsetUnits = -1
  return material
}
