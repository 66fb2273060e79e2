import Module, { type Manifold } from 'manifold-3d';
import { MeshoptSimplifier } from 'meshoptimizer';
import { gradient, type Sdf } from './sdf.ts';
import { add, cross, dot, length, scale, sub, unit, type Vec3 } from './vec.ts';

/** Triangles, counter-clockwise seen from outside. */
export interface Mesh {
  positions: Float32Array; // 3 per vertex
  indices: Uint32Array; // 3 per triangle
  normals?: Float32Array; // 3 per vertex, unit
  uvs?: Float32Array; // 2 per vertex, (0, 0) is the top left of the image, as in glTF
}

export interface Bounds {
  min: Vec3;
  max: Vec3;
}

/** The library of solids, ready to use. */
export const manifold = await Module();
manifold.setup();
await MeshoptSimplifier.ready;

export const point = (mesh: Mesh, vertex: number): Vec3 => [
  mesh.positions[3 * vertex]!,
  mesh.positions[3 * vertex + 1]!,
  mesh.positions[3 * vertex + 2]!,
];
export const vertexCount = (mesh: Mesh): number => mesh.positions.length / 3;
export const triangleCount = (mesh: Mesh): number => mesh.indices.length / 3;
export const corners = (mesh: Mesh, triangle: number): [number, number, number] => [
  mesh.indices[3 * triangle]!,
  mesh.indices[3 * triangle + 1]!,
  mesh.indices[3 * triangle + 2]!,
];

export const boundsOf = (positions: ArrayLike<number>): Bounds => {
  const min = [Infinity, Infinity, Infinity] as [number, number, number];
  const max = [-Infinity, -Infinity, -Infinity] as [number, number, number];
  for (let i = 0; i < positions.length; i++) {
    min[i % 3] = Math.min(min[i % 3]!, positions[i]!);
    max[i % 3] = Math.max(max[i % 3]!, positions[i]!);
  }
  return { min, max };
};
export const diagonalOf = (positions: ArrayLike<number>): number => {
  const { min, max } = boundsOf(positions);
  return length(sub(max, min));
};

/**
 * The surface of a solid, as a closed mesh (cut off at the bounds) with edges of about `edge`.
 * @param lens  A monotone map per axis from the space that is meshed to the model's, to look closer at some regions; the
 *              bounds are in the meshed space.
 */
export const surface = (solid: Sdf, bounds: Bounds, edge: number, lens: (p: Vec3) => Vec3 = (p) => p): Mesh => {
  const box = { min: [...bounds.min] as [number, number, number], max: [...bounds.max] as [number, number, number] };
  const result = manifold.Manifold.levelSet((p) => -solid(...lens([p[0]!, p[1]!, p[2]!])), box, edge, 0, edge * 0.01);
  return fromSolid(result, lens);
};

/** The mesh of a solid of the library, each point put through `place`; the solid is freed. */
export const fromSolid = (solid: Manifold, place: (p: Vec3) => Vec3 = (p) => p): Mesh => {
  const mesh = solid.getMesh();
  solid.delete();
  const positions = new Float32Array(mesh.numVert * 3);
  for (let v = 0; v < mesh.numVert; v++) {
    const [x, y, z] = place(mesh.position(v) as unknown as Vec3);
    positions[3 * v] = x;
    positions[3 * v + 1] = y;
    positions[3 * v + 2] = z;
  }
  return { positions, indices: new Uint32Array(mesh.triVerts) };
};

/** Keeps what lies where `keep` is not negative, splitting the triangles it crosses. */
export const clip = (mesh: Mesh, keep: (p: Vec3) => number): Mesh => {
  const count = vertexCount(mesh);
  const values = new Float64Array(count);
  for (let v = 0; v < count; v++) values[v] = keep(point(mesh, v));
  const positions = Array.from(mesh.positions);
  const indices: number[] = [];
  const cuts = new Map<number, number>();
  const cut = (inside: number, outside: number): number => {
    const t = values[inside]! / (values[inside]! - values[outside]!);
    const a = point(mesh, inside);
    const at = add(a, scale(sub(point(mesh, outside), a), t));
    // A cut next to a corner would leave a sliver: move the corner to the cut instead.
    if (t < 0.08) {
      at.forEach((x, k) => (positions[3 * inside + k] = x));
      return inside;
    }
    const key = Math.min(inside, outside) * count + Math.max(inside, outside);
    let vertex = cuts.get(key);
    if (vertex === undefined) {
      vertex = positions.length / 3;
      positions.push(...at);
      cuts.set(key, vertex);
    }
    return vertex;
  };
  const emit = (a: number, b: number, c: number): void => {
    if (a !== b && b !== c && c !== a) indices.push(a, b, c);
  };
  for (let t = 0; t < triangleCount(mesh); t++) {
    const triangle = corners(mesh, t);
    const inside = triangle.map((v) => values[v]! >= 0);
    const kept = inside.filter(Boolean).length;
    if (kept === 3) emit(...triangle);
    if (kept !== 1 && kept !== 2) continue;
    const odd = inside.indexOf(kept === 1); // the corner alone on its side
    const [a, b, c] = [triangle[odd]!, triangle[(odd + 1) % 3]!, triangle[(odd + 2) % 3]!];
    if (kept === 1) emit(a, cut(a, b), cut(a, c));
    else {
      const ab = cut(b, a);
      const ac = cut(c, a);
      emit(ab, b, c);
      emit(ab, c, ac);
    }
  }
  return compact({ positions: Float32Array.from(positions), indices: Uint32Array.from(indices) });
};

/** Drops vertices that no triangle uses; the rest keep their order. */
export const compact = (mesh: Mesh): Mesh => {
  const used = new Uint8Array(vertexCount(mesh));
  for (const v of mesh.indices) used[v] = 1;
  const place = new Uint32Array(used.length);
  const positions: number[] = [];
  used.forEach((u, v) => {
    if (!u) return;
    place[v] = positions.length / 3;
    positions.push(...point(mesh, v));
  });
  return { positions: Float32Array.from(positions), indices: mesh.indices.map((v) => place[v]!) };
};

/** The edges that only one triangle has, each as [from, to] in that triangle's direction. */
export const openEdges = (mesh: Mesh): [number, number][] => {
  const count = vertexCount(mesh);
  const seen = new Map<number, [number, number]>();
  for (let t = 0; t < triangleCount(mesh); t++) {
    const c = corners(mesh, t);
    for (let k = 0; k < 3; k++) {
      const [a, b] = [c[k]!, c[(k + 1) % 3]!];
      if (!seen.delete(b * count + a)) seen.set(a * count + b, [a, b]);
    }
  }
  return [...seen.values()];
};

/** Keeps the connected component with the most triangles. */
export const largestPart = (mesh: Mesh): Mesh => {
  const root = components(mesh);
  const size = new Map<number, number>();
  for (let t = 0; t < triangleCount(mesh); t++) {
    const r = root[mesh.indices[3 * t]!]!;
    size.set(r, (size.get(r) ?? 0) + 1);
  }
  const best = [...size].sort((a, b) => b[1] - a[1])[0]![0];
  return compact({
    positions: mesh.positions,
    indices: mesh.indices.filter((_, i) => root[mesh.indices[i - (i % 3)]!] === best),
  });
};

/** For each vertex the lowest vertex of its connected component. */
export const components = (mesh: Mesh): Uint32Array => {
  const parent = Uint32Array.from({ length: vertexCount(mesh) }, (_, v) => v);
  const find = (v: number): number => {
    while (parent[v] !== v) v = parent[v] = parent[parent[v]!]!;
    return v;
  };
  for (let i = 0; i < mesh.indices.length; i++) {
    const a = find(mesh.indices[i]!);
    const b = find(mesh.indices[i - (i % 3)]!);
    parent[Math.max(a, b)] = Math.min(a, b);
  }
  return parent.map((_, v) => find(v));
};

const kPlane = 1e-6; // in model units (a head is about one): nearer to x = 0 counts as on it

/**
 * Fewer triangles, at most `triangles`, as near to the surface as may be. Borders stay, and stay in the plane x = 0.
 * @param keep   Says of a point that a vertex there must stay.
 * @param focus  Maps the model to one whose important regions are enlarged: errors are measured in that.
 */
export const simplify = (
  mesh: Mesh,
  triangles: number,
  keep: (p: Vec3) => boolean = () => false,
  focus: (p: Vec3) => Vec3 = (p) => p,
): Mesh => {
  const next = new Map<number, number[]>();
  for (const [a, b] of openEdges(mesh)) {
    next.set(a, [...(next.get(a) ?? []), b]);
    next.set(b, [...(next.get(b) ?? []), a]);
  }
  const onPlane = (v: number): boolean => Math.abs(mesh.positions[3 * v]!) < kPlane;
  const lock = new Uint8Array(vertexCount(mesh));
  // Where another border meets the plane of symmetry is a corner: losing it would open a gap between the halves.
  for (const [v, around] of next) if (onPlane(v) && !around.every(onPlane)) lock[v] = 1;
  for (let v = 0; v < lock.length; v++) if (keep(point(mesh, v))) lock[v] = 1;
  const none = new Float32Array(vertexCount(mesh));
  const seen = new Float32Array(mesh.positions.length);
  for (let v = 0; v < lock.length; v++) seen.set(focus(point(mesh, v)), 3 * v);
  const [indices] = MeshoptSimplifier.simplifyWithAttributes(
    mesh.indices,
    seen,
    3,
    none,
    1,
    [0],
    lock,
    triangles * 3,
    1,
    ['Regularize'],
  );
  return compact({ positions: mesh.positions, indices });
};

/** Splits the longest edges until there are exactly `triangles`; new vertices are put on the surface by `settle`. */
export const refineTo = (mesh: Mesh, triangles: number, settle: (p: Vec3) => Vec3): Mesh => {
  let missing = triangles - triangleCount(mesh);
  if (missing < 0)
    throw new Error(`refineTo: the mesh has ${triangleCount(mesh)} triangles, more than the ${triangles} wanted`);
  const positions = Array.from(mesh.positions);
  const indices = Array.from(mesh.indices);
  const at = (v: number): Vec3 => [positions[3 * v]!, positions[3 * v + 1]!, positions[3 * v + 2]!];
  while (missing > 0) {
    // Corner k stands for the edge from it to the next corner; an inner edge adds two triangles, an open one adds one.
    const twin = new Map<number, number>();
    const key = (a: number, b: number): number => a * 2 ** 26 + b;
    indices.forEach((a, i) => twin.set(key(a, indices[i - (i % 3) + ((i + 1) % 3)]!), i));
    let best = -1;
    let longest = -1;
    indices.forEach((a, i) => {
      const b = indices[i - (i % 3) + ((i + 1) % 3)]!;
      const open = !twin.has(key(b, a));
      if (open !== (missing === 1)) return;
      const l = length(sub(at(a), at(b)));
      if (l > longest) [best, longest] = [i, l];
    });
    if (best < 0) throw new Error('refineTo: one triangle is missing and the mesh has no open edge to split');
    const [a, b] = [indices[best]!, indices[best - (best % 3) + ((best + 1) % 3)]!];
    const middle = positions.length / 3;
    const p = scale(add(at(a), at(b)), 0.5);
    positions.push(...(missing === 1 ? p : settle(p)));
    for (const corner of [best, twin.get(key(b, a))]) {
      if (corner === undefined) continue;
      const base = corner - (corner % 3);
      const [u, v, w] = [0, 1, 2].map((k) => indices[base + ((corner + k) % 3)]!) as [number, number, number];
      indices.splice(base, 3, u, middle, w);
      indices.push(middle, v, w);
      missing--;
    }
  }
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
};

/** A function that moves a point onto the surface of `solid`; points of the plane x = 0 stay in it. */
export const settleOn =
  (solid: Sdf): ((p: Vec3) => Vec3) =>
  (p) => {
    let q = p;
    for (let i = 0; i < 4; i++) {
      const n = gradient(solid, q);
      q = sub(q, scale(n, solid(...q) * 0.9));
    }
    return Math.abs(p[0]) < kPlane ? [0, q[1], q[2]] : q;
  };

/** The half mesh x ≥ 0 and its mirror image, joined along the plane. */
export const mirror = (half: Mesh): Mesh => {
  const positions = Array.from(half.positions);
  const twin = Array.from({ length: vertexCount(half) }, (_, v) => v);
  for (let v = 0; v < twin.length; v++) {
    const [x, y, z] = point(half, v);
    if (Math.abs(x) < kPlane) positions[3 * v] = 0;
    else {
      twin[v] = positions.length / 3;
      positions.push(-x, y, z);
    }
  }
  const indices = Array.from(half.indices);
  for (let i = 0; i < half.indices.length; i += 3)
    indices.push(twin[half.indices[i]!]!, twin[half.indices[i + 2]!]!, twin[half.indices[i + 1]!]!);
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
};

/** The surface of a solid that is symmetric in x, as a symmetric mesh of exactly `triangles` (even). */
export const symmetricSurface = (
  solid: Sdf,
  plan: {
    bounds: Bounds;
    edge: number;
    triangles: number;
    keep?: (p: Vec3) => number;
    lens?: (p: Vec3) => Vec3;
    focus?: (p: Vec3) => Vec3;
  },
): Mesh => {
  const half = clip(surface(solid, plan.bounds, plan.edge, plan.lens), (p) => p[0]);
  const kept = largestPart(plan.keep ? clip(half, plan.keep) : half);
  return mirror(
    refineTo(simplify(kept, plan.triangles / 2, undefined, plan.focus), plan.triangles / 2, settleOn(solid)),
  );
};

/** The mirror image in x = 0, still facing outwards. UVs stay. */
export const reflected = (mesh: Mesh): Mesh => {
  const flip = (a: Float32Array): Float32Array => a.map((v, i) => (i % 3 ? v : -v));
  const indices = mesh.indices.slice();
  for (let i = 0; i < indices.length; i += 3) [indices[i + 1], indices[i + 2]] = [indices[i + 2]!, indices[i + 1]!];
  return {
    ...mesh,
    positions: flip(mesh.positions),
    indices,
    ...(mesh.normals ? { normals: flip(mesh.normals) } : {}),
  };
};

/** Several meshes as one; they must have the same attributes. */
export const join = (...meshes: Mesh[]): Mesh => {
  const collect = (pick: (m: Mesh) => Float32Array | undefined): Float32Array =>
    Float32Array.from(meshes.flatMap((m) => Array.from(pick(m) ?? [])));
  let first = 0;
  const indices = meshes.flatMap((m) => {
    const shifted = Array.from(m.indices, (v) => v + first);
    first += vertexCount(m);
    return shifted;
  });
  const all = (pick: (m: Mesh) => Float32Array | undefined): boolean => meshes.every((m) => pick(m) !== undefined);
  return {
    positions: collect((m) => m.positions),
    indices: Uint32Array.from(indices),
    ...(all((m) => m.normals) ? { normals: collect((m) => m.normals) } : {}),
    ...(all((m) => m.uvs) ? { uvs: collect((m) => m.uvs) } : {}),
  };
};

/** Normals from the field whose surface the mesh is: smooth however few the triangles. */
export const withFieldNormals = (mesh: Mesh, solid: Sdf): Mesh => {
  const normals = new Float32Array(mesh.positions.length);
  for (let v = 0; v < vertexCount(mesh); v++) normals.set(gradient(solid, point(mesh, v), 2e-3), 3 * v);
  return { ...mesh, normals };
};

/** Normals from the triangles around each vertex, weighted by area. */
export const withMeshNormals = (mesh: Mesh): Mesh => {
  const sums = new Float64Array(mesh.positions.length);
  for (let t = 0; t < triangleCount(mesh); t++) {
    const c = corners(mesh, t);
    const n = faceNormal(mesh, t);
    for (const v of c) n.forEach((d, k) => (sums[3 * v + k]! += d));
  }
  const normals = new Float32Array(sums.length);
  for (let v = 0; v < vertexCount(mesh); v++) {
    const n = unit([sums[3 * v]!, sums[3 * v + 1]!, sums[3 * v + 2]!]);
    normals.set(length(n) > 0 ? n : [0, 1, 0], 3 * v); // all triangles there are flat: any will do
  }
  return { ...mesh, normals };
};

/** Normals as above, but not across edges sharper than `angle` (radians): there the vertices are doubled. */
export const withCreasedNormals = (mesh: Mesh, angle: number): Mesh => {
  const faces = Array.from({ length: triangleCount(mesh) }, (_, t) => faceNormal(mesh, t));
  const around: number[][] = Array.from({ length: vertexCount(mesh) }, () => []);
  mesh.indices.forEach((v, i) => around[v]!.push(Math.floor(i / 3)));
  const place = new Map<string, number>();
  const positions: number[] = [];
  const normals: number[] = [];
  const indices = mesh.indices.map((v, i) => {
    const own = unit(faces[Math.floor(i / 3)]!);
    const alike = around[v]!.filter((t) => dot(own, unit(faces[t]!)) > Math.cos(angle));
    const normal = unit(alike.map((t) => faces[t]!).reduce((a, b) => add(a, b), [0, 0, 0] as Vec3));
    const key = `${v} ${normal.map((x) => x.toFixed(3)).join(' ')}`;
    let at = place.get(key);
    if (at === undefined) {
      place.set(key, (at = positions.length / 3));
      positions.push(...point(mesh, v));
      normals.push(...normal);
    }
    return at;
  });
  return { positions: Float32Array.from(positions), normals: Float32Array.from(normals), indices };
};

/** The normal of a triangle, as long as twice its area. */
export const faceNormal = (mesh: Mesh, triangle: number): Vec3 => {
  const [a, b, c] = corners(mesh, triangle).map((v) => point(mesh, v)) as [Vec3, Vec3, Vec3];
  return cross(sub(b, a), sub(c, a));
};
