import { type Bone, MathUtils, type Object3D, type PerspectiveCamera, Spherical, Vector3 } from 'three';
import type { Model } from '../state/model';
import type { Look } from './overlay/looks';

/** Degrees, of the height of all views. */
export const kFieldOfView = 28;
/** From where a model is seen at first. */
export const kHome = new Spherical(1, MathUtils.degToRad(80), MathUtils.degToRad(14));

const kMargin = 1.03;
const kSlim = 1.3; // of half the height by the radius: a figure needs less room to be turned than a compact model
const kMaxPoints = 50_000; // more are sampled evenly

/** Other models beside the one on the stage. The viewer moves all of them together. */
export interface Crowd {
  readonly object: Object3D;
  /** Places them for a camera, in a row across its view. @param free The aspect of the free part of the view. */
  face(camera: PerspectiveCamera): void;
  show(look: Look): void;
  /** Points around all, the model on the stage included, as seen from `theta`; the middle of all is the origin. */
  extent(theta: number, aspect: number): Float32Array;
  /** Where the middle of all is, from the middle of the model on the stage. */
  middle(theta: number): Vector3;
  /** Half the width of the floor, if all stand on one. */
  readonly floor: number | undefined;
}

/** The part of the view that no controls cover, in pixels. */
export interface FreePart {
  width: number;
  height: number;
  /** What is covered at the upper and at the lower edge, and at either side. */
  top: number;
  bottom: number;
  side: number;
  /** Its radius, in radii of a compact model. */
  fill: number;
}

/** Where something is on the page, in pixels. */
type Place = Pick<DOMRect, 'left' | 'right' | 'top' | 'bottom'>;

const kGap = 4; // pixels between a model and controls
const kMost = 0.45; // of the height that either edge may be covered

/** How much of a view's upper and lower edge strips of controls cover; columns of them stand beside the model. */
export function coveredBy(view: Place, controls: readonly Place[]): Pick<FreePart, 'top' | 'bottom'> {
  const height = view.bottom - view.top;
  const covered = { top: 0, bottom: 0 };
  for (const { left, right, top, bottom } of controls) {
    if (right - left < bottom - top || bottom === top) continue;
    const edge = top + bottom < view.top + view.bottom ? 'top' : 'bottom';
    const reach = edge === 'top' ? bottom - view.top : view.bottom - top;
    covered[edge] = Math.max(covered[edge], Math.min(reach + kGap, kMost * height));
  }
  return covered;
}

/**
 * Measures what controls cover, and tells it to the stylesheet, which knows it before any script runs only for the usual size of texts.
 * @param controls Strips and columns of controls on the view.
 * @param bar Stands on those at the lower edge.
 */
export function freePartOf(canvas: HTMLElement, controls: readonly HTMLElement[], bar: HTMLElement): FreePart {
  const seen = controls.filter((one) => one.checkVisibility());
  const { top, bottom } = coveredBy(
    canvas.getBoundingClientRect(),
    seen.map((one) => one.getBoundingClientRect()),
  );
  const above = bar.offsetHeight;
  for (const [name, value] of Object.entries({ top, bottom, above }))
    canvas.parentElement!.style.setProperty(`--stage-${name}`, `${value}px`);
  const style = getComputedStyle(canvas);
  const value = (name: string, missing: number): number => parseFloat(style.getPropertyValue(name)) || missing;
  return {
    width: canvas.clientWidth,
    height: canvas.clientHeight,
    top,
    bottom: bottom + above,
    side: value('--stage-side', 0),
    fill: value('--stage-fill', 1),
  };
}

/** Where a model looks: radians around it, 0 along +z. Figures of VRM 0 look along -z; others as the sides of their bones say. */
export function frontOf({ loaded }: Pick<Model, 'loaded'>): number {
  const known = fronts.get(loaded);
  if (known !== undefined) return known;
  const front = loaded.parser?.json?.extensions?.VRM ? Math.PI : frontByBones(loaded.scene);
  fronts.set(loaded, front);
  return front;
}

/** Makes another side the front of a model. @param front As `frontOf`. */
export function setFrontOf({ loaded }: Pick<Model, 'loaded'>, front: number): void {
  fronts.set(loaded, front);
}

const fronts = new WeakMap<object, number>();

/** Figures are turned by less than this, in radians, by how they stand. */
const kStraight = Math.PI / 4;

/** The front by all bones of which there is one on the left and one on the right; 0 if there are none, or it is about that. */
function frontByBones(scene: Object3D): number {
  const bones = new Map<string, Vector3>();
  scene.updateMatrixWorld();
  scene.traverse((object) => {
    const name: unknown = object.userData['name'] ?? object.name; // GLTFLoader takes signs out of names
    if ((object as Bone).isBone)
      bones.set(String(name).toLowerCase(), new Vector3().setFromMatrixPosition(object.matrixWorld));
  });
  const left = new Vector3();
  for (const [name, place] of bones) {
    const other = bones.get(mirrored(name));
    if (other) left.add(place).sub(other);
  }
  const front = Math.atan2(-left.z, left.x);
  return Math.hypot(left.x, left.z) > 0 && Math.abs(front) > kStraight ? front : 0;
}

/** The name of what is on the right, if one is on the left: "arm_r" of "arm_l". */
const mirrored = (name: string): string =>
  name
    .replace('left', 'right')
    .replace('左', '右')
    .replace(/(^|[\s_.-])l(?=[\s_.-]|$)/, '$1r');

/** The width of what a model may fill. */
const widthOf = ({ width, side }: FreePart): number => Math.max(width / 2, width - 2 * side);

const heightOf = ({ height, top, bottom }: FreePart): number => Math.max(1, height - top - bottom);

/** Width by height of what models may fill. */
export const aspectOf = (free: FreePart): number => widthOf(free) / heightOf(free);

/**
 * The distance at which a whole model is in the free part of the view.
 * @param points 3 each, around the origin; without any, those of a ball of radius 1 are supposed.
 * @param angle  Where the camera is; its radius is ignored.
 * @param exact  Whether the model fills the part. Otherwise a compact model gets more room, so that it can be turned.
 */
export function fittingDistance(part: FreePart, points: ArrayLike<number>, angle: Spherical, exact: boolean): number {
  const { width, height, fill } = part;
  const half = Math.tan(MathUtils.degToRad(kFieldOfView / 2));
  const free = heightOf(part);
  // In a tall view the width limits the model.
  const loose = fill / Math.sin(Math.atan((half * Math.min(free, width)) / Math.max(1, height)));
  const across = (half * widthOf(part)) / Math.max(1, height);
  const along = (half * free) / Math.max(1, height);
  const toCamera = new Vector3().setFromSphericalCoords(1, angle.phi, angle.theta);
  const right = new Vector3(Math.cos(angle.theta), 0, -Math.sin(angle.theta));
  const up = toCamera.clone().cross(right);
  const point = new Vector3();
  const step = 3 * Math.ceil(points.length / 3 / kMaxPoints);
  let [needed, turning, tall, wide] = [0, 0, 0, 0];
  for (let i = 0; i < points.length; i += step) {
    point.fromArray(points, i);
    const size = Math.max(Math.abs(point.dot(right)) / across, Math.abs(point.dot(up)) / along);
    needed = Math.max(needed, size + point.dot(toCamera));
    // From any side.
    const radius = Math.hypot(point.x, point.z);
    turning = Math.max(turning, radius / across + radius, Math.abs(point.y) / along + radius);
    [tall, wide] = [Math.max(tall, Math.abs(point.y)), Math.max(wide, radius)];
  }
  if (exact && needed > 0) return kMargin * needed;
  return Math.max(tall > kSlim * wide ? Math.min(loose, turning) : loose, kMargin * needed);
}
