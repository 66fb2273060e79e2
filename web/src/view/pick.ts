import { type Camera, type Intersection, Raycaster, Triangle, type Vector2, Vector3 } from 'three';
import type { ExtractedMesh, Part } from '../scene/extract';

/** A spot on the surface of a target. */
export interface Spot {
  /** The number of its triangle. */
  triangle: number;
  /** What share each corner has in it, in the order of the target's indices. */
  weights: [number, number, number];
  /** Where it is in the model as it was transferred, in its space. */
  point: Vector3;
  /** Where it is seen, in the studio: elsewhere than `point` says if the model is posed. */
  seen: Vector3;
}

/**
 * Finds what of a target is seen at a place of the picture, skins and morphs as they are posed.
 * @param at From −1 to 1 from the left to the right, and from the lower edge to the upper.
 * Cost: every triangle is looked at, some 16 ms for half a million.
 */
export function pick(target: ExtractedMesh, camera: Camera, at: Vector2): Spot | undefined {
  const raycaster = new Raycaster();
  raycaster.setFromCamera(at, camera);
  let nearest: { part: Part; hit: Intersection } | undefined;
  for (const part of target.parts) {
    const [hit] = raycaster.intersectObject(part.mesh, false);
    if (hit && (!nearest || hit.distance < nearest.hit.distance)) nearest = { part, hit };
  }
  return nearest && spotOf(target, nearest.part, nearest.hit);
}

function spotOf(
  { positions, indices }: ExtractedMesh,
  { mesh, firstVertex, firstTriangle }: Part,
  { faceIndex, point: seen }: Intersection,
): Spot {
  const triangle = firstTriangle + faceIndex!;
  const corners = [0, 1, 2].map((corner) => indices[3 * triangle + corner]!) as [number, number, number];
  // The corners as they are posed; in the order of the target's indices, which are turned where the part is mirrored.
  const posed = corners.map((vertex) =>
    mesh.localToWorld(mesh.getVertexPosition(vertex - firstVertex, new Vector3())),
  ) as [Vector3, Vector3, Vector3];
  const weights = Triangle.getBarycoord(seen, ...posed, new Vector3()) ?? new Vector3(1, 0, 0);
  const stored = corners.map((vertex) => new Vector3().fromArray(positions, 3 * vertex)) as [Vector3, Vector3, Vector3];
  const point = new Vector3();
  stored.forEach((corner, i) => point.addScaledVector(corner, weights.getComponent(i)));
  return { triangle, weights: weights.toArray(), point, seen };
}
