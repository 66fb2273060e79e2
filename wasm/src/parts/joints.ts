import { cross, dot } from '../inspect/geometry.js';
import { movePoints } from './points.js';

/** A joint, as it is read from a model. */
export interface ReadJoint<Node> {
  node: Node;
  name: string;
  position: [x: number, y: number, z: number];
}

/**
 * Where a joint is in the space of a skinned mesh that was extracted, in its bind pose.
 * @param matrix   From the mesh as it is stored to the space of the arrays, column by column.
 * @param inverse  The joint's inverse bind matrix: from the mesh as it is stored to the joint's space.
 * @returns `undefined` if `inverse` has no inverse.
 */
export function jointPlace(
  matrix: ArrayLike<number>,
  inverse: ArrayLike<number>,
): ReadJoint<unknown>['position'] | undefined {
  const column = (at: number) => [inverse[at]!, inverse[at + 1]!, inverse[at + 2]!] as const;
  const [a, b, c, t] = [column(0), column(4), column(8), column(12)];
  const volume = dot(a, cross(b, c));
  // By Cramer's rule: the point that `inverse` takes to the joint's origin.
  const [x, y, z] = [dot(t, cross(b, c)), dot(a, cross(t, c)), dot(a, cross(b, t))].map((value) => -value / volume) as [
    number,
    number,
    number,
  ];
  if (!Number.isFinite(x + y + z)) return undefined;
  return movePoints(matrix, [x, y, z], [0, 0, 0]);
}

/**
 * Numbers joints and finds their parents: the nearest joint above each.
 * @param joints  The first of those with the same node counts.
 */
export function listJoints<Node>(
  joints: Iterable<ReadJoint<Node>>,
  parentOf: (node: Node) => Node | null | undefined,
): { name: string; position: [number, number, number]; parent: number }[] {
  const first = new Map<Node, ReadJoint<Node>>();
  for (const joint of joints) if (!first.has(joint.node)) first.set(joint.node, joint);
  const numbers = new Map([...first.keys()].map((node, j) => [node, j]));
  return [...first.values()].map(({ node, name, position }) => {
    let above = parentOf(node) ?? undefined;
    while (above !== undefined && !numbers.has(above)) above = parentOf(above) ?? undefined;
    return { name, position, parent: above === undefined ? -1 : numbers.get(above)! };
  });
}

/** What a glTF's `extensions` say about a human skeleton: VRM 1.0 and VRM 0.x. */
export interface VrmExtensions {
  VRMC_vrm?: unknown;
  VRM?: unknown;
}

/** The number of the node of each bone of a VRM, by the name of the bone; empty if it is none, or is damaged. */
export function vrmBones(extensions: VrmExtensions | undefined): Map<number, string> {
  const bones = new Map<number, string>();
  const add = (name: unknown, node: unknown) => {
    if (typeof name === 'string' && Number.isInteger(node)) bones.set(node as number, name);
  };
  const humanBonesOf = (extension: unknown): unknown =>
    (extension as { humanoid?: { humanBones?: unknown } } | undefined)?.humanoid?.humanBones;
  const [now, before] = [humanBonesOf(extensions?.VRMC_vrm), humanBonesOf(extensions?.VRM)];
  if (Array.isArray(before)) for (const bone of before) add(bone?.bone, bone?.node);
  else if (typeof now === 'object' && now !== null)
    for (const [name, bone] of Object.entries(now)) add(name, (bone as { node?: unknown } | null)?.node);
  return bones;
}
