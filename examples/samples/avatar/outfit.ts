// What the figure has on: pieces of its skin, moved outwards, so that they bend as it does.

import { inHead, kEye, kEyeRadius, kLook, lidEdge, onHead } from './face';
import {
  add,
  border,
  clip,
  dot,
  join,
  length,
  linear,
  type Mesh,
  mix,
  normalsOf,
  scale,
  smoothed,
  smoothstep,
  sub,
  type Vec3,
  type Vertex,
} from './mesh';
import { armSide, kElbow } from './skeleton';

const folded = ([x, y, z]: Vec3): Vec3 => [Math.abs(x), y, z];
type Field = (p: Vec3) => number;

const kShoulder: Vec3 = [0.17, 1.365, -0.02];
const alongArm = (p: Vec3): number => {
  const arm = sub(kElbow, kShoulder);
  return dot(sub(p, kShoulder), arm) / dot(arm, arm);
};
/** Positive where the shirt is: from the collar to below the waist, with sleeves to above the elbows. */
export const shirt: Field = (point) => {
  const p = folded(point);
  const sleeve = 0.27 * (0.72 - alongArm(p));
  const collar = 1.402 - p[1] + 0.32 * Math.max(p[0] - 0.055, 0) - 0.55 * p[2];
  return Math.min(armSide(p) > -0.03 || p[0] > 0.2 ? sleeve : 1, collar, p[1] - 0.9);
};
/** Positive where the trousers are: from the waist to above the ankles. */
export const trousers: Field = (point) => {
  const [x, y] = folded(point);
  return Math.min(0.965 - y, y - 0.135, 0.32 - x);
};
/** Positive where the shoes are. */
export const shoes: Field = ([, y, z]) => Math.min(Math.max(0.082 - y, z - 0.04), 0.14 - y);

interface Cloth {
  field: Field;
  color: string;
  /** Metres above the skin, at a height. */
  above(p: Vec3): number;
  /** Rounds of smoothing, which hides what is below. */
  rounds: number;
}
export const clothes: Record<string, Cloth> = {
  shirt: { field: shirt, color: '#e9e6df', above: (p) => 0.009 + 0.007 * smoothstep(1.15, 0.95, p[1]), rounds: 12 },
  trousers: { field: trousers, color: '#3d4a63', above: (p) => 0.006 + 0.009 * smoothstep(0.8, 0.2, p[1]), rounds: 14 },
  shoes: { field: shoes, color: '#b4533c', above: () => 0.008, rounds: 26 },
};
const kThick = 0.004;
const kSole = 0.009; // height of its upper edge

/** A piece of the skin that is moved outwards, with its borders turned in. */
function layer(skin: Mesh, field: Field, above: (p: Vec3) => number, rounds: number): Mesh {
  const piece = clip(skin, field);
  const skinAt = piece.vertices.map(({ at }) => at);
  const normals = normalsOf(piece, skinAt);
  let at = skinAt.map((p, v) => add(p, scale(normals[v]!, above(p))));
  at = smoothed(piece, at, rounds, () => 1);
  // Smoothing sinks what bulges: it stays above the skin.
  for (let round = 0; round < 3; round++) {
    at = at.map((p, v) => {
      const up = dot(sub(p, skinAt[v]!), normals[v]!);
      return add(p, scale(normals[v]!, Math.max(0, 0.6 * above(skinAt[v]!) - up)));
    });
    at = smoothed(piece, at, 1, () => 0.6);
  }
  const vertices = piece.vertices.map((vertex, v): Vertex => ({ ...vertex, at: at[v]! }));
  return turnedIn({ ...piece, vertices }, skinAt);
}

/** With a rim at the borders, down to near the skin. */
function turnedIn(mesh: Mesh, skinAt: readonly Vec3[]): Mesh {
  const edges = border(mesh);
  // The edge has vertices of its own, as its normal is another.
  const outer = new Map<number, number>();
  const vertices = [...mesh.vertices];
  for (const v of edges.keys()) {
    outer.set(v, vertices.length);
    const vertex = mesh.vertices[v]!;
    const down = sub(skinAt[v]!, vertex.at);
    const far = length(down);
    vertices.push(vertex, {
      ...vertex,
      at: add(vertex.at, scale(down, Math.min(1, Math.max(kThick, far - 0.001) / far))),
    });
  }
  const rim = [...edges].flatMap(([a, b]): Mesh['triangles'] => [
    [outer.get(b)!, outer.get(a)!, outer.get(a)! + 1],
    [outer.get(b)!, outer.get(a)! + 1, outer.get(b)! + 1],
  ]);
  return { vertices, triangles: [...mesh.triangles, ...rim] };
}

export const dressed = (skin: Mesh, name: string): Mesh => {
  const { field, above, rounds } = clothes[name]!;
  const mesh = layer(skin, field, above, rounds);
  if (name !== 'shoes') return mesh;
  // A sole: flat, and lighter.
  const colored = (half: Mesh, color: string): Mesh => ({
    ...half,
    vertices: half.vertices.map((vertex) => {
      const [x, y, z] = vertex.at;
      return { ...vertex, at: [x, Math.max(y, -0.006), z], color: linear(color) };
    }),
  });
  return join(
    colored(
      clip(mesh, ([, y]) => y - kSole),
      clothes['shoes']!.color,
    ),
    colored(
      clip(mesh, ([, y]) => kSole - y),
      '#e8e4dc',
    ),
  );
};

/** Skin that no gap between clothes shows: all but what is well below them. */
export const isSeen: Field = (p) => 0.025 - Math.max(shirt(p), trousers(p), 6 * shoes(p));

// ---- hair, brows and lashes ----

/** Piecewise linear: the value at `x` of the graph through `points`, which ascend. */
const graph = (points: readonly (readonly [number, number])[], x: number): number => {
  const at = points.findIndex(([from]) => from > x);
  const i = at < 0 ? points.length - 1 : Math.max(at, 1);
  const [a, b] = [points[i - 1]!, points[i]!];
  return a[1] + Math.min(1, Math.max(0, (x - a[0]) / (b[0] - a[0]))) * (b[1] - a[1]);
};
const kFront = [
  [-0.1, 0.06],
  [0, 0.09],
  [0.06, 0.115],
  [0.11, 0.09],
  [0.2, 0.125],
  [0.245, 0.2],
  [0.285, 0.28],
  [0.42, 0.3],
] as const;
const kUnder = [
  [-0.4, -0.2],
  [-0.3, -0.22],
  [-0.15, -0.14],
  [-0.06, 0.09],
  [0.03, 0.02],
  [0.1, -0.07],
] as const;
/** Positive where hair grows, in units of the head. */
const hairline: Field = (point) => {
  const p = folded(point);
  const away = Math.hypot((p[1] + 0.04) / 1.25, p[2] + 0.05) - 0.125; // from the ears
  return Math.min(graph(kFront, p[1]) - p[2], p[1] - graph(kUnder, p[2]), p[0] > 0.27 ? away : 1);
};

/** Short hair, fuller above and in front. */
export function hairOf(head: Mesh): Mesh {
  const thick = (at: Vec3): number => {
    const p = inHead(at);
    const full = smoothstep(-0.1, 0.35, p[1]) * smoothstep(0, 0.1, hairline(p));
    const strands = 0.0022 * Math.sin(48 * Math.atan2(p[0], 0.35 - p[2]) + 9 * Math.sin(5 * p[1])) * full;
    return 0.004 + 0.022 * full + strands;
  };
  const mesh = layer(
    clip(head, (p) => inHead(p)[1] + 0.35),
    (p) => hairline(inHead(p)) * 0.228,
    thick,
    2,
  );
  const [dark, light] = [linear('#2c1d15'), linear('#6b4a33')];
  return {
    ...mesh,
    vertices: mesh.vertices.map((vertex) => {
      const p = inHead(vertex.at);
      const streak = 0.5 + 0.5 * Math.sin(95 * Math.atan2(p[0], 0.35 - p[2]) + 7 * Math.sin(6 * p[1]));
      return { ...vertex, color: mix(dark, light, 0.25 + 0.35 * streak) };
    }),
  };
}

/** A strip between two lines of as many points; its back is not seen. */
function strip(lines: readonly (readonly Vec3[])[], color: Vec3): Mesh {
  const columns = lines[0]!.length;
  const vertices = lines.flat().map((p): Vertex => ({ at: onHead(p), base: onHead(p), color, weights: [] }));
  const triangles = lines.slice(1).flatMap((_, row) =>
    Array.from({ length: columns - 1 }, (_, i) => row * columns + i).flatMap((v): Mesh['triangles'] => [
      [v, v + columns, v + 1],
      [v + 1, v + columns, v + columns + 1],
    ]),
  );
  return { vertices, triangles };
}
const steps = (count: number): number[] => Array.from({ length: count + 1 }, (_, i) => i / count);

/** The left brow. @param surface  The foremost z of the skin at x and y, in units of the head. */
export function browOf(surface: (x: number, y: number) => number): Mesh {
  const lines = [-1, -0.4, 0.4, 1].map((row) =>
    steps(14).map((t): Vec3 => {
      const middle = 0.072 + 0.034 * Math.sin(Math.PI * (0.08 + 0.72 * t));
      const half = 0.0165 * (1 - 0.75 * t * t) * (0.35 + 0.65 * smoothstep(0, 0.15, t));
      const [x, y] = [0.05 + 0.175 * t, middle + row * half];
      return [x, y, surface(x, y) + (Math.abs(row) === 1 ? 0.0015 : 0.009)];
    }),
  );
  return strip(lines.reverse(), linear('#2f2018'));
}

/** The lashes of the left upper lid. */
export function lashesOf(): Mesh {
  const across = steps(12).map((t) => -0.058 + 0.118 * t);
  const lines = [0.0715, 0.081].map((far) => across.map((u) => lidEdge(u, far)));
  const tips = across.map((u): Vec3 => {
    const [x, y, z] = lidEdge(u, 0.087 + 0.012 * smoothstep(-0.04, 0.05, u));
    return [x, y + 0.008, z];
  });
  return strip([tips, lines[1]!, lines[0]!], linear('#1d120d'));
}

/** The left eye, its colours in rings whose borders are sharp. */
export function eyeOf(): Mesh {
  const [white, rim, iris, inner, pupil] = ['#efe9e2', '#16262c', '#3f7688', '#8fb7c4', '#070505'].map(linear) as [
    Vec3,
    Vec3,
    Vec3,
    Vec3,
    Vec3,
  ];
  const rings: [angle: number, color: Vec3][] = [
    [0.19, pupil],
    [0.2, inner],
    [0.34, iris],
    [0.44, iris],
    [0.47, rim],
    [0.49, white],
    [0.75, white],
    [1.1, linear('#e6cfc6')],
    [1.6, linear('#d99a8c')],
    [2.3, linear('#d99a8c')],
  ];
  const sides = 24;
  const [right, up, front] = kLook;
  const put = (angle: number, turn: number, color: Vec3): Vertex => {
    const bulge = 1 + 0.035 * Math.max(0, 1 - (angle / 0.6) ** 2);
    const [a, b, c] = [Math.sin(angle) * Math.cos(turn), Math.sin(angle) * Math.sin(turn), Math.cos(angle)];
    const way = add(scale(right, a), add(scale(up, b), scale(front, c)));
    const at = onHead(add(kEye, scale(way, kEyeRadius * bulge)));
    return { at, base: at, color, weights: [] };
  };
  const vertices = [put(0, 0, pupil)];
  for (const [angle, color] of rings)
    for (let j = 0; j < sides; j++) vertices.push(put(angle, (2 * Math.PI * j) / sides, color));
  const place = (ring: number, j: number): number => 1 + ring * sides + (j % sides);
  const triangles = rings.flatMap((_, i) =>
    Array.from({ length: sides }, (_, j) => j).flatMap((j): Mesh['triangles'] =>
      i === 0
        ? [[0, place(0, j), place(0, j + 1)]]
        : [
            [place(i - 1, j), place(i, j), place(i - 1, j + 1)],
            [place(i - 1, j + 1), place(i, j), place(i, j + 1)],
          ],
    ),
  );
  return { vertices, triangles };
}
