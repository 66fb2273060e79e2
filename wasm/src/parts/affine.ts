export type Vector = readonly [x: number, y: number, z: number];

/** A column of an affine 4×4 matrix. */
export const column = (matrix: ArrayLike<number>, c: number): Vector => [
  matrix[4 * c]!,
  matrix[4 * c + 1]!,
  matrix[4 * c + 2]!,
];

/** The determinant of three columns: the volume that they span, negative if they are left-handed. */
export const volume = ([a, b, c]: Vector, [d, e, f]: Vector, [g, h, i]: Vector): number =>
  a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g);

/** The determinant of the upper 3×3 of a 4×4 matrix, column by column: the factor of volume, negative if the matrix mirrors. */
export const determinant = (matrix: ArrayLike<number>): number =>
  volume(column(matrix, 0), column(matrix, 1), column(matrix, 2));
