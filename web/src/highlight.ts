import { BufferAttribute, DoubleSide, MeshBasicMaterial, type Mesh } from 'three'
import type { Part } from './extract'
import { onSurface, overlayMesh, shareVertices } from './overlay'

const kColor = '#22d3ff'

/** Lights up some triangles of a part: full where they are seen, faint where something lies in front of them. */
export class Highlight {
  readonly #mesh: Mesh
  readonly #front = onSurface(new MeshBasicMaterial({ color: kColor, opacity: 0.5, side: DoubleSide }))
  readonly #behind = onSurface(new MeshBasicMaterial({ color: kColor, opacity: 0.35, side: DoubleSide, depthTest: false }))

  /** @param vertices 3 per triangle, numbered as the part's own. */
  constructor(part: Part, vertices: Uint32Array) {
    const geometry = shareVertices(part.mesh.geometry).setIndex(new BufferAttribute(vertices, 1))
    geometry.addGroup(0, vertices.length, 0)
    geometry.addGroup(0, vertices.length, 1)
    this.#mesh = overlayMesh(part.mesh, geometry)
    this.#mesh.material = [this.#behind, this.#front]
    this.#mesh.renderOrder = 3
    part.mesh.add(this.#mesh)
  }

  dispose(): void {
    this.#mesh.removeFromParent()
    this.#mesh.geometry.dispose()
    this.#front.dispose()
    this.#behind.dispose()
  }
}
