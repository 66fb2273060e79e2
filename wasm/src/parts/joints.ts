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

/** A skeleton, as `CageModel` has it. */
export interface Skeleton {
  joints: { name: string; position: [number, number, number]; parent: number }[];
  vertexJoints: Uint16Array;
}

/** A part, and what holds it. */
export interface HeldPart<Node> {
  node: Node;
  vertexCount: number;
  /** Its joints, and 4 per vertex: numbers of joints, and their weights. */
  skin: { joints: readonly Node[]; held: ArrayLike<number>; weights: ArrayLike<number> } | undefined;
}

/** No joint: `kNoJoint` in C++. */
const kNoJoint = 0xffff;

/**
 * Numbers joints, and finds their parents, the nearest joint above each, and the joint that holds each vertex most: by its weights, or
 * of parts without a skin the nearest above.
 * @param joints  The first of those with the same node counts.
 * @param parts   In the order of their vertices.
 */
export function readSkeleton<Node>(
  joints: Iterable<ReadJoint<Node>>,
  parts: readonly HeldPart<Node>[],
  parentOf: (node: Node) => Node | null | undefined,
): Skeleton {
  const first = new Map<Node, ReadJoint<Node>>();
  for (const joint of joints) if (!first.has(joint.node)) first.set(joint.node, joint);
  const numbers = new Map([...first.keys()].map((node, j) => [node, j]));
  const nearest = (nodes: Iterable<Node>) => [...nodes].map((node) => numbers.get(node)).find((j) => j !== undefined);
  const vertexJoints = new Uint16Array(parts.reduce((sum, { vertexCount }) => sum + vertexCount, 0)).fill(kNoJoint);
  let start = 0;
  for (const { node, vertexCount, skin } of parts) {
    if (!skin) vertexJoints.fill(nearest(upFrom(node, parentOf)) ?? kNoJoint, start, start + vertexCount);
    else {
      const numberOf = skin.joints.map((joint) => numbers.get(joint) ?? kNoJoint);
      for (let v = 0; v < vertexCount; ++v) {
        let most = 4 * v;
        for (let k = 4 * v; k < 4 * v + 4; ++k) if (skin.weights[k]! > skin.weights[most]!) most = k;
        vertexJoints[start + v] = numberOf[skin.held[most]!] ?? kNoJoint;
      }
    }
    start += vertexCount;
  }
  return {
    joints: [...first.values()].map(({ node, name, position }) => {
      const [, ...above] = upFrom(node, parentOf);
      return { name, position, parent: nearest(above) ?? -1 };
    }),
    vertexJoints,
  };
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
