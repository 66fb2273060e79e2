import { column, type Vector, volume } from './affine.js';
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
 * @returns `undefined` if `inverse` has no inverse, or less than 16 numbers.
 */
export function jointPlace(
  matrix: ArrayLike<number>,
  inverse: ArrayLike<number>,
): ReadJoint<unknown>['position'] | undefined {
  const [a, b, c, t] = [0, 1, 2, 3].map((at) => column(inverse, at)) as [Vector, Vector, Vector, Vector];
  // By Cramer's rule: the point that `inverse` takes to the joint's origin.
  const point = [volume(t, b, c), volume(a, t, c), volume(a, b, t)].map((value) => -value / volume(a, b, c));
  return point.every(Number.isFinite) ? movePoints(matrix, point, [0, 0, 0]) : undefined;
}

/** A node, and those above it, up to the top. In a damaged file a node may be below itself: it comes once. */
export function* upFrom<Node>(node: Node, parentOf: (node: Node) => Node | null | undefined): Generator<Node> {
  const passed = new Set<Node>();
  for (let at: Node | null | undefined = node; at != null && !passed.has(at); at = parentOf(at)) {
    passed.add(at);
    yield at;
  }
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
    const [, ...above] = upFrom(node, parentOf);
    const parent = above.find((one) => numbers.has(one));
    return { name, position, parent: parent === undefined ? -1 : numbers.get(parent)! };
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
