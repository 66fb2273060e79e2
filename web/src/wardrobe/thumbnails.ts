import { MathUtils, type Object3D, PerspectiveCamera } from 'three';
import { kFieldOfView, kHome } from '../view/framing';
import type { Look, Overlay } from '../view/overlay/overlay';
import type { Viewer } from '../view/viewer';

const kRadius = 0.85; // of what is shown, in radii of a model

/** What a thumbnail shows. */
interface Subject {
  /** The model, scaled to a diagonal of 2 about the origin; undefined for the one on the stage. */
  holder: Object3D | undefined;
  /** Of the model; by default that of the one on the stage. */
  overlay: Pick<Overlay, 'show'> | undefined;
  /** Where it looks, as `frontOf`. */
  front: number;
  look: Look;
}

/** Draws a small picture of each of some models, alone, and then all as before. @returns Addresses of the pictures. */
export function drawThumbnails(viewer: Viewer, subjects: readonly Subject[], pixels: number): string[] {
  const { renderer, stage } = viewer;
  const ratio = renderer.getPixelRatio();
  const { clientWidth, clientHeight } = renderer.domElement;
  viewer.prepare();
  stage.isolate();
  renderer.setScissorTest(false);
  renderer.setViewport(0, 0, pixels / ratio, pixels / ratio);
  const pictures = subjects.map((subject) => drawThumbnail(viewer, subject, pixels));
  renderer.setViewport(0, 0, clientWidth, clientHeight);
  stage.object.visible = true;
  viewer.draw(); // now, or what was drawn for the pictures would be seen
  return pictures;
}

function drawThumbnail({ renderer, stage, studio }: Viewer, subject: Subject, pixels: number): string {
  const { holder, overlay = stage, front, look } = subject;
  const camera = new PerspectiveCamera(kFieldOfView, 1, 0.05, 50);
  const distance = kRadius / Math.sin(MathUtils.degToRad(kFieldOfView / 2));
  camera.position.setFromSphericalCoords(distance, kHome.phi, front + kHome.theta);
  camera.lookAt(0, 0, 0);
  stage.object.visible = !holder;
  const parent = holder?.parent;
  if (holder) {
    studio.scene.add(holder);
    holder.position.set(0, 0, 0);
    holder.rotation.set(0, 0, 0);
  }
  overlay.show(look);
  studio.follow(camera);
  renderer.render(studio.scene, camera);
  holder?.removeFromParent();
  if (holder) parent?.add(holder);
  const picture = document.createElement('canvas');
  picture.width = picture.height = pixels;
  const top = renderer.domElement.height - pixels;
  picture.getContext('2d')!.drawImage(renderer.domElement, 0, top, pixels, pixels, 0, 0, pixels, pixels);
  return picture.toDataURL();
}
