/** Joints place a mesh equally if they differ by at most this share of its size. */
const kSame = 1e-3;

/**
 * Returns the matrix by which a skeleton at rest places a skinned mesh in the scene. Files that are quantised, or whose rig has
 * another unit or axis than the scene, store this only in the inverse bind matrices.
 *
 * In the bind pose all joints give the same matrix, which is returned. If some joints have moved, the mesh is taken as it is stored,
 * unless that cannot be right because it is quantised or of another size; then the first joint's matrix is returned.
 * @param joints     1 per joint: its matrix in the scene · its inverse bind matrix, column by column.
 * @param used       The joints that hold any vertex.
 * @param positions  3 per vertex, as they are stored.
 * @param isFloat    Whether they are floats in the file; else they are quantised.
 * @param stored     From the mesh as it is stored to the scene, in the bind pose, as far as that is known without the joints.
 * @return A matrix to the scene: `stored` itself, if that will do.
 */
export function skinMatrix<M extends ArrayLike<number>>(
  joints: readonly M[],
  used: ReadonlySet<number>,
  positions: ArrayLike<number>,
  isFloat: boolean,
  stored: M,
): M {
  const [first, ...others] = joints.filter((_, joint) => used.has(joint));
  if (first === undefined) return stored;
  let reach = 0;
  for (let i = 0; i < positions.length; ++i) reach = Math.max(reach, Math.abs(positions[i]!));
  const scale = Math.cbrt(Math.abs(determinant(first)));
  if (!(scale > 0 && scale < Infinity)) return stored;
  const isNear = (a: ArrayLike<number>, b: ArrayLike<number>): boolean =>
    [0, 1, 2].every((row) => {
      const off = (column: number) => Math.abs(a[4 * column + row]! - b[4 * column + row]!);
      return (off(0) + off(1) + off(2)) * reach + off(3) <= kSame * scale * reach;
    });
  const isBound = others.every((other) => isNear(other, first));
  const isAsLarge = Math.abs(scale - Math.cbrt(Math.abs(determinant(stored)))) < kSame * scale;
  return isNear(first, stored) || (!isBound && isFloat && isAsLarge) ? stored : first;
}

/**
 * The joints that hold any vertex.
 * @param joints,weights  4 per vertex.
 */
export function usedJoints(joints: ArrayLike<number>, weights: ArrayLike<number>): Set<number> {
  const used = new Set<number>();
  for (let i = 0; i < joints.length; ++i) if (weights[i]! > 0) used.add(joints[i]!);
  return used;
}

/** The determinant of the upper 3×3 of a 4×4 matrix, column by column: the factor of volume, negative if the matrix mirrors. */
export function determinant(m: ArrayLike<number>): number {
  const [a, b, c, , d, e, f, , g, h, i] = Array.from(m) as [
    number,
    number,
    number,
    number,
    number,
    number,
    number,
    number,
    number,
    number,
    number,
  ];
  return a * (e * i - f * h) - d * (b * i - c * h) + g * (b * f - c * e);
}
