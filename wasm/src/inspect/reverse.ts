import { project } from '../api/index.js';
import { joined, nearestPoint, pointAt, type Vector } from './geometry.js';
import type { Scene } from './scene.js';

/** For points of the cage, the nearest points of the target. */
export interface Reverse {
  /** 1 per point: the nearest triangle of the target. */
  triangles: Uint32Array;
  /** 1 per point, in units of the input. */
  distances: Float32Array;
  /** The nearest point of the target. */
  nearest(point: number): Vector;
  /** The nearest triangle's corners. */
  corners(point: number): [Vector, Vector, Vector];
}

/**
 * Projects points near the cage onto the target: target and cage change roles.
 * @param points  3 per point, the cage's vertices first.
 * @returns nothing if the target has no triangle with an area.
 */
export function reverse(
  { target, targetBox, cage, areas }: Pick<Scene, 'target' | 'targetBox' | 'cage' | 'areas'>,
  points: Float32Array,
): Reverse | undefined {
  if (!areas.some((area) => area > 0)) return undefined;
  // The core requires UVs on the mesh that it projects onto; they are not used here.
  const uvs = new Float32Array((target.positions.length / 3) * 2);
  // The corners of the target's box are added so that a cage that is tiny beside the target does not exceed the core's limit of size.
  const positions = joined(points, Float32Array.of(...targetBox.min, ...targetBox.max));
  const { triangles, distances } = project(
    { positions: target.positions, indices: target.indices, uvs },
    { positions, indices: cage.indices },
  );
  const corners = (point: number) =>
    [0, 1, 2].map((k) => pointAt(target.positions, target.indices[3 * triangles[point]! + k]!)) as [
      Vector,
      Vector,
      Vector,
    ];
  return {
    triangles,
    distances,
    corners,
    nearest: (point) => nearestPoint(pointAt(points, point), ...corners(point)).point,
  };
}
