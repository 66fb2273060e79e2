import { Matrix3, Matrix4, Quaternion, Vector3 } from 'three';

/** The rotation, uniform scale and shift that bring points closest to others (Horn 1987). */
export function similarity(from: readonly Vector3[], to: readonly Vector3[]): Matrix4 {
  const middle = (points: readonly Vector3[]): Vector3 =>
    points.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(points.length);
  const [a, b] = [middle(from), middle(to)];
  const s = new Float64Array(9);
  let [ownSize, otherSize] = [0, 0];
  from.forEach((p, i) => {
    const [u, v] = [p.clone().sub(a).toArray(), to[i]!.clone().sub(b).toArray()];
    for (let k = 0; k < 9; ++k) s[k]! += u[Math.floor(k / 3)]! * v[k % 3]!;
    ownSize += u[0] ** 2 + u[1] ** 2 + u[2] ** 2;
    otherSize += v[0] ** 2 + v[1] ** 2 + v[2] ** 2;
  });
  const [xx, xy, xz, yx, yy, yz, zx, zy, zz] = s as unknown as Nine;
  const [w, x, y, z] = strongest([
    [xx + yy + zz, yz - zy, zx - xz, xy - yx],
    [yz - zy, xx - yy - zz, xy + yx, zx + xz],
    [zx - xz, xy + yx, yy - xx - zz, yz + zy],
    [xy - yx, zx + xz, yz + zy, zz - xx - yy],
  ]) as [number, number, number, number];
  const scale = Math.sqrt(otherSize / ownSize);
  const matrix = new Matrix4().compose(new Vector3(), new Quaternion(x, y, z, w), new Vector3(scale, scale, scale));
  const linear = new Matrix3().setFromMatrix4(matrix);
  return matrix.setPosition(b.sub(a.applyMatrix3(linear)));
}
type Nine = [number, number, number, number, number, number, number, number, number];

/** The eigenvector of the largest eigenvalue of a symmetric matrix, by Jacobi's rotations. */
function strongest(matrix: number[][]): number[] {
  const n = matrix.length;
  const vectors = matrix.map((_, i) => matrix.map((__, j) => +(i === j)));
  for (let sweep = 0; sweep < 50; ++sweep) {
    for (let p = 0; p < n; ++p) {
      for (let q = p + 1; q < n; ++q) {
        if (Math.abs(matrix[p]![q]!) < 1e-300) continue;
        const angle = Math.atan2(2 * matrix[p]![q]!, matrix[q]![q]! - matrix[p]![p]!) / 2;
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        for (const row of [...matrix, ...vectors])
          [row[p], row[q]] = [c * row[p]! - s * row[q]!, s * row[p]! + c * row[q]!];
        const [rowP, rowQ] = [[...matrix[p]!], [...matrix[q]!]];
        for (let k = 0; k < n; ++k)
          [matrix[p]![k], matrix[q]![k]] = [c * rowP[k]! - s * rowQ[k]!, s * rowP[k]! + c * rowQ[k]!];
      }
    }
  }
  const best = matrix.reduce((most, row, i) => (row[i]! > matrix[most]![most]! ? i : most), 0);
  return vectors.map((row) => row[best]!);
}
