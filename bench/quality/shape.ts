import { BufferAttribute, BufferGeometry, DoubleSide, Ray, Triangle, Vector3 } from 'three';
import { MeshBVH } from 'three-mesh-bvh';
import { firstInPlace } from '../../wasm/src/inspect/geometry.js';

/** Positions, 3 per vertex, and triangles, 3 vertices each. */
export interface Shape {
  positions: Float32Array;
  indices: ArrayLike<number>;
}

/** A point of a surface: a triangle and the weights of its corners. */
export interface SurfacePoint {
  triangle: number;
  weights: [number, number, number];
  position: Vector3;
  distance: number;
}

export const vertexAt = (positions: ArrayLike<number>, v: number): Vector3 =>
  new Vector3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);

/** Where a point of one shape is on another with the same triangles. */
export function pointOn({ positions, indices }: Shape, triangle: number, weights: readonly number[]): Vector3 {
  const at = new Vector3();
  for (let k = 0; k < 3; ++k) at.addScaledVector(vertexAt(positions, indices[3 * triangle + k]!), weights[k]!);
  return at;
}

export const triangleAt = ({ positions, indices }: Shape, t: number): Triangle => {
  const [a, b, c] = [0, 1, 2].map((k) => vertexAt(positions, indices[3 * t + k]!));
  return new Triangle(a, b, c);
};

/** For three.js; normals of vertices from their triangles, as it computes them. */
export function withNormals({ positions, indices }: Shape): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(Float32Array.from(positions), 3));
  geometry.setIndex(new BufferAttribute(Uint32Array.from(indices), 1));
  geometry.computeVertexNormals();
  return geometry;
}

/** Searches for closest points and rays. */
export class Search {
  private readonly tree: MeshBVH;
  constructor(readonly shape: Shape) {
    this.tree = new MeshBVH(withNormals(shape), { indirect: true });
  }

  closest(point: Vector3): SurfacePoint {
    const { faceIndex, distance } = this.tree.closestPointToPoint(point)!;
    const triangle = triangleAt(this.shape, faceIndex);
    const position = triangle.closestPointToPoint(point, new Vector3());
    const weights = triangle.getBarycoord(position, new Vector3()) ?? new Vector3(1, 0, 0);
    return { triangle: faceIndex, weights: [weights.x, weights.y, weights.z], position, distance };
  }

  /** The triangle that a ray first meets; −1 if it meets none. */
  firstHit(origin: Vector3, direction: Vector3): number {
    return this.tree.raycastFirst(new Ray(origin, direction), DoubleSide)?.faceIndex ?? -1;
  }
}

/** The triangles at each edge between places; an edge is `low * count + high`. */
export function edgesOf(
  { positions, indices }: Shape,
  at: ArrayLike<number> = firstInPlace(positions),
): Map<number, number[]> {
  const edges = new Map<number, number[]>();
  for (let c = 0; c < indices.length; ++c) {
    const t = Math.floor(c / 3);
    const [v, w] = [at[indices[c]!]!, at[indices[3 * t + ((c + 1) % 3)]!]!];
    const key = Math.min(v, w) * at.length + Math.max(v, w);
    if (!edges.has(key)) edges.set(key, []);
    edges.get(key)!.push(t);
  }
  return edges;
}

/** The open borders, each a walk of vertices. */
export function bordersOf({ positions, indices }: Shape): number[][] {
  const at = firstInPlace(positions);
  const edges = edgesOf({ positions, indices }, at);
  const next = new Map<number, number>();
  for (let c = 0; c < indices.length; ++c) {
    const t = Math.floor(c / 3);
    const [v, w] = [at[indices[c]!]!, at[indices[3 * t + ((c + 1) % 3)]!]!];
    if (edges.get(Math.min(v, w) * at.length + Math.max(v, w))!.length === 1) next.set(v, w);
  }
  const loops: number[][] = [];
  const seen = new Set<number>();
  for (const start of next.keys()) {
    const loop: number[] = [];
    for (let v: number | undefined = start; v !== undefined && !seen.has(v); v = next.get(v)) {
      seen.add(v);
      loop.push(v);
    }
    if (loop.length > 2) loops.push(loop);
  }
  return loops;
}
