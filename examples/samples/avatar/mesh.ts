import type { Primitive } from '@gltf-transform/core';

/** A point, direction or colour: x, y, z. */
export type Vec3 = readonly [number, number, number];

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec3, s: number): Vec3 => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a: Vec3): number => Math.hypot(...a);
export const unit = (a: Vec3): Vec3 => scale(a, 1 / (length(a) || 1));
export const mix = (a: Vec3, b: Vec3, t: number): Vec3 => add(scale(a, 1 - t), scale(b, t));
export const clamp = (x: number, low = 0, high = 1): number => Math.min(Math.max(x, low), high);
/** 0 up to `from`, 1 from `to` on, smooth between; `from` may be the larger. */
export const smoothstep = (from: number, to: number, x: number): number => {
  const t = clamp((x - from) / (to - from));
  return t * t * (3 - 2 * t);
};
/** A right-handed orthonormal frame whose third axis is `forward` and whose second leans towards `up`. */
export const frame = (forward: Vec3, up: Vec3 = [0, 1, 0]): [Vec3, Vec3, Vec3] => {
  const front = unit(forward);
  const right = unit(cross(up, front));
  return [right, cross(front, right), front];
};
/** sRGB of #rrggbb as linear values. */
export const linear = (hex: string): Vec3 =>
  [1, 3, 5].map((at) => toLinear(Number.parseInt(hex.slice(at, at + 2), 16) / 255)) as unknown as Vec3;
export const toLinear = (value: number): number =>
  value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;

export interface Vertex {
  at: Vec3;
  /** Where it was when the face was modelled: what moves it is known there. */
  base: Vec3;
  /** Linear. */
  color: Vec3;
  /** 1 per joint of the skeleton; empty until they are known. */
  weights: readonly number[];
}

export interface Mesh {
  vertices: Vertex[];
  triangles: [number, number, number][];
}

const between = (a: Vertex, b: Vertex, t: number): Vertex => ({
  at: mix(a.at, b.at, t),
  base: mix(a.base, b.base, t),
  color: mix(a.color, b.color, t),
  weights: a.weights.map((weight, j) => weight * (1 - t) + b.weights[j]! * t),
});

/** Reads a primitive; vertices of the same place become one. */
export function read(primitive: Primitive, place: (p: Vec3) => Vec3, colorAt: (vertex: number) => Vec3): Mesh {
  const [positions, indices] = [primitive.getAttribute('POSITION')!, primitive.getIndices()!.getArray()!];
  const known = new Map<string, number>();
  const mesh: Mesh = { vertices: [], triangles: [] };
  const names = Array.from({ length: positions.getCount() }, (_, v) => {
    const at = positions.getElement(v, []) as unknown as Vec3;
    const key = at.map((value) => Math.round(value * 1e6)).join(); // 0 and -0 are one
    if (!known.has(key)) {
      known.set(key, mesh.vertices.length);
      const placed = place(at);
      mesh.vertices.push({ at: placed, base: placed, color: colorAt(v), weights: [] });
    }
    return known.get(key)!;
  });
  for (let i = 0; i < indices.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => names[indices[i + k]!]!) as [number, number, number];
    if (a !== b && b !== c && c !== a) mesh.triangles.push([a, b, c]);
  }
  return mesh;
}

/** The same without what no triangle uses. */
export function tidy({ vertices, triangles }: Mesh): Mesh {
  const used = [...new Set(triangles.flat())].sort((a, b) => a - b);
  const places = new Map(used.map((v, i) => [v, i]));
  return {
    vertices: used.map((v) => vertices[v]!),
    triangles: triangles.map((triangle) => triangle.map((v) => places.get(v)!) as [number, number, number]),
  };
}

/** What of a mesh is where a field is positive; triangles are cut. */
export function clip({ vertices, triangles }: Mesh, field: (p: Vec3) => number): Mesh {
  const all = [...vertices];
  const values = vertices.map(({ at }) => {
    const value = field(at);
    return Math.abs(value) < 1e-4 ? 1e-4 : value; // no slivers
  });
  const cuts = new Map<string, number>();
  const cutOf = (a: number, b: number): number => {
    const [low, high] = a < b ? [a, b] : [b, a];
    const key = `${low} ${high}`;
    if (!cuts.has(key)) {
      cuts.set(key, all.length);
      all.push(between(vertices[low]!, vertices[high]!, values[low]! / (values[low]! - values[high]!)));
    }
    return cuts.get(key)!;
  };
  const kept = triangles.flatMap((triangle): [number, number, number][] => {
    const polygon = triangle.flatMap((a, k) => {
      const b = triangle[(k + 1) % 3]!;
      const crosses = values[a]! > 0 !== values[b]! > 0;
      return [...(values[a]! > 0 ? [a] : []), ...(crosses ? [cutOf(a, b)] : [])];
    });
    return polygon.slice(2).map((c, k) => [polygon[0]!, polygon[k + 1]!, c]);
  });
  return tidy({ vertices: all, triangles: kept });
}

/** Meshes side by side, not connected. */
export const join = (...meshes: Mesh[]): Mesh =>
  meshes.reduce((all, { vertices, triangles }) => {
    const first = all.vertices.length;
    return {
      vertices: [...all.vertices, ...vertices],
      triangles: [...all.triangles, ...triangles.map((t) => t.map((v) => v + first) as [number, number, number])],
    };
  });

/** The mirror image. Weights are those of the mesh: set them afterwards. */
export const reflected = ({ vertices, triangles }: Mesh): Mesh => {
  const flip = ([x, y, z]: Vec3): Vec3 => [-x, y, z];
  return {
    vertices: vertices.map((vertex) => ({ ...vertex, at: flip(vertex.at), base: flip(vertex.base) })),
    triangles: triangles.map(([a, b, c]) => [a, c, b]),
  };
};

export function neighbours({ vertices, triangles }: Mesh): number[][] {
  const around = vertices.map(() => new Set<number>());
  for (const [a, b, c] of triangles)
    for (const [v, w] of [
      [a, b],
      [b, c],
      [c, a],
    ] as const) {
      around[v]!.add(w);
      around[w]!.add(v);
    }
  return around.map((set) => [...set]);
}

/** The border's edges, from each vertex to the next. */
export function border({ triangles }: Mesh): Map<number, number> {
  const edges = new Set(triangles.flatMap(([a, b, c]) => [`${a} ${b}`, `${b} ${c}`, `${c} ${a}`]));
  return new Map(
    [...edges].flatMap((edge) => {
      const [a, b] = edge.split(' ').map(Number) as [number, number];
      return edges.has(`${b} ${a}`) ? [] : [[a, b] as const];
    }),
  );
}

/** A unit normal per vertex. */
export function normalsOf({ triangles }: Mesh, points: readonly Vec3[]): Vec3[] {
  const sums = points.map(() => [0, 0, 0]);
  for (const triangle of triangles) {
    const [a, b, c] = triangle.map((v) => points[v]!) as [Vec3, Vec3, Vec3];
    const normal = cross(sub(b, a), sub(c, a)); // weighs by area
    for (const v of triangle) for (let k = 0; k < 3; k++) sums[v]![k]! += normal[k]!;
  }
  return sums.map((sum) => unit(sum as unknown as Vec3));
}

/** Moves vertices towards the middle of their neighbours; those of the border along the border only. */
export function smoothed(mesh: Mesh, points: readonly Vec3[], rounds: number, share: (v: number) => number): Vec3[] {
  const around = neighbours(mesh);
  const next = border(mesh);
  const last = new Map([...next].map(([a, b]) => [b, a]));
  const at = [...points];
  for (let round = 0; round < rounds; round++) {
    const before = [...at];
    before.forEach((p, v) => {
      const near = next.has(v) ? [next.get(v)!, last.get(v)!] : around[v]!;
      const middle = scale(
        near.reduce<Vec3>((sum, w) => add(sum, before[w]!), [0, 0, 0]),
        1 / near.length,
      );
      at[v] = mix(p, middle, 0.5 * share(v));
    });
  }
  return at;
}

/**
 * Closes the gap between two loops around an axis through `middle` along y, seen from outside.
 * @param upper  Vertices of the mesh; the order does not matter.
 */
export function zip(mesh: Mesh, upper: number[], lower: number[], middle: Vec3): Mesh {
  const turn = (v: number): number => {
    const [x, , z] = sub(mesh.vertices[v]!.at, middle);
    return Math.atan2(x, z);
  };
  const [a, b] = [upper, lower].map((loop) => [...loop].sort((v, w) => turn(v) - turn(w))) as [number[], number[]];
  const triangles = [...mesh.triangles];
  for (let i = 0, j = 0; i < a.length || j < b.length; ) {
    const [nextA, nextB] = [a[(i + 1) % a.length]!, b[(j + 1) % b.length]!];
    const far = (v: number, at: number, loop: number[]): number => turn(v) + (at + 1 >= loop.length ? 2 * Math.PI : 0);
    const [v, w] = [a[i % a.length]!, b[j % b.length]!];
    if (j >= b.length || (i < a.length && far(nextA, i, a) < far(nextB, j, b))) {
      triangles.push([v, w, nextA]);
      i++;
    } else {
      triangles.push([v, w, nextB]);
      j++;
    }
  }
  return { ...mesh, triangles };
}
