import { area, cholesky, cotangent, type Flat, isSimple, restOf, type Uv } from './flat.ts';
import {
  boundsOf,
  components,
  corners,
  faceNormal,
  type Mesh,
  openEdges,
  point,
  triangleCount,
  vertexCount,
} from './mesh.ts';
import { polish } from './polish.ts';
import { add, dot, length, scale, sub, unit, type Vec3 } from './vec.ts';

/**
 * Gives each vertex a copy for each group of its triangles that `joined` edges hold together.
 * @param joined  Says of an edge (two vertices) and its two triangles whether they stay together.
 */
export const splitAlong = (
  mesh: Mesh,
  joined: (a: number, b: number, left: number, right: number) => boolean,
): { mesh: Mesh; source: number[] } => {
  const parent = Array.from(mesh.indices, (_, i) => i);
  const find = (i: number): number => {
    while (parent[i] !== i) i = parent[i] = parent[parent[i]!]!;
    return i;
  };
  const unite = (a: number, b: number): void => {
    const [x, y] = [find(a), find(b)];
    parent[Math.max(x, y)] = Math.min(x, y);
  };
  const count = vertexCount(mesh);
  const edges = new Map<number, number>();
  const nextCorner = (i: number): number => i - (i % 3) + ((i + 1) % 3);
  mesh.indices.forEach((a, i) => edges.set(a * count + mesh.indices[nextCorner(i)]!, i));
  mesh.indices.forEach((a, i) => {
    const b = mesh.indices[nextCorner(i)]!;
    const twin = edges.get(b * count + a);
    if (twin === undefined || !joined(a, b, Math.floor(i / 3), Math.floor(twin / 3))) return;
    unite(i, nextCorner(twin));
    unite(nextCorner(i), twin);
  });
  const place = new Map<number, number>();
  const source: number[] = [];
  const indices = mesh.indices.map((v, i) => {
    const root = find(i);
    let vertex = place.get(root);
    if (vertex === undefined) {
      place.set(root, (vertex = source.length));
      source.push(v);
    }
    return vertex;
  });
  const spread = (a: Float32Array): Float32Array =>
    Float32Array.from(source.flatMap((v) => [a[3 * v]!, a[3 * v + 1]!, a[3 * v + 2]!]));
  return {
    mesh: { positions: spread(mesh.positions), indices, ...(mesh.normals ? { normals: spread(mesh.normals) } : {}) },
    source,
  };
};

/** A grid of cells a chart's triangles may each take once: tells when a flattened patch begins to lie over itself. */
class Occupancy {
  private readonly taken = new Set<number>();
  private readonly cell: number;
  constructor(cell: number) {
    this.cell = cell;
  }
  /** Takes the cells whose centres lie inside the triangle, unless one is taken already. */
  take(a: Uv, b: Uv, c: Uv): boolean {
    const inside: number[] = [];
    const low = (k: 0 | 1): number => Math.floor(Math.min(a[k], b[k], c[k]) / this.cell);
    const high = (k: 0 | 1): number => Math.ceil(Math.max(a[k], b[k], c[k]) / this.cell);
    for (let j = low(1); j <= high(1); j++)
      for (let i = low(0); i <= high(0); i++) {
        const p: Uv = [(i + 0.5) * this.cell, (j + 0.5) * this.cell];
        if (area(a, b, p) < 0 || area(b, c, p) < 0 || area(c, a, p) < 0) continue;
        const key = (i + 4096) * 8192 + j + 4096;
        if (this.taken.has(key)) return false;
        inside.push(key);
      }
    for (const key of inside) this.taken.add(key);
    return true;
  }
}

const kSides: { normal: Vec3; u: Vec3; v: Vec3 }[] = [
  { normal: [0, 0, 1], u: [1, 0, 0], v: [0, 1, 0] },
  { normal: [0, 0, -1], u: [-1, 0, 0], v: [0, 1, 0] },
  { normal: [1, 0, 0], u: [0, 0, -1], v: [0, 1, 0] },
  { normal: [-1, 0, 0], u: [0, 0, 1], v: [0, 1, 0] },
  { normal: [0, 1, 0], u: [1, 0, 0], v: [0, 0, -1] },
  { normal: [0, -1, 0], u: [1, 0, 0], v: [0, 0, 1] },
];

/**
 * Unwraps a mesh onto the six sides of a box: each side's triangles, as far as they are connected and do not lie over one
 * another, are a chart, drawn flat and to one scale; the charts are packed into 0..1.
 * @param margin  Free space around each chart, in UV.
 */
export const boxAtlas = (mesh: Mesh, margin = 0.006): Mesh => {
  const count = triangleCount(mesh);
  const normals = Array.from({ length: count }, (_, t) => unit(faceNormal(mesh, t)));
  let side = normals.map((n) =>
    kSides.map((s) => dot(n, s.normal)).reduce((best, d, k, all) => (d > all[best]! ? k : best), 0),
  );
  const around = neighbours(mesh);
  // Straighten the borders of the charts: a triangle follows its neighbours if it still faces their side well enough.
  for (let pass = 0; pass < 4; pass++)
    side = side.map((own, t) => {
      const votes = around[t]!.map((n) => side[n]!);
      const other = votes.find((s, i) => s !== own && votes.indexOf(s) !== i);
      return other !== undefined && dot(normals[t]!, kSides[other]!.normal) > 0.3 ? other : own;
    });
  const flat = (v: number, s: number): Uv => [dot(point(mesh, v), kSides[s]!.u), dot(point(mesh, v), kSides[s]!.v)];
  const bounds = boundsOf(mesh.positions);
  const cell = length(sub(bounds.max, bounds.min)) / 800;
  const chart = new Int32Array(count).fill(-1);
  const charts: number[] = []; // the side of each
  for (let seed = 0; seed < count; seed++) {
    if (chart[seed] !== -1) continue;
    const id = charts.push(side[seed]!) - 1;
    const grid = new Occupancy(cell);
    const queue = [seed];
    while (queue.length > 0) {
      const t = queue.shift()!;
      if (chart[t] !== -1 || side[t] !== charts[id]) continue;
      const [a, b, c] = corners(mesh, t).map((v) => flat(v, charts[id]!)) as [Uv, Uv, Uv];
      if (t !== seed && !grid.take(a, b, c)) continue;
      if (t === seed) grid.take(a, b, c);
      chart[t] = id;
      queue.push(...around[t]!);
    }
  }
  const split = splitAlong(mesh, (_a, _b, left, right) => chart[left] === chart[right]);
  const owner = new Int32Array(vertexCount(split.mesh));
  split.mesh.indices.forEach((v, i) => (owner[v] = chart[Math.floor(i / 3)]!));
  const uv = split.source.map((v, i) => flat(v, charts[owner[i]!]!));
  return { ...split.mesh, uvs: pack(uv, owner, charts.length, margin) };
};

/** For each triangle the triangles it shares an edge with. */
const neighbours = (mesh: Mesh): number[][] => {
  const count = vertexCount(mesh);
  const edges = new Map<number, number>();
  const next = (i: number): number => mesh.indices[i - (i % 3) + ((i + 1) % 3)]!;
  mesh.indices.forEach((a, i) => edges.set(a * count + next(i), Math.floor(i / 3)));
  const out: number[][] = Array.from({ length: triangleCount(mesh) }, () => []);
  mesh.indices.forEach((a, i) => {
    const twin = edges.get(next(i) * count + a);
    if (twin !== undefined) out[Math.floor(i / 3)]!.push(twin);
  });
  return out;
};

/** Moves charts side by side into 0..1 on shelves, tallest first, all scaled alike and as large as they fit; turns v downwards. */
const pack = (uv: Uv[], owner: Int32Array, charts: number, margin: number): Float32Array => {
  const boxes = Array.from({ length: charts }, () => ({ low: [Infinity, Infinity], high: [-Infinity, -Infinity] }));
  uv.forEach((p, v) => {
    const box = boxes[owner[v]!]!;
    for (const k of [0, 1] as const) {
      box.low[k] = Math.min(box.low[k]!, p[k]);
      box.high[k] = Math.max(box.high[k]!, p[k]);
    }
  });
  const sizes = boxes.map((b) => [b.high[0]! - b.low[0]!, b.high[1]! - b.low[1]!] as const);
  const order = sizes.map((_, i) => i).sort((a, b) => sizes[b]![1] - sizes[a]![1] || a - b);
  const place = (s: number): Uv[] | undefined => {
    const at: Uv[] = [];
    let [x, y, shelf] = [margin, margin, 0];
    for (const i of order) {
      const [w, h] = [sizes[i]![0] * s, sizes[i]![1] * s];
      if (x + w + margin > 1) [x, y, shelf] = [margin, y + shelf + margin, 0];
      if (x + w + margin > 1 || y + h + margin > 1) return undefined;
      at[i] = [x, y];
      x += w + margin;
      shelf = Math.max(shelf, h);
    }
    return at;
  };
  let low = 0;
  let high = 1 / Math.max(...sizes.flat());
  for (let i = 0; i < 30; i++) {
    const middle = (low + high) / 2;
    if (place(middle)) low = middle;
    else high = middle;
  }
  const at = place(low)!;
  return Float32Array.from(
    uv.flatMap((p, v) => {
      const i = owner[v]!;
      return [at[i]![0] + (p[0] - boxes[i]!.low[0]!) * low, 1 - (at[i]![1] + (p[1] - boxes[i]!.low[1]!) * low)];
    }),
  );
};

const kRelaxRounds = 60;

/**
 * Unwraps a mesh with holes into one chart: cut open along the edges that `seam` names, laid out on a disc without overlaps
 * (Tutte 1963), then relaxed towards its true shape. +x of the model points to the right of the image.
 *
 * Relaxing fits a rotation to each triangle and solves for the layout that follows them best (Liu et al. 2008), triangles
 * that are squeezed counting more (after Rabinovich et al. 2017, Scalable Locally Injective Mappings), each step only as far
 * as it lowers the distortion, no triangle turns over and no border crosses itself.
 * @param seam  Says of an edge's two ends whether it is cut. Cut open, the mesh must be a disc with holes.
 * @param zoom  How large a place shall be drawn: regions where much is painted deserve more of the texture.
 * @param polished  Whether to go on until nothing is gained.
 */
export const pelt = (
  mesh: Mesh,
  seam: (a: Vec3, b: Vec3) => boolean,
  zoom: (p: Vec3) => number = () => 1,
  polished = false,
): Mesh => {
  const { mesh: cut } = splitAlong(mesh, (a, b) => !seam(point(mesh, a), point(mesh, b)));
  const { filled, flat } = flatten(cut, zoom, polished);
  const uvs = upright(filled, flat, [1, 0, 0], 0).slice(0, vertexCount(cut));
  return { ...cut, uvs: pack(uvs, new Int32Array(uvs.length), 1, 0.01) };
};

/** Lays a disc with holes out flat, in the lengths of the model times `zoom`; its holes are filled. */
const flatten = (cut: Mesh, zoom: (p: Vec3) => number, polished: boolean): { filled: Mesh; flat: Flat } => {
  const loops = borderLoops(cut);
  loops.sort((a, b) => perimeter(cut, b) - perimeter(cut, a));
  if (loops.length === 0) throw new Error('pelt: the mesh is closed; it needs a seam or a hole');
  const [outer, ...holes] = loops as [number[], ...number[][]];
  const filled = fill(cut, holes);
  const relaxed = relax(filled, outer, onDisc(filled, outer), zoom);
  return { filled, flat: polished ? polish(filled, outer, relaxed, zoom) : relaxed };
};

/** Closes holes with fans about their middles, so that they keep their shape and nothing is laid over them. */
export const fill = (mesh: Mesh, holes: number[][]): Mesh => {
  const positions = Array.from(mesh.positions);
  const indices = Array.from(mesh.indices);
  for (const loop of holes) {
    const hub = positions.length / 3;
    positions.push(
      ...scale(
        loop.map((v) => point(mesh, v)).reduce((a, b) => add(a, b)),
        1 / loop.length,
      ),
    );
    loop.forEach((v, i) => indices.push(v, hub, loop[(i + 1) % loop.length]!));
  }
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
};

/** The border on a circle, everything else at the mean of its neighbours. */
const onDisc = (mesh: Mesh, outer: number[]): Flat => {
  const total = vertexCount(mesh);
  const links = Array.from({ length: total }, () => new Set<number>());
  const link = (a: number, b: number): void => {
    links[a]!.add(b);
    links[b]!.add(a);
  };
  for (let t = 0; t < triangleCount(mesh); t++) {
    const [a, b, c] = corners(mesh, t);
    link(a, b);
    link(b, c);
    link(c, a);
  }
  const lengths = outer.map((v, i) => length(sub(point(mesh, v), point(mesh, outer[(i + 1) % outer.length]!))));
  const round = lengths.reduce((a, b) => a + b, 0);
  const fixed = new Map<number, Uv>();
  let walked = 0;
  outer.forEach((v, i) => {
    const angle = (2 * Math.PI * walked) / round;
    fixed.set(v, [Math.cos(angle), Math.sin(angle)]);
    walked += lengths[i]!;
  });
  const matrix = new Float64Array(total * total);
  const sums = [new Float64Array(total), new Float64Array(total)] as const;
  links.forEach((around, v) => {
    const own = fixed.get(v);
    matrix[v * total + v] = own ? 1 : around.size;
    if (own) for (const k of [0, 1] as const) sums[k][v] = own[k];
    else
      for (const n of around) {
        const p = fixed.get(n);
        if (!p) matrix[v * total + n] = -1;
        else for (const k of [0, 1] as const) sums[k][v]! += p[k];
      }
  });
  const solve = cholesky(matrix, total);
  return [solve(sums[0]), solve(sums[1])];
};

const relax = (mesh: Mesh, outer: number[], start: Flat, zoom: (p: Vec3) => number): Flat => {
  const count = vertexCount(mesh);
  const { triangles, shapes: rest, areas } = restOf(mesh, zoom);
  const cotangents = rest.map((p) => p.map((a, k) => cotangent(p[(k + 2) % 3]!, a, p[(k + 1) % 3]!)));
  const at = (flat: Flat, v: number): Uv => [flat[0][v]!, flat[1][v]!];
  const layout = (flat: Flat, t: number): [Uv, Uv, Uv] => triangles[t]!.map((v) => at(flat, v)) as [Uv, Uv, Uv];

  /** The two stretches of a triangle, the larger first; the second is not positive if it lies on its face. */
  const stretches = (flat: Flat, t: number): Uv => {
    const [p, q] = [rest[t]!, layout(flat, t)];
    const x = p[1][0];
    const y = p[2][1];
    const a = (q[1][0] - q[0][0]) / x;
    const c = (q[1][1] - q[0][1]) / x;
    const b = (q[2][0] - q[0][0] - a * p[2][0]) / y;
    const d = (q[2][1] - q[0][1] - c * p[2][0]) / y;
    const sum = Math.hypot(a + d, c - b);
    const difference = Math.hypot(a - d, c + b);
    return [(sum + difference) / 2, (sum - difference) / 2];
  };
  const distortion = (flat: Flat): number => {
    let total = 0;
    for (let t = 0; t < triangles.length; t++) {
      const [s1, s2] = stretches(flat, t);
      if (s2 <= 0) return Infinity;
      total += areas[t]! * (s1 * s1 + s2 * s2 + 1 / (s1 * s1) + 1 / (s2 * s2));
    }
    return isSimple(outer.map((v) => at(flat, v))) ? total : Infinity;
  };

  const covered = triangles.reduce((s, _, t) => s + area(...layout(start, t)) / 2, 0);
  const grow = Math.sqrt(areas.reduce((a, b) => a + b, 0) / covered);
  let flat: Flat = [start[0].map((x) => x * grow), start[1].map((x) => x * grow)];
  let least = distortion(flat);
  for (let round = 0; round < kRelaxRounds; round++) {
    const matrix = new Float64Array(count * count);
    const sums = [new Float64Array(count), new Float64Array(count)] as const;
    triangles.forEach((t, i) => {
      const squeeze = stretches(flat, i)[1];
      const weight = ((squeeze + 1) * (squeeze * squeeze + 1)) / squeeze ** 3;
      const [p, q] = [rest[i]!, layout(flat, i)];
      let [c, s] = [0, 0];
      for (let k = 0; k < 3; k++) {
        const [ex, ey] = [p[(k + 1) % 3]![0] - p[k]![0], p[(k + 1) % 3]![1] - p[k]![1]];
        const [dx, dy] = [q[(k + 1) % 3]![0] - q[k]![0], q[(k + 1) % 3]![1] - q[k]![1]];
        c += cotangents[i]![k]! * (ex * dx + ey * dy);
        s += cotangents[i]![k]! * (ex * dy - ey * dx);
      }
      const norm = Math.hypot(c, s);
      c /= norm;
      s /= norm;
      for (let k = 0; k < 3; k++) {
        const [a, b, w] = [t[k]!, t[(k + 1) % 3]!, weight * cotangents[i]![k]!];
        const [ex, ey] = [p[(k + 1) % 3]![0] - p[k]![0], p[(k + 1) % 3]![1] - p[k]![1]];
        matrix[a * count + a]! += w;
        matrix[b * count + b]! += w;
        matrix[a * count + b]! -= w;
        matrix[b * count + a]! -= w;
        const turned = [w * (c * ex - s * ey), w * (s * ex + c * ey)] as const;
        for (const n of [0, 1] as const) {
          sums[n][b]! += turned[n];
          sums[n][a]! -= turned[n];
        }
      }
    });
    // One vertex is held, for the layout may slide as a whole.
    matrix[0]! += 1;
    for (const k of [0, 1] as const) sums[k][0]! += flat[k][0]!;
    const solve = cholesky(matrix, count);
    const goal = [solve(sums[0]), solve(sums[1])] as const;
    let step = 1;
    let better: Flat | undefined;
    while (step > 1e-3 && !better) {
      const tried: Flat = [
        flat[0].map((x, v) => x + step * (goal[0][v]! - x)),
        flat[1].map((x, v) => x + step * (goal[1][v]! - x)),
      ];
      const d = distortion(tried);
      if (d < least) [better, least] = [tried, d];
      else step /= 2;
    }
    if (!better) break;
    flat = better;
  }
  return flat;
};

/** Turns a layout so that `direction` of the model points along axis 0 (to the right) or 1 (upwards). */
const upright = (mesh: Mesh, flat: Flat, direction: Vec3, axis: 0 | 1): Uv[] => {
  const count = vertexCount(mesh);
  const mean = flat.map((a) => a.reduce((s, x) => s + x, 0) / count) as [number, number];
  let [c, s] = [0, 0];
  for (let v = 0; v < count; v++) {
    const along = dot(point(mesh, v), direction);
    c += along * (flat[0][v]! - mean[0]);
    s += along * (flat[1][v]! - mean[1]);
  }
  const norm = Math.hypot(c, s) || 1;
  return Array.from({ length: count }, (_, v): Uv => {
    const [x, y] = [flat[0][v]!, flat[1][v]!];
    const [ahead, across] = [(c * x + s * y) / norm, (c * y - s * x) / norm];
    return axis === 0 ? [ahead, across] : [-across, ahead];
  });
};

/** Where a chart of a symmetric mesh goes: those of the middle are stacked in the middle, the left ones at a side. */
export interface Place {
  near: Vec3; // the middle of the chart's triangles is about here; left is +x
  up: Vec3; // this direction of the model points upwards
}

/**
 * Lays out the connected pieces of a mesh that `mirror` made of two halves, so that the layout is its own mirror image.
 * @param places  Of the pieces in the middle and of the left ones, from top to bottom.
 * @param zoom    How large a place shall be drawn.
 */
export const mirroredAtlas = (mesh: Mesh, places: readonly Place[], zoom: (p: Vec3) => number): Mesh => {
  const piece = components(mesh);
  const half = mesh.indices.length / 2;
  const twinOf = new Map<number, number>(); // of the left half's vertices
  for (let i = 0; i < half; i++) {
    const turned = i - (i % 3) + [0, 2, 1][i % 3]!;
    twinOf.set(mesh.indices[turned]!, mesh.indices[half + i]!);
  }
  const left = [...new Set(Array.from(mesh.indices.subarray(0, half), (v) => piece[v]!))];
  const charts = left.map((id) => {
    const indices = mesh.indices.filter((_, i) => piece[mesh.indices[i - (i % 3)]!] === id);
    const vertices = [...new Set(indices)].sort((a, b) => a - b);
    const own = new Map(vertices.map((v, i) => [v, i]));
    const part: Mesh = {
      positions: Float32Array.from(vertices.flatMap((v) => point(mesh, v))),
      indices: indices.map((v) => own.get(v)!),
    };
    const centre = scale(
      vertices.map((v) => point(mesh, v)).reduce((a, b) => add(a, b)),
      1 / vertices.length,
    );
    return { vertices, own, part, centre, whole: [...twinOf].some(([a, b]) => a !== b && own.has(a) && own.has(b)) };
  });
  if (charts.length !== places.length)
    throw new Error(
      `mirroredAtlas: ${places.length} places for ${charts.length} charts, about ${charts.map(({ centre, vertices }) => `${centre.map((x) => x.toFixed(2))} (${vertices.length})`).join(', ')}`,
    );
  const columns: { chart: (typeof charts)[number]; uv: Uv[]; size: Uv }[][] = [[], []];
  for (const { near, up } of places) {
    const chart = charts.reduce((a, b) => (length(sub(b.centre, near)) < length(sub(a.centre, near)) ? b : a));
    const { filled, flat } = flatten(chart.part, zoom, true);
    const uv = upright(filled, flat, up, 1).slice(0, chart.vertices.length);
    if (chart.whole)
      symmetrise(
        uv,
        chart.vertices.map((v) => chart.own.get(twinOf.get(v) ?? -1)),
      );
    const low = [0, 1].map((k) => Math.min(...uv.map((p) => p[k]!))) as [number, number];
    const high = [0, 1].map((k) => Math.max(...uv.map((p) => p[k]!))) as [number, number];
    columns[chart.whole ? 0 : 1]!.push({
      chart,
      uv: uv.map((p) => [p[0] - low[0], high[1] - p[1]]), // v of an image points downwards
      size: [high[0] - low[0], high[1] - low[1]],
    });
  }
  const [middle, side] = columns.map((c) => Math.max(0, ...c.map(({ size }) => size[0]))) as [number, number];
  const tall = columns.map((c) => c.reduce((sum, { size }) => sum + size[1], 0));
  const fits = [
    (1 - 4 * kGutter) / (middle + 2 * side),
    ...tall.map((t, i) => (1 - (columns[i]!.length + 1) * kGutter) / t),
  ];
  const s = Math.min(...fits);
  const uvs = new Float32Array(2 * vertexCount(mesh));
  columns.forEach((column, i) => {
    let y = kGutter;
    for (const { chart, uv, size } of column) {
      const x = i === 0 ? 0.5 - (s * size[0]) / 2 : 0.5 + (s * middle) / 2 + kGutter;
      uv.forEach(([a, b], n) => {
        const v = chart.vertices[n]!;
        uvs.set([x + s * a, y + s * b], 2 * v);
        const twin = twinOf.get(v);
        if (!chart.whole && twin !== undefined) uvs.set([1 - (x + s * a), y + s * b], 2 * twin);
      });
      y += s * size[1] + kGutter;
    }
  });
  return { ...mesh, uvs };
};

const kGutter = 0.01; // around each chart, in UV

/** Makes a layout its own mirror image, about the middle of its vertices. */
const symmetrise = (uv: Uv[], twins: readonly (number | undefined)[]): void => {
  const middle = uv.reduce((s, p) => s + p[0], 0) / uv.length;
  twins.forEach((w, v) => {
    if (w === undefined) return;
    const [a, b] = [uv[v]!, uv[w]!];
    const u = v === w ? 0 : (a[0] - b[0]) / 2;
    const height = (a[1] + b[1]) / 2;
    uv[v] = [middle + u, height];
    uv[w] = [middle - u, height];
  });
};

/** The open edges of a mesh as closed loops of vertices, in the direction of their triangles. */
export const borderLoops = (mesh: Mesh): number[][] => {
  const next = new Map(openEdges(mesh));
  const loops: number[][] = [];
  while (next.size > 0) {
    const loop: number[] = [];
    let v = next.keys().next().value!;
    while (next.has(v)) {
      loop.push(v);
      const to = next.get(v)!;
      next.delete(v);
      v = to;
    }
    loops.push(loop);
  }
  return loops;
};

/** The length of a border loop. */
export const perimeter = (mesh: Mesh, loop: number[]): number =>
  loop.reduce((s, v, i) => s + length(sub(point(mesh, v), point(mesh, loop[(i + 1) % loop.length]!))), 0);

/** The share of the covered UV area that more than one triangle covers, found on a grid of `size` × `size`. */
export const uvOverlap = (mesh: Mesh, size = 1024): number => {
  const hits = new Uint8Array(size * size);
  for (let t = 0; t < triangleCount(mesh); t++) {
    let [a, b, c] = corners(mesh, t).map((v): Uv => [mesh.uvs![2 * v]! * size, mesh.uvs![2 * v + 1]! * size]) as [
      Uv,
      Uv,
      Uv,
    ];
    if (area(a, b, c) < 0) [b, c] = [c, b];
    for (let j = Math.floor(Math.min(a[1], b[1], c[1])); j < Math.max(a[1], b[1], c[1]); j++)
      for (let i = Math.floor(Math.min(a[0], b[0], c[0])); i < Math.max(a[0], b[0], c[0]); i++) {
        const p: Uv = [i + 0.5, j + 0.5];
        if (area(a, b, p) > 0 && area(b, c, p) > 0 && area(c, a, p) > 0) hits[j * size + i]!++;
      }
  }
  const covered = hits.reduce((n, h) => n + (h > 0 ? 1 : 0), 0);
  return covered === 0 ? 0 : hits.reduce((n, h) => n + (h > 1 ? 1 : 0), 0) / covered;
};
