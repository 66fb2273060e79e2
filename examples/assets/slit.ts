import { corners, type Mesh, openEdges, point, triangleCount, vertexCount } from './mesh.ts';
import { splitAlong } from './unwrap.ts';
import { add, mix, scale, type Vec3 } from './vec.ts';

/** A seam: where `field` is zero, as far as `within` says so of a point. */
export interface Slit {
  field: (p: Vec3) => number;
  within: (p: Vec3) => boolean;
}

const kSnap = 0.15; // of an edge: a seam so near to a corner goes through the corner

/** Splits triangles so that no edge crosses the seam, and moves corners next to it onto it. Borders stay where they are. */
const score = (mesh: Mesh, { field, within }: Slit, fixed: Set<number>): Mesh => {
  const count = vertexCount(mesh);
  const positions = Array.from(mesh.positions);
  const value = Array.from({ length: count }, (_, v) => field(point(mesh, v)));
  const near: number[] = Array.from({ length: count }, () => kSnap);
  const target: (Vec3 | undefined)[] = Array.from({ length: count });
  const crossing = (a: number, b: number): { share: number; at: Vec3 } | undefined => {
    if (value[a]! < 0 === value[b]! < 0) return undefined;
    const share = value[a]! / (value[a]! - value[b]!);
    const at = mix(point(mesh, a), point(mesh, b), share);
    return within(at) ? { share, at } : undefined;
  };
  for (let t = 0; t < triangleCount(mesh); t++) {
    const c = corners(mesh, t);
    for (let k = 0; k < 3; k++) {
      const [a, b] = [c[k]!, c[(k + 1) % 3]!];
      const cut = crossing(a, b);
      if (!cut) continue;
      for (const [v, share] of [
        [a, cut.share],
        [b, 1 - cut.share],
      ] as const)
        if (share < near[v]!) [near[v], target[v]] = [share, cut.at];
    }
  }
  const online = target.map((at) => at !== undefined);
  target.forEach((at, v) => {
    if (at && !fixed.has(v)) at.forEach((x, k) => (positions[3 * v + k] = x));
    if (at) fixed.add(v);
  });
  const cuts = new Map<number, number>();
  const cutOf = (a: number, b: number): number | undefined => {
    if (online[a] || online[b]) return undefined;
    const key = Math.min(a, b) * count + Math.max(a, b);
    if (cuts.has(key)) return cuts.get(key);
    const cut = crossing(Math.min(a, b), Math.max(a, b));
    if (!cut) return undefined;
    const v = positions.length / 3;
    positions.push(...cut.at);
    cuts.set(key, v);
    fixed.add(v);
    return v;
  };
  const indices: number[] = [];
  for (let t = 0; t < triangleCount(mesh); t++) {
    const c = corners(mesh, t);
    const middle = c.map((a, k) => cutOf(a, c[(k + 1) % 3]!));
    const split = middle.filter((m) => m !== undefined).length;
    const first = split === 1 ? middle.findIndex((m) => m !== undefined) : middle.indexOf(undefined);
    const at = (k: number): number => c[(Math.max(first, 0) + k) % 3]!;
    const mid = (k: number): number => middle[(Math.max(first, 0) + k) % 3]!;
    if (split === 0) indices.push(...c);
    else if (split === 1) indices.push(at(0), mid(0), at(2), mid(0), at(1), at(2));
    else if (split === 2) indices.push(at(0), at(1), mid(1), at(0), mid(1), mid(2), mid(1), at(2), mid(2));
    else throw new Error('score: a field changes its sign three times about one triangle');
  }
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
};

/** Slits a mesh open along seams: each vertex on them gets a copy for each side. */
export const slit = (mesh: Mesh, seams: readonly Slit[]): Mesh => {
  const fixed = new Set(openEdges(mesh).flat());
  const scored = seams.reduce((m, seam) => score(m, seam, fixed), mesh);
  const middles = Array.from({ length: triangleCount(scored) }, (_, t) =>
    scale(
      corners(scored, t)
        .map((v) => point(scored, v))
        .reduce((a, b) => add(a, b)),
      1 / 3,
    ),
  );
  const sides = seams.map(({ field }) => middles.map((p) => field(p) < 0));
  return splitAlong(scored, (a, b, left, right) => {
    const p = mix(point(scored, a), point(scored, b), 0.5);
    return seams.every(({ within }, i) => sides[i]![left] === sides[i]![right] || !within(p));
  }).mesh;
};
