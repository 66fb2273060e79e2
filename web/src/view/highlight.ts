import { BufferAttribute, DoubleSide, type Mesh, MeshBasicMaterial } from 'three';
import { disposeAfterFrame } from '../platform/programs';
import type { ExtractedMesh } from '../scene/extract-mesh';
import { detachShared, overlayMesh, shareVertices } from './overlay-geometry';
import { onSurface } from './overlay-materials';

const kColor = '#22d3ff';

/** Highlights triangles of a target; faint where something is in front of them. */
export class Highlight {
  readonly #meshes: Mesh[] = [];
  readonly #front = onSurface(new MeshBasicMaterial({ color: kColor, opacity: 0.5, side: DoubleSide }));
  readonly #behind = onSurface(
    new MeshBasicMaterial({ color: kColor, opacity: 0.35, side: DoubleSide, depthTest: false }),
  );

  /** @param triangles Indices of the target's triangles. */
  constructor({ primitives, indices }: ExtractedMesh, triangles: readonly number[]) {
    for (const { mesh: base, firstVertex, firstTriangle, triangleCount } of primitives) {
      const own = triangles.filter((triangle) => triangle >= firstTriangle && triangle < firstTriangle + triangleCount);
      if (own.length === 0) continue;
      const vertices = Uint32Array.from(
        { length: 3 * own.length },
        (_, i) => indices[3 * own[Math.floor(i / 3)]! + (i % 3)]! - firstVertex,
      );
      const geometry = shareVertices(base.geometry).setIndex(new BufferAttribute(vertices, 1));
      detachShared(geometry, base.geometry);
      geometry.addGroup(0, vertices.length, 0);
      geometry.addGroup(0, vertices.length, 1);
      const mesh = overlayMesh(base, geometry);
      mesh.material = [this.#behind, this.#front];
      mesh.renderOrder = 3;
      base.add(mesh);
      this.#meshes.push(mesh);
    }
  }

  dispose(): void {
    for (const mesh of this.#meshes) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
    }
    disposeAfterFrame([this.#front, this.#behind]);
  }
}
