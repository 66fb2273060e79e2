// Everything is painted, with the UV of the nearest point of the cage. By three-mesh-bvh.
import { Search, vertexAt } from '../../quality/shape.js';
import type { MethodModule } from '../run-method.js';

export const zones: MethodModule['zones'] = ({ cage, target }) => {
  const search = new Search(cage);
  const vertices = target.positions.length / 3;
  const uvs = new Float32Array(2 * vertices);
  for (let v = 0; v < vertices; ++v) {
    const { triangle, weights } = search.closest(vertexAt(target.positions, v));
    weights.forEach((weight, k) => {
      const corner = cage.indices[3 * triangle + k]!;
      uvs[2 * v]! += weight * cage.uvs![2 * corner]!;
      uvs[2 * v + 1]! += weight * cage.uvs![2 * corner + 1]!;
    });
  }
  return new Uint8Array(vertices);
};
