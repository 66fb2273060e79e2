import { determinant } from '../parts/affine.js';

/** A 4×4 matrix, column by column, in double precision. */
export type Matrix = readonly number[];

export const identity: Matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** Where a node is: its matrix, or translation · rotation · scale. */
type NodePlace = { readonly [Name in 'matrix' | 'translation' | 'rotation' | 'scale']?: number[] | undefined };

/** The matrix of a node. */
export function localMatrix(node: NodePlace): Matrix {
  if (node.matrix) return node.matrix;
  const [tx = 0, ty = 0, tz = 0] = node.translation ?? [];
  const [x = 0, y = 0, z = 0, w = 1] = node.rotation ?? [];
  const [sx = 1, sy = 1, sz = 1] = node.scale ?? [];
  // prettier-ignore
  return [
    (1 - 2 * (y * y + z * z)) * sx,
    2 * (x * y + z * w) * sx,
    2 * (x * z - y * w) * sx,
    0,
    2 * (x * y - z * w) * sy,
    (1 - 2 * (x * x + z * z)) * sy,
    2 * (y * z + x * w) * sy,
    0,
    2 * (x * z + y * w) * sz,
    2 * (y * z - x * w) * sz,
    (1 - 2 * (x * x + y * y)) * sz,
    0,
    tx,
    ty,
    tz,
    1,
  ];
}

/** a · b. */
export function multiply(a: Matrix, b: ArrayLike<number>): Matrix {
  const out = new Array<number>(16);
  for (let column = 0; column < 4; ++column) {
    for (let row = 0; row < 4; ++row) {
      let sum = 0;
      for (let k = 0; k < 4; ++k) sum += a[4 * k + row]! * b[4 * column + k]!;
      out[4 * column + row] = sum;
    }
  }
  return out;
}

/** Whether a matrix mirrors, so that the winding of triangles must be reversed. */
export const isMirrored = (matrix: Matrix): boolean => determinant(matrix) < 0;
