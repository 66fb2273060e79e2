import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, WireframeGeometry } from 'three';
import { disposeAfterFrame } from '../platform/programs';
import type { ExtractedMesh } from '../scene/extract-mesh';

/** The cage as a wireframe; faint where the target is in front of it. */
export class CageLines {
  readonly object = new Group();
  readonly #lines: WireframeGeometry;
  readonly #front = new LineBasicMaterial({ color: '#19b394', transparent: true, opacity: 0.85, depthWrite: false });
  readonly #behind = new LineBasicMaterial({
    color: '#19b394',
    transparent: true,
    opacity: 0.14,
    depthWrite: false,
    depthTest: false,
  });

  constructor(cage: ExtractedMesh) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(cage.positions, 3));
    geometry.setIndex(new BufferAttribute(cage.indices, 1));
    this.#lines = new WireframeGeometry(geometry);
    this.object.add(new LineSegments(this.#lines, this.#behind), new LineSegments(this.#lines, this.#front));
    for (const lines of this.object.children) lines.renderOrder = 2;
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
