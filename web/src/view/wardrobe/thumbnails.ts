import { MathUtils, PerspectiveCamera } from 'three';
import type { Session } from '../../state/session';
import type { Avatar } from '../../state/wardrobe/avatar';
import { frontOf, kFieldOfView, kHome } from '../framing';
import type { Viewer } from '../viewer';
import type { Beside } from './beside';

const kDelay = 1500; // milliseconds without a change before they are drawn again
const kPixels = 128; // per side
const kRadius = 0.85; // of what is shown, in radii of a model

/** Draws the pictures of avatars, each alone. */
export class Thumbnails {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #onDraw: () => void;
  readonly #outdated = new Set<Avatar>();
  /** The one on the stage. */
  #active: Avatar | undefined;
  #waiting: ReturnType<typeof setTimeout> | undefined;

  /** @param onDraw Called when some were drawn, which turns and moves the avatars. */
  constructor(session: Session, viewer: Viewer, onDraw: () => void) {
    this.#session = session;
    this.#viewer = viewer;
    this.#onDraw = onDraw;
  }

  /** Draws the pictures of some avatars again, once nothing has changed for a while. */
  refresh(avatars: readonly Avatar[], active: Avatar): void {
    this.#active = active;
    for (const avatar of avatars) this.#outdated.add(avatar);
    const isNew = [...this.#outdated].some(({ picture }) => picture === '');
    clearTimeout(this.#waiting);
    this.#waiting = setTimeout(() => this.#drawAll(), isNew ? 0 : kDelay);
  }

  #drawAll(): void {
    const { shown, classification } = this.#session;
    if (!shown || !classification) return; // the zones bring it up again
    const avatars = [...this.#outdated].filter((avatar) => avatar === this.#active || avatar.standing);
    this.#outdated.clear();
    if (avatars.length === 0) return;
    const { renderer, stage } = this.#viewer;
    const ratio = renderer.getPixelRatio();
    const { clientWidth, clientHeight } = renderer.domElement;
    this.#viewer.prepare();
    stage.isolate();
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, kPixels / ratio, kPixels / ratio);
    for (const avatar of avatars) avatar.picture = this.#draw(avatar);
    renderer.setViewport(0, 0, clientWidth, clientHeight);
    stage.object.visible = true;
    this.#viewer.draw(); // now, or what was drawn for the pictures would be seen
    this.#onDraw();
  }

  /** @returns The address of the picture. */
  #draw(avatar: Avatar): string {
    const { renderer, stage, studio } = this.#viewer;
    const standing = avatar === this.#active ? undefined : (avatar.standing as Beside | undefined);
    const front = standing ? frontOf(standing.model) : stage.front;
    const camera = new PerspectiveCamera(kFieldOfView, 1, 0.05, 50);
    const distance = kRadius / Math.sin(MathUtils.degToRad(kFieldOfView / 2));
    camera.position.setFromSphericalCoords(distance, kHome.phi, front + kHome.theta);
    camera.lookAt(0, 0, 0);
    stage.object.visible = !standing;
    const { holder, overlay } = standing ?? { overlay: stage };
    standing?.match();
    const parent = holder?.parent;
    if (holder) {
      studio.scene.add(holder);
      holder.position.set(0, 0, 0);
      holder.rotation.set(0, 0, 0);
    }
    overlay?.show(avatar.takesPaint || avatar.own ? 'result' : 'bare');
    studio.follow(camera);
    renderer.render(studio.scene, camera);
    holder?.removeFromParent();
    if (holder) parent?.add(holder);
    const picture = document.createElement('canvas');
    picture.width = picture.height = kPixels;
    const top = renderer.domElement.height - kPixels;
    picture.getContext('2d')!.drawImage(renderer.domElement, 0, top, kPixels, kPixels, 0, 0, kPixels, kPixels);
    return picture.toDataURL();
  }
}
