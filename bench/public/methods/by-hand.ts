// What a programmer writes with three-mesh-bvh: a vertex is painted if the cage is near and faces the same way, and a ray outwards
// meets nothing of the target.
import { Box3, Vector3 } from 'three';
import { Search, triangleAt, vertexAt, withNormals } from '../../quality/shape.js';
import type { MethodModule } from '../run-method.js';

/** How far the cage may be, as a share of its diagonal. */
const kReach = 0.05;
/** The start of a ray, likewise: off the triangles around it. */
const kLift = 1e-4;

export const zones: MethodModule['zones'] = ({ cage, target }) => {
  const [around, own] = [new Search(cage), new Search(target)];
  const { normal } = withNormals(target).attributes;
  const diagonal = new Box3().setFromArray(cage.positions).getSize(new Vector3()).length();
  return Uint8Array.from({ length: target.positions.length / 3 }, (_, v) => {
    const point = vertexAt(target.positions, v);
    const { triangle, distance } = around.closest(point);
    const outward = triangleAt(cage, triangle).getNormal(new Vector3());
    if (distance > kReach * diagonal || outward.dot(vertexAt(normal!.array, v)) <= 0) return 1;
    return own.firstHit(point.addScaledVector(outward, kLift * diagonal), outward) === -1 ? 0 : 1;
  });
};
