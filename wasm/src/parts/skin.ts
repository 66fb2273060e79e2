import { determinant, identity, inverted, isIdentity, type Matrix, multiply } from './affine.js';
import { upFrom } from './joints.js';

/** Joints place a mesh equally if they differ by at most this share of its size. */
const kSame = 1e-3;
/** The cosine of the angle from which on a rig is turned against all that is above it. */
const kTurned = Math.SQRT1_2;
/** The cosine of the angle by which a rig's axes may be off those of the scene. */
const kAligned = /* @__PURE__ */ Math.cos((5 * Math.PI) / 180);

/** A mesh of a model. Matrices are column by column. */
export interface ModelMesh<Node> {
  node: Node;
  /** To the scene, without a skin. */
  matrix: Matrix;
  skin: Skin<Node> | undefined;
}

/** How joints hold a mesh. */
export interface Skin<Node> {
  joints: readonly Node[];
  /** The inverse bind matrix of a joint; `undefined` for the identity. */
  inverseOf(joint: number): ArrayLike<number> | undefined;
  /** What is applied to the mesh before these. */
  bind: Matrix;
  /** 4 per vertex: joints and their weights. */
  held: ArrayLike<number>;
  weights: ArrayLike<number>;
  /** 3 per vertex, as they are stored. */
  positions: Float32Array;
  /** Whether they are floats in the file; else they are quantised. */
  isFloat: boolean;
}

/** The nodes of a model. */
export interface Nodes<Node> {
  parentOf(node: Node): Node | null | undefined;
  /** The matrix to the scene. */
  worldOf(node: Node): Matrix;
}

/**
 * Returns the matrices by which the meshes of a model are in the scene with skeletons at rest. Files that are quantised, or whose rig
 * has another unit or axis than the scene, store this only in the inverse bind matrices. `placeMeshes` in C++ has the same rules.
 *
 * In the bind pose all joints of a mesh give the same matrix (joint in the scene · inverse bind matrix), which is taken. If those of
 * any mesh differ, the model has moved: joints of other meshes may be equal only because they have turned together, as those of an
 * eye. Then the topmost joint says where the mesh would be, which may have moved as well; so what comes nearest to it is taken: the
 * mesh as it is stored, or moved by its own node or one above the joints. The topmost joint itself decides if it is turned by a
 * quarter against all of these, and for meshes that are quantised or of another size. Meshes without a skin that hang on a joint go
 * with it.
 * @param meshes  All meshes of the model.
 */
export function placeMeshes<Node>(meshes: readonly ModelMesh<Node>[], nodes: Nodes<Node>): Matrix[] {
  const isJoint = new Set(meshes.flatMap(({ skin }) => skin?.joints ?? []));
  const holds = meshes.map(({ node, skin }) => skin && holdOf(node, skin, nodes, isJoint));
  if (holds.every((hold) => hold?.isBound ?? true)) return meshes.map(({ matrix }, m) => holds[m]?.atRest ?? matrix);
  const turned = holds.flatMap((hold) => (hold?.isTurned ? [hold.guide] : []));
  const places = holds.map((hold) => hold?.moved(turned));
  /** From where each joint has moved a mesh to where the mesh is at rest. */
  const back = new Map<Node, Matrix>();
  meshes.forEach(({ skin }, m) =>
    skin?.joints.forEach((joint, j) => {
      const [place, { matrices, root, isNear }] = [places[m]!, holds[m]!];
      // An exporter may not have known the matrix of a joint that holds nothing.
      const isKnown = skin.inverseOf(j) !== undefined && (j === root || !isIdentity(skin.inverseOf(j)!));
      const inverse = back.has(joint) || !isKnown ? undefined : inverted(matrices[j]!);
      if (inverse) back.set(joint, isNear(matrices[j]!, place) ? identity : multiply(place, inverse));
    }),
  );
  return meshes.map(({ node, matrix }, m) => {
    if (places[m]) return places[m];
    const joint = [...upFrom(node, nodes.parentOf)].find((above) => back.has(above));
    const change = joint === undefined ? identity : back.get(joint)!;
    return change === identity ? matrix : multiply(change, matrix);
  });
}

/** How joints hold a mesh, and where it is. */
interface Hold {
  /** 1 per joint: where it would place the mesh. */
  matrices: readonly Matrix[];
  /** The number of the topmost joint. */
  root: number;
  /** Whether all joints that hold it agree. */
  isBound: boolean;
  /** Where it is if they do in all meshes. */
  atRest: Matrix;
  /** What the topmost joint says. */
  guide: Matrix;
  /** Whether that is turned by a quarter against all that is above it. */
  isTurned: boolean;
  /** Where it is if the model has moved. @param turned  Further places where it may be. */
  moved(turned: readonly Matrix[]): Matrix;
  isNear(a: Matrix, b: Matrix): boolean;
}

function holdOf<Node>(node: Node, skin: Skin<Node>, nodes: Nodes<Node>, isJoint: ReadonlySet<Node>): Hold {
  const { joints, inverseOf, bind, held, weights, positions, isFloat } = skin;
  const placedBy = (one: Node) => multiply(nodes.worldOf(one), bind);
  const matrices = joints.map((joint, j) => {
    const inverse = inverseOf(j);
    return inverse ? multiply(nodes.worldOf(joint), multiply(inverse, bind)) : placedBy(joint);
  });
  const used = new Set<Matrix>();
  for (let i = 0; i < held.length; ++i) if (weights[i]! > 0) used.add(matrices[held[i]!]!);
  const holding = matrices.filter((matrix) => used.has(matrix) && sizeOf(matrix) > 0);
  const first = holding[0] ?? bind;
  const size = sizeOf(first);
  const reach = positions.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
  /** How far two matrices place a vertex from each other at most, along an axis. */
  const distance = (a: Matrix, b: Matrix): number =>
    Math.max(
      ...[0, 1, 2].map((row) => {
        const off = (column: number) => Math.abs(a[4 * column + row]! - b[4 * column + row]!);
        return (off(0) + off(1) + off(2)) * reach + off(3);
      }),
    );
  const tolerance = kSame * size;
  const isNear = (a: Matrix, b: Matrix) => distance(a, b) <= tolerance * reach;
  const isAsLarge = (matrix: Matrix) => Math.abs(sizeOf(matrix) - size) < tolerance;
  const upFromJoint = joints.length > 0 ? [...upFrom(joints[0]!, nodes.parentOf)] : [];
  const root = joints.indexOf(upFromJoint.filter((one) => joints.includes(one)).at(-1)!);
  // What is below a joint has moved with it.
  const fixed = (up: Node[]) => up.slice(up.reduce((end, one, i) => (isJoint.has(one) ? i + 1 : end), 0));
  // A mesh that was bound where it stood is placed by its node already.
  const own = isIdentity(bind) ? [...upFrom(node, nodes.parentOf)] : [];
  const stored = [bind, ...[...fixed(own), ...fixed(upFromJoint)].map(placedBy)];
  const top = matrices[root] ?? first;
  const guide = isAsLarge(top) ? top : first; // a joint that holds no vertex may have any matrix
  const nearest = (places: readonly Matrix[]) =>
    places.reduce((best, place) =>
      !isNear(place, best) && distance(place, guide) < distance(best, guide) ? place : best,
    );
  const placeBy = (matrix: Matrix) => {
    const place = nearest(stored);
    return isNear(matrix, place) ? place : matrix;
  };
  return {
    matrices,
    root,
    isBound: holding.every((matrix) => isNear(matrix, first)),
    atRest: placeBy(first),
    guide,
    isTurned: isAligned(guide) && stored.every((place) => cosine(place, guide) < kTurned),
    moved(turned) {
      const place = nearest([...stored, ...turned]);
      return isFloat && isAsLarge(place) ? place : placeBy(guide);
    },
    isNear,
  };
}

/** How many times as large a matrix makes what it places. */
const sizeOf = (matrix: Matrix): number => Math.cbrt(Math.abs(determinant(matrix)));

/** The cosine of the angle between two rotations, whatever their scale. */
function cosine(a: Matrix, b: Matrix): number {
  const trace = a.reduce((sum, value, i) => sum + (i < 12 && i % 4 < 3 ? value * b[i]! : 0), 0);
  return (trace / (sizeOf(a) * sizeOf(b)) - 1) / 2;
}

/** Whether a rotation takes axes to axes. */
const isAligned = (matrix: Matrix): boolean =>
  [0, 4, 8].every((at) => Math.max(...matrix.slice(at, at + 3).map(Math.abs)) > kAligned * sizeOf(matrix));
