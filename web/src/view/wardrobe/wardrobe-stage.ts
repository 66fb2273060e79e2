import type { Texture } from 'three';
import type { Model } from '../../state/model';
import type { Session } from '../../state/session';
import type { SplitProjection } from '../../state/transfers';
import type { Avatar } from '../../state/wardrobe/avatar';
import type { WardrobeView } from '../../state/wardrobe/surroundings';
import { frontOf } from '../framing';
import { pick } from '../pick';
import type { Viewer } from '../viewer';
import { Beside, measure } from './beside';
import { SideBySide } from './side-by-side';
import { Thumbnails } from './thumbnails';

/** Draws the avatars of the wardrobe beside the model on the stage, and their pictures. */
export class WardrobeStage implements WardrobeView {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #paint: Texture;
  readonly #crowd = new SideBySide();
  readonly #thumbnails: Thumbnails;
  #figures: readonly (Beside | undefined)[] | undefined;

  /**
   * @param paint  The composite of the layers.
   * @param onDraw Called when pictures were drawn, which turns and moves the avatars.
   */
  constructor(session: Session, viewer: Viewer, paint: Texture, onDraw: () => void) {
    this.#session = session;
    this.#viewer = viewer;
    this.#paint = paint;
    this.#thumbnails = new Thumbnails(session, viewer, onDraw);
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

  refresh(avatars: readonly Avatar[], active: Avatar): void {
    this.#thumbnails.refresh(avatars, active);
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
