import { pointAt, type Vector } from '../../inspect/geometry.js';
import { skeletonOf } from '../../scene/cage-model.js';
import type { Drawn, Part } from '../../scene/extract.js';
import type { GltfFile } from '../open-gltf.js';
import type { Framing } from './picture.js';
import type { Surface } from './surfaces.js';
import type { View } from './views.js';

/** How much wider a picture is than what is framed. */
const kMargin = 1.06;
/** Joints of heads: "Head", "mixamorig:Head", "J_Bip_C_Head"; not "HeadTop_End". */
const kHead = /(^|[^a-z])head(?![a-z])/i;
/** How far joints in one place are apart at most, along each axis: a millimetre. */
const kSamePlace = 1e-3;

/** Where a picture is centred and how wide it is, so that points fit in. @param points  3 numbers each. */
export function framed(points: ArrayLike<number>, view: View): Pick<Framing, 'middle' | 'radius'> {
  const axes = [view.right, view.up, view.eye];
  const [low, high] = [axes.map(() => Infinity), axes.map(() => -Infinity)];
  for (const [k, [x, y, z]] of axes.entries())
    for (let i = 0; i < points.length; i += 3) {
      const along = x * points[i]! + y * points[i + 1]! + z * points[i + 2]!;
      if (along < low[k]!) low[k] = along;
      if (along > high[k]!) high[k] = along;
    }
  const at = axes.map((_, k) => (low[k]! + high[k]!) / 2);
  const middle = [0, 1, 2].map((k) => axes.reduce((sum, axis, n) => sum + axis[k]! * at[n]!, 0));
  return {
    middle: middle as unknown as Vector,
    radius: (kMargin / 2) * Math.max(high[0]! - low[0]!, high[1]! - low[1]!),
  };
}

/** The corners of the triangles of surfaces. */
export function pointsOf(surfaces: readonly Surface[]): Float32Array {
  const points = new Float32Array(3 * surfaces.reduce((sum, { indices }) => sum + indices.length, 0));
  let at = 0;
  for (const { positions, indices } of surfaces)
    for (const v of indices) {
      points.set(pointAt(positions, v), at);
      at += 3;
    }
  return points;
}

/**
 * The points of a head: what its joint holds more than any other joint does, or others of the same name in its place, as in files with a
 * skeleton for each mesh. Undefined if no joint is called so, or holds nothing.
 */
export function headPoints(file: GltfFile, drawn: Drawn, surfaces: readonly Surface[]): Float32Array | undefined {
  const { joints, vertexJoints } = skeletonOf(file, drawn);
  const head = joints.find(({ name }) => kHead.test(name));
  if (!head) return undefined;
  const isHead = joints.map(
    ({ name, position }) =>
      name === head.name && position.every((x, k) => Math.abs(x - head.position[k]!) <= kSamePlace),
  );
  const points: number[] = [];
  drawn.parts.forEach(({ firstVertex, vertexCount }: Part, p) => {
    for (let v = 0; v < vertexCount; ++v)
      if (isHead[vertexJoints[firstVertex + v]!]) points.push(...pointAt(surfaces[p]!.positions, v));
  });
  return points.length > 0 ? Float32Array.from(points) : undefined;
}
