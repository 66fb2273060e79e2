import { BufferAttribute, DoubleSide, type Mesh, MeshBasicMaterial } from 'three';
import type { ExtractedMesh, Primitive } from '../scene/extract-mesh';
import { detachShared, overlayMesh, shareVertices } from '../view/overlay-geometry';
import { onSurface } from '../view/overlay-materials';

const kColor = '#d81b60';

/** Shows on a target which triangles are marked. */
export class BareMarks {
  readonly #indices: Uint32Array;
  readonly #parts: { primitive: Primitive; mesh: Mesh }[];
  readonly #material = onSurface(new MeshBasicMaterial({ color: kColor, opacity: 0.55, side: DoubleSide }));

  constructor({ primitives, indices }: ExtractedMesh) {
    this.#indices = indices;
    this.#parts = primitives.map((primitive) => {
      const { mesh: base, triangleCount } = primitive;
      const geometry = shareVertices(base.geometry);
      geometry.setIndex(new BufferAttribute(new Uint32Array(3 * triangleCount), 1));
      detachShared(geometry, base.geometry);
      const mesh = overlayMesh(base, geometry);
      mesh.material = this.#material;
      mesh.renderOrder = 3;
      mesh.visible = false;
      base.add(mesh);
      return { primitive, mesh };
    });
  }

  /** @param marks 1 for each marked triangle of the target. */
  show(marks: Uint8Array | undefined): void {
    for (const { primitive, mesh } of this.#parts) {
      const { firstTriangle, firstVertex, triangleCount } = primitive;
      const index = mesh.geometry.index!;
      let count = 0;
      for (let t = firstTriangle; t < firstTriangle + triangleCount; t++)
        if (marks?.[t] === 1)
          for (let i = 3 * t; i < 3 * t + 3; i++) index.setX(count++, this.#indices[i]! - firstVertex);
      index.needsUpdate = true;
      mesh.geometry.setDrawRange(0, count);
      mesh.visible = count > 0;
    }
  }

  dispose(): void {
    for (const { mesh } of this.#parts) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
    }
    this.#material.dispose();
  }
}
