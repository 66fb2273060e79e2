import { Box3, type Object3D, Vector3 } from 'three';

/** A model that is so many times its size away from the origin is moved near it: floats would be too coarse there. */
const kFar = 64;

/** Where models lay that were read before, and what was subtracted from their places. */
const kPlaces: { middle: Vector3; size: number; origin: Vector3 }[] = [];

/** Moves a scene that lies far from the origin near it, and what lies around an earlier one by the same. */
export function bringNear(scene: Object3D): void {
  const box = new Box3().setFromObject(scene);
  const [middle, extent] = [box.getCenter(new Vector3()), box.getSize(new Vector3())];
  const size = Math.max(...extent.toArray());
  const known = kPlaces.findLast((place) => place.middle.distanceTo(middle) <= 2 * Math.max(place.size, size));
  const origin = known?.origin ?? (middle.length() > kFar * size ? middle.clone() : new Vector3());
  kPlaces.push({ middle, size, origin });
  scene.position.sub(origin);
}
