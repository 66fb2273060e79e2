import { BufferAttribute, DoubleSide, type Mesh, MeshBasicMaterial } from 'three';
import { disposeAfterFrame } from '../../platform/programs';
import type { ExtractedMesh, Primitive } from '../../state/model';
import { detachShared, overlayMesh, shareVertices } from './geometry';
import { onSurface } from './materials';

/** Shows marked triangles of a target in a colour. */
export class Highlight {
  readonly #target: ExtractedMesh;
  readonly #materials: MeshBasicMaterial[];
  /** Made on demand. */
  #meshes: { primitive: Primitive; mesh: Mesh }[] | undefined;

  /** @param behind The opacity of what other surfaces hide; by default none of it is seen. */
  constructor(target: ExtractedMesh, color: string, opacity: number, behind?: number) {
    this.#target = target;
    const look = { color, side: DoubleSide };
    this.#materials = [onSurface(new MeshBasicMaterial({ ...look, opacity }))];
    if (behind)
      this.#materials.unshift(onSurface(new MeshBasicMaterial({ ...look, opacity: behind, depthTest: false })));
  }

  /** @param marks 1 for each marked triangle of the target; undefined marks none. */
  show(marks: Uint8Array | undefined): void {
    if (marks) this.#meshes ??= this.#makeMeshes();
    for (const { primitive, mesh } of this.#meshes ?? []) {
      const { firstTriangle, firstVertex, triangleCount } = primitive;
      const index = mesh.geometry.index!;
      let count = 0;
      if (marks)
        for (let t = firstTriangle; t < firstTriangle + triangleCount; t++)
          if (marks[t] === 1)
            for (let i = 3 * t; i < 3 * t + 3; i++) index.setX(count++, this.#target.indices[i]! - firstVertex);
      mesh.visible = count > 0;
      if (count === 0) continue;
      index.needsUpdate = true;
      mesh.geometry.setDrawRange(0, count);
    }
  }

  #makeMeshes(): { primitive: Primitive; mesh: Mesh }[] {
    return this.#target.primitives.map((primitive) => {
      const { mesh: base, triangleCount } = primitive;
      const geometry = shareVertices(base.geometry);
      geometry.setIndex(new BufferAttribute(new Uint32Array(3 * triangleCount), 1));
      detachShared(geometry, base.geometry);
      this.#materials.forEach((_, i) => geometry.addGroup(0, Infinity, i));
      const mesh = overlayMesh(base, geometry);
      mesh.material = this.#materials;
      mesh.renderOrder = 3;
      base.add(mesh);
      return { primitive, mesh };
    });
  }

  dispose(): void {
    for (const { mesh } of this.#meshes ?? []) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
    }
    disposeAfterFrame(this.#materials);
  }
}
