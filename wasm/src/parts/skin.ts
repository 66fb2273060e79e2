import { determinant } from './affine.js';

/** Joints place a mesh equally if they differ by at most this share of its size. */
const kSame = 1e-3;

/** A skinned mesh, and how its joints hold it. Matrices are column by column. */
export interface Skinned<Matrix extends ArrayLike<number>> {
  /** 1 per joint of its skin: the joint's matrix in the scene · its inverse bind matrix. */
  matrices: readonly Matrix[];
  /** 4 per vertex: joints and their weights. */
  held: ArrayLike<number>;
  weights: ArrayLike<number>;
  /** 3 per vertex, as they are stored. */
  positions: Float32Array;
  /** Whether they are floats in the file; else they are quantised. */
  isFloat: boolean;
  /** From the mesh as it is stored to the scene, in the bind pose, as far as that is known without the joints: the likeliest first. */
  stored: readonly [Matrix, ...Matrix[]];
}

/**
 * Returns the matrices by which skeletons at rest place skinned meshes in the scene. Files that are quantised, or whose rig has
 * another unit or axis than the scene, store this only in the inverse bind matrices. `placeSkinned` in C++ has the same rules.
 *
 * In the bind pose all joints of a mesh give the same matrix, which is returned. If those of any mesh differ, the model has moved: joints
 * of other meshes may be equal only because they have turned together, as those of an eye. Then all meshes are taken as they are
 * stored, unless that cannot be right because they are quantised or of another size; these are placed by the first joint of their
 * skin, which is most often the root.
 * @param meshes  All skinned meshes of a model.
 * @return Matrices to the scene: of `stored`, if these will do.
 */
export function skinMatrices<Matrix extends ArrayLike<number>>(meshes: readonly Skinned<Matrix>[]): Matrix[] {
  const holds = meshes.map(holdOf);
  const hasMoved = !holds.every(({ isBound }) => isBound);
  return holds.map(({ atRest, moved }) => (hasMoved ? moved : atRest));
}

/** How joints hold a mesh: where it is if the model is at rest, and if it has moved. */
function holdOf<Matrix extends ArrayLike<number>>(mesh: Skinned<Matrix>) {
  const { matrices, held, weights, positions, isFloat } = mesh;
  const used = new Set<Matrix>();
  for (let i = 0; i < held.length; ++i) if (weights[i]! > 0) used.add(matrices[held[i]!]!);
  const holding = matrices.filter((matrix) => used.has(matrix) && sizeOf(matrix) > 0);
  const first = holding[0] ?? mesh.stored[0];
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
  const root = matrices[0] ?? first;
  const guide = isAsLarge(root) ? root : first; // a joint that holds no vertex may have any matrix
  const stored = mesh.stored.reduce((best, place) =>
    !isNear(place, best) && distance(place, guide) < distance(best, guide) ? place : best,
  );
  const placeBy = (matrix: Matrix) => (isNear(matrix, stored) ? stored : matrix);
  return {
    isBound: holding.every((matrix) => isNear(matrix, first)),
    atRest: placeBy(first),
    moved: isFloat && isAsLarge(stored) ? stored : placeBy(guide),
  };
}

/** How many times as large a matrix makes what it places. */
const sizeOf = (matrix: ArrayLike<number>): number => Math.cbrt(Math.abs(determinant(matrix)));
