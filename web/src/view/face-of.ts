import { type Bone, Box3, Vector3 } from 'three';
import { landmarksOf, type Model } from '../state/model';

/** The landmarks of a head's outline. */
const kOutline = /^(crown|forehead|occiput|chin|menton|ear_outer_(left|right))$/;

/** Names of its bone: "Head", "mixamorigHead", "Bip01_head"; not the ends of chains. */
const kHead = /(^|[^A-Za-z])[Hh]ead$|[a-z]Head$|^HEAD$/;

/**
 * Corners of a box around the head of a figure, in the space of its scene: by the landmarks of its cage, else by the bone of its head.
 * @returns Undefined if neither tells.
 */
export function faceOf(
  { scene, mesh }: Pick<Model, 'scene' | 'mesh'>,
  cage: Pick<Model, 'scene'> | undefined,
): Vector3[] | undefined {
  const landmarks = Object.entries(cage ? landmarksOf(cage) : {});
  const outline = landmarks.flatMap(([name, at]) => (kOutline.test(name) ? new Vector3(...at) : []));
  const box = outline.length > 3 ? new Box3().setFromPoints(outline) : aboveBone(scene, mesh.rest ?? mesh.positions);
  return box && [box.min, box.max];
}

/** What is above the bone of a head, and no further beside it than above it: hands may be raised. */
function aboveBone(scene: Model['scene'], positions: ArrayLike<number>): Box3 | undefined {
  let head: Vector3 | undefined;
  scene.updateMatrixWorld();
  scene.traverse((object) => {
    const name = String(object.userData['name'] ?? object.name); // GLTFLoader takes signs out of names
    if ((object as Bone).isBone && kHead.test(name)) head ??= new Vector3().setFromMatrixPosition(object.matrixWorld);
  });
  if (!head) return undefined;
  const box = new Box3();
  const point = new Vector3();
  let top = head.y;
  for (let i = 1; i < positions.length; i += 3) top = Math.max(top, positions[i]!);
  for (let i = 0; i < positions.length; i += 3) {
    point.fromArray(positions, i);
    if (point.y >= head.y && Math.hypot(point.x - head.x, point.z - head.z) <= top - head.y) box.expandByPoint(point);
  }
  return box.isEmpty() ? undefined : box;
}
