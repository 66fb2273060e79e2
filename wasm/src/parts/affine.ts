/** A 4×4 matrix, column by column, in double precision. */
export type Matrix = readonly number[];

export const identity: Matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export const isIdentity = (matrix: ArrayLike<number>): boolean => identity.every((value, i) => matrix[i] === value);

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

/** a · b. */
export function multiply(a: ArrayLike<number>, b: ArrayLike<number>): Matrix {
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

/** The inverse of an affine matrix; `undefined` if there is none. */
export function inverted(matrix: Matrix): Matrix | undefined {
  const [a, b, c, t] = [0, 1, 2, 3].map((at) => column(matrix, at)) as [Vector, Vector, Vector, Vector];
  const whole = volume(a, b, c);
  if (!(Math.abs(whole) > 0)) return undefined;
  const axes: Vector[] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ];
  // By Cramer's rule: the point that the matrix takes to each axis, and to the origin.
  const solve = (d: Vector): number[] => [volume(d, b, c), volume(a, d, c), volume(a, b, d)].map((x) => x / whole);
  return [...axes.flatMap((axis) => [...solve(axis), 0]), ...solve(t).map((x) => -x), 1];
}
