// A decal of three.js, thrown at the model from the front: it paints what is in its box, in front of all else or behind it.
import { Box3, Euler, Mesh, Vector3 } from 'three';
import { DecalGeometry } from 'three/addons/geometries/DecalGeometry.js';
import { withNormals } from '../../quality/shape.js';
import type { MethodModule } from '../run-method.js';

export const zones: MethodModule['zones'] = ({ cage, target }) => {
  const box = new Box3().setFromArray(cage.positions);
  const [middle, size] = [box.getCenter(new Vector3()), box.getSize(new Vector3())];
  const decal = new DecalGeometry(new Mesh(withNormals(target)), middle, new Euler(), size);
  const at = decal.getAttribute('position').array;
  const painted = new Set<string>();
  const key = (points: ArrayLike<number>, v: number) => [0, 1, 2].map((k) => Math.fround(points[3 * v + k]!)).join();
  for (let v = 0; v < at.length / 3; ++v) painted.add(key(at, v));
  return Uint8Array.from({ length: target.positions.length / 3 }, (_, v) =>
    painted.has(key(target.positions, v)) ? 0 : 1,
  );
};
