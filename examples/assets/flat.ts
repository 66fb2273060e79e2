import { corners, type Mesh, point, triangleCount } from './mesh.ts';
import { add, cross, dot, length, scale, sub, type Vec3 } from './vec.ts';

export type Uv = readonly [number, number];

/** Twice the signed area of a flat triangle. */
export const area = (a: Uv, b: Uv, c: Uv): number => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

export type Flat = readonly [Float64Array, Float64Array]; // u and v, each 1 per vertex

/** Whether a closed polygon's sides meet only in their common corners. */
export const isSimple = (polygon: Uv[]): boolean => {
  const n = polygon.length;
  for (let i = 0; i < n; i++)
    for (let j = i + 2; j < n; j++) {
      if (i === 0 && j === n - 1) continue;
      const [a, b, c, d] = [polygon[i]!, polygon[i + 1]!, polygon[j]!, polygon[(j + 1) % n]!];
      if (area(a, b, c) * area(a, b, d) <= 0 && area(c, d, a) * area(c, d, b) <= 0) return false;
    }
  return true;
};

const flatTriangle = (mesh: Mesh, triangle: number): [Uv, Uv, Uv] => {
  const [a, b, c] = corners(mesh, triangle).map((v) => point(mesh, v)) as [Vec3, Vec3, Vec3];
  const [u, w] = [sub(b, a), sub(c, a)];
  const l = length(u);
  return [
    [0, 0],
    [l, 0],
    [dot(u, w) / l, length(cross(u, w)) / l],
  ];
};

/** What a layout of a mesh shall be like. */
export interface Rest {
  triangles: [number, number, number][]; // vertices
  shapes: [Uv, Uv, Uv][]; // each triangle laid flat, and enlarged
  areas: number[];
}

/** @param zoom  How much each place of the model is enlarged. */
export const restOf = (mesh: Mesh, zoom: (p: Vec3) => number): Rest => {
  const triangles = Array.from({ length: triangleCount(mesh) }, (_, t) => corners(mesh, t));
  const shapes = triangles.map((t, i) => {
    const centre = scale(
      t.map((v) => point(mesh, v)).reduce((a, b) => add(a, b)),
      1 / 3,
    );
    return flatTriangle(mesh, i).map(([x, y]) => [x * zoom(centre), y * zoom(centre)]) as unknown as [Uv, Uv, Uv];
  });
  return { triangles, shapes, areas: shapes.map((p) => area(...p) / 2) };
};

/** Half the cotangent of the angle at `apex`, kept from zero and below: obtuse triangles would make the system indefinite. */
export const cotangent = (apex: Uv, a: Uv, b: Uv): number => {
  const d = (a[0] - apex[0]) * (b[0] - apex[0]) + (a[1] - apex[1]) * (b[1] - apex[1]);
  return Math.max(d / Math.abs(area(apex, a, b)), 0.02) / 2;
};

/** Factors a symmetric positive definite matrix (n × n, dense: cages are small) and returns its solver. */
export const cholesky = (matrix: Float64Array, n: number): ((b: Float64Array) => Float64Array) => {
  const l = matrix.slice();
  const first = new Uint32Array(n); // the first entry of each row that is not zero, nor becomes so
  for (let i = 0; i < n; i++) {
    while (l[i * n + first[i]!] === 0) first[i]!++;
    for (let j = first[i]!; j <= i; j++) {
      let sum = l[i * n + j]!;
      for (let k = Math.max(first[i]!, first[j]!); k < j; k++) sum -= l[i * n + k]! * l[j * n + k]!;
      l[i * n + j] = i === j ? Math.sqrt(sum) : sum / l[j * n + j]!;
    }
  }
  return (b) => {
    const x = b.slice();
    for (let i = 0; i < n; i++) {
      for (let k = first[i]!; k < i; k++) x[i]! -= l[i * n + k]! * x[k]!;
      x[i]! /= l[i * n + i]!;
    }
    for (let i = n - 1; i >= 0; i--) {
      x[i]! /= l[i * n + i]!;
      for (let k = first[i]!; k < i; k++) x[k]! -= l[i * n + k]! * x[i]!;
    }
    return x;
  };
};
