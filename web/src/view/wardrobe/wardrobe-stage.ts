import { type Camera, type Texture, Vector3 } from 'three';
import type { Model } from '../../state/model';
import type { Session } from '../../state/session';
import type { SplitProjection } from '../../state/transfers';
import type { WardrobeView } from '../../state/wardrobe/surroundings';
import { frontOf } from '../framing';
import { pick } from '../pick';
import type { Viewer } from '../viewer';
import { Beside, measure } from './beside';
import { SideBySide } from './side-by-side';

/** Where the name of an avatar belongs, in pixels of the view: the middle of its feet, and the width there is for it. */
export interface Feet {
  x: number;
  y: number;
  width: number;
}

/** Draws the avatars of the wardrobe beside the model on the stage. */
export class WardrobeStage implements WardrobeView {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #paint: Texture;
  readonly #crowd: SideBySide;
  #figures: readonly (Beside | undefined)[] | undefined;

  /**
   * @param paint  The composite of the layers.
   * @param onMove Called with where the figures stand, in their order, in each frame that shows them side by side.
   */
  constructor(session: Session, viewer: Viewer, paint: Texture, onMove: (feet: Feet[]) => void) {
    this.#session = session;
    this.#viewer = viewer;
    this.#paint = paint;
    const canvas = viewer.renderer.domElement;
    const seen = (place: Vector3, camera: Camera): Vector3 => {
      const { x, y } = place.clone().project(camera);
      return new Vector3(((1 + x) / 2) * canvas.clientWidth, ((1 - y) / 2) * canvas.clientHeight);
    };
    this.#crowd = new SideBySide((ends, camera) =>
      onMove(
        ends.map(([left, right]) => {
          const [from, to] = [seen(left, camera), seen(right, camera)];
          return { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2, width: to.x - from.x };
        }),
      ),
    );
  }

  stand(model: Model, projection: SplitProjection | undefined): Beside {
    return new Beside(model, projection, this.#paint);
  }

  arrange(figures: readonly (Beside | undefined)[] | undefined): void {
    this.#figures = figures;
    if (!figures) {
      this.#viewer.setCrowd(undefined);
      return;
    }
    const { target } = this.#session.shown!;
    const room = measure(target);
    for (const figure of figures) {
      if (!figure) continue;
      figure.holder.rotation.y = frontOf(target) - frontOf(figure.model);
      figure.match(room.high);
    }
    this.#crowd.set(figures, room);
    this.#viewer.setCrowd(this.#crowd);
  }

  redraw(): void {
    this.#viewer.redraw();
  }

  /** The figure at a position of the view, in front of the model on the stage. @param x,y Client coordinates. */
  at(x: number, y: number): Beside | undefined {
    if (!this.#figures) return undefined;
    const ray = this.#viewer.screen.eyeRay(x, y);
    const far = (mesh: Model['mesh']): number => pick(mesh, ray)?.seen.distanceTo(ray.ray.origin) ?? Infinity;
    let [found, nearest]: [Beside | undefined, number] = [undefined, far(this.#session.shown!.target.mesh)];
    for (const figure of this.#figures) {
      const distance = figure ? far(figure.model.mesh) : Infinity;
      if (distance < nearest) [found, nearest] = [figure, distance];
    }
    return found;
  }
}
