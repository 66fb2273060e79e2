import { BufferAttribute, BufferGeometry, DoubleSide, Ray, Triangle, Vector3 } from 'three';
import { CENTER, type HitPointInfo, MeshBVH } from 'three-mesh-bvh';
import type { Scene, SceneMesh } from '../scene-file.js';

// The form in which the library's own functions are fastest at this, found by trying on the sample (ms in Node):
// - CENTER for both trees: SAH saves 0.5 of the queries and costs 0.7 (cage) and 5 (target) to build; leaves of 6 (cage) and 4
//   (target; anything from 2 to 10 is within the noise);
// - the search for the nearest point begins within the distance of the previous point's triangle;
// - rays by `raycastFirst`: `shapecast`, though it could stop at any hit, makes 24.3 of 18.4.
// A search by `shapecast` and arithmetic of one's own in place of `closestPointToPoint` takes 15 % off the total.
const kCageLeaf = 6;
const kTargetLeaf = 4;

const kCosmetic = 0;
const kOccluded = 1;
const kUncovered = 2;

/** What the peer starts from: vertices of equal position and group are one point. Made for it, and not timed. */
export interface Points {
  /** In the order of a curve through space. */
  positions: Vector3[];
  /** The point of each vertex. */
  ofVertex: Uint32Array;
  /** Of the box around them. */
  diagonal: number;
}

/** Merges vertices, and sorts the points by their cells in a grid. */
export function weld({ positions, groups }: SceneMesh): Points {
  const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(positions, 3));
  geometry.computeBoundingBox();
  const { min, max } = geometry.boundingBox!;
  const scale = 1023 / Math.max(...max.clone().sub(min));
  const cellOf = (p: Vector3): number =>
    p
      .clone()
      .sub(min)
      .multiplyScalar(scale)
      .toArray()
      .reduce((key, x, k) => key | (spread(x) << k), 0);
  const vertices = Array.from({ length: positions.length / 3 }, (_, v) => {
    const position = new Vector3().fromArray(positions, 3 * v);
    return { v, position, group: groups?.[v] ?? 0, cell: cellOf(position) };
  });
  vertices.sort(
    (a, b) =>
      a.cell - b.cell ||
      a.position.x - b.position.x ||
      a.position.y - b.position.y ||
      a.position.z - b.position.z ||
      a.group - b.group,
  );
  const points: Points = { positions: [], ofVertex: new Uint32Array(vertices.length), diagonal: min.distanceTo(max) };
  vertices.forEach(({ v, position, group }, i) => {
    const before = vertices[i - 1];
    if (!before?.position.equals(position) || before.group !== group) points.positions.push(position);
    points.ofVertex[v] = points.positions.length - 1;
  });
  return points;
}

/** Spreads the lowest 10 bits three apart. */
function spread(value: number): number {
  let bits = value | 0;
  bits = (bits | (bits << 16)) & 0x030000ff;
  bits = (bits | (bits << 8)) & 0x0300f00f;
  bits = (bits | (bits << 4)) & 0x030c30c3;
  return (bits | (bits << 2)) & 0x09249249;
}

function buildTree({ positions, indices }: SceneMesh, targetLeafSize: number): MeshBVH {
  const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(indices, 1));
  // Without `indirect` the tree would sort the caller's indices in place.
  return new MeshBVH(geometry, { strategy: CENTER, targetLeafSize, indirect: true, setBoundingBox: false });
}

/**
 * Steps 1 to 3 on three-mesh-bvh. What the package does besides is left out: it merges vertices, breaks ties, and makes UVs and
 * segments. So a ratio flatters the peer a little.
 * @return The zone of each point.
 */
export function searchByBvh({ cage, target }: Scene, points: Points): Uint8Array {
  const cageTree = buildTree(cage, kCageLeaf);
  const targetTree = buildTree(target, kTargetLeaf);
  const triangles = Array.from({ length: cage.indices.length / 3 }, (_, t) => {
    const [a, b, c] = [0, 1, 2].map((k) => new Vector3().fromArray(cage.positions, 3 * cage.indices[3 * t + k]!));
    const triangle = new Triangle(a, b, c);
    return { triangle, normal: triangle.getNormal(new Vector3()) };
  });
  const start = 1e-5 * points.diagonal;
  const [ray, nearest, weights] = [new Ray(), new Vector3(), new Vector3()];
  const hit: HitPointInfo = { point: new Vector3(), distance: 0, faceIndex: 0 };
  let t = 0;
  return Uint8Array.from(points.positions, (p) => {
    const limit = triangles[t]!.triangle.closestPointToPoint(p, nearest).distanceTo(p);
    if (cageTree.closestPointToPoint(p, hit, 0, limit)) {
      t = hit.faceIndex;
      nearest.copy(hit.point);
    }
    const { triangle, normal } = triangles[t]!;
    ray.origin.copy(p);
    ray.direction.copy(normal);
    if (targetTree.raycastFirst(ray, DoubleSide, start, Infinity)) return kOccluded;
    // A ray from below the inside of the nearest triangle hits that.
    triangle.getBarycoord(nearest, weights);
    if (Math.min(weights.x, weights.y, weights.z) > 1e-6 && p.clone().sub(nearest).dot(normal) < start)
      return kCosmetic;
    ray.origin.addScaledVector(normal, -start);
    return cageTree.raycastFirst(ray, DoubleSide, 0, Infinity) ? kCosmetic : kUncovered;
  });
}
