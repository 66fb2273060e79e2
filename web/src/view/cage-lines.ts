import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments } from 'three';
import { disposeAfterFrame } from '../platform/programs';
import type { ExtractedMesh } from '../state/model';

/** The cage as a wireframe; faint where the target is in front of it. */
export class CageLines {
  readonly object = new Group();
  readonly #lines = new BufferGeometry();
  readonly #front = new LineBasicMaterial({ color: '#19b394', transparent: true, opacity: 0.85, depthWrite: false });
  readonly #behind = new LineBasicMaterial({
    color: '#19b394',
    transparent: true,
    opacity: 0.14,
    depthWrite: false,
    depthTest: false,
  });

  constructor(cage: ExtractedMesh) {
    const { positions, indices } = cage;
    const edges = new Map<number, [number, number]>();
    indices.forEach((a, i) => {
      const b = indices[i % 3 === 2 ? i - 2 : i + 1]!;
      edges.set(Math.min(a, b) * positions.length + Math.max(a, b), [a, b]);
    });
    this.#lines.setAttribute('position', new BufferAttribute(positions, 3));
    this.#lines.setIndex(new BufferAttribute(Uint32Array.from([...edges.values()].flat()), 1));
    this.object.add(new LineSegments(this.#lines, this.#behind), new LineSegments(this.#lines, this.#front));
    for (const lines of this.object.children) Object.assign(lines, { renderOrder: 2, frustumCulled: false });
  }

  /** Draws the positions of the cage as they are now. */
  update(): void {
    this.#lines.getAttribute('position').needsUpdate = true;
  }

  show(visible: boolean): void {
    this.object.visible = visible;
  }

  dispose(): void {
    this.object.removeFromParent();
    this.#lines.dispose();
    disposeAfterFrame([this.#front, this.#behind]);
  }
}
