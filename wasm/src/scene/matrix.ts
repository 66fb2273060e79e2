import { determinant, type Matrix } from '../parts/affine.js';

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

/** Whether a matrix mirrors, so that the winding of triangles must be reversed. */
export const isMirrored = (matrix: Matrix): boolean => determinant(matrix) < 0;
