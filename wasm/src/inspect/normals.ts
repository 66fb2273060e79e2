import type { Mesh } from '../api/mesh.js';
import { type Finding, percent } from './finding.js';
import { cross, dot, minus, pointAt, type Vector } from './geometry.js';
import type { Scene } from './scene.js';
import { type Edge, middleOf, type Surface } from './surface.js';

/** A cage is unfit if more than this share of its area faces inward, because the paint is lost there. */
const kMaxInward = 0.1;
/**
 * A piece of a cage, its holes spanned, is a solid if its volume is at least this share of its area to the power of 1.5
 * (a ball has 0.094, a bowl 0.13 of its own area, a flat patch 0). For a flatter piece, the side of the target decides which side
 * is the inner one.
 */
const kMinVolume = 0.02;

/** A flat piece faces inward if the target's area on its outer side exceeds that on its inner side by this share of both, */
const kClearMajority = 0.5;
/** and if at least this share of the target's area is near it; with less, it might only be near a fold of the target. */
const kMinArea = 0.005;

/** Which triangles of the cage are turned inward. */
interface Orientation {
  /** 1 per triangle: 1 if it is wound clockwise, seen from outside. */
  inward: Uint8Array;
  /** Their share of the cage's area. */
  share: number;
}

/**
 * Finds the outer side of the cage regardless of how its triangles are wound: pieces are joined over edges of two triangles, and
 * the volume that a piece encloses, with its holes spanned, must be positive. Duplicate triangles are judged once.
 */
export function orientationOf(scene: Scene): Orientation {
  const { surface } = scene;
  const winding = new Int8Array(surface.areas.length); // 1 as the piece's first triangle is wound, -1 against it
  const pieceOf = new Int32Array(surface.areas.length).fill(-1);
  const pieces = windAlike(surface, winding, pieceOf);
  const targetSides = targetSidesOf(scene, pieceOf, pieces.length, winding);
  const borders = bordersOf(surface, pieceOf, pieces.length);
  const total = targetSides.totals.reduce((sum, area) => sum + area, 0);
  const inward = new Uint8Array(surface.areas.length);
  let area = 0;
  pieces.forEach((triangles, p) => {
    const pieceArea = triangles.reduce((sum, t) => sum + surface.areas[t]!, 0);
    const volume = volumeOf(surface, triangles, borders[p]!, { pieceOf, piece: p, winding });
    const outward =
      Math.abs(volume) >= kMinVolume * pieceArea ** 1.5
        ? volume > 0
        : targetSides.totals[p]! < kMinArea * total || targetSides.sums[p]! >= -kClearMajority * targetSides.totals[p]!;
    for (const t of triangles) {
      if ((winding[t] === 1) === outward) continue;
      inward[t] = 1;
      area += surface.areas[t]!;
    }
  });
  return { inward, share: surface.area > 0 ? Math.min(1, area / surface.area) : 0 };
}

/** Collects pieces of triangles joined by edges of two triangles, and finds which triangles of a piece are wound alike. */
function windAlike({ areas, doubled, edges }: Surface, winding: Int8Array, pieceOf: Int32Array): number[][] {
  const neighbours: { triangle: number; alike: boolean }[][] = Array.from(areas, () => []);
  for (const { uses } of edges) {
    if (uses.length !== 2) continue;
    const [one, other] = uses as [Edge['uses'][0], Edge['uses'][0]];
    const alike = one.forward !== other.forward; // neighbours with the same winding use their edge in opposite directions
    neighbours[one.triangle]!.push({ triangle: other.triangle, alike });
    neighbours[other.triangle]!.push({ triangle: one.triangle, alike });
  }
  const pieces: number[][] = [];
  for (let first = 0; first < areas.length; ++first) {
    if (pieceOf[first]! >= 0 || areas[first] === 0 || doubled[first] === 1) continue;
    winding[first] = 1;
    pieceOf[first] = pieces.length;
    const piece = [first];
    for (let i = 0; i < piece.length; ++i) {
      for (const { triangle, alike } of neighbours[piece[i]!]!) {
        if (pieceOf[triangle]! >= 0) continue;
        pieceOf[triangle] = pieces.length;
        winding[triangle] = (alike ? 1 : -1) * winding[piece[i]!]!;
        piece.push(triangle);
      }
    }
    pieces.push(piece);
  }
  return pieces;
}

/** The edges at which each piece ends. */
function bordersOf({ edges }: Surface, pieceOf: Int32Array, pieces: number): Edge[][] {
  const borders: Edge[][] = Array.from({ length: pieces }, () => []);
  for (const edge of edges) {
    if (edge.uses.length === 2) continue;
    for (const piece of new Set(edge.uses.map(({ triangle }) => pieceOf[triangle]!)))
      if (piece >= 0) borders[piece]!.push(edge);
  }
  return borders;
}

/** The volume of a piece with its holes spanned, as its first triangle is wound. */
function volumeOf(
  { mesh }: Surface,
  triangles: readonly number[],
  border: readonly Edge[],
  { pieceOf, piece, winding }: { pieceOf: Int32Array; piece: number; winding: Int8Array },
): number {
  const { positions, indices } = mesh;
  const origin = pointAt(positions, indices[3 * triangles[0]!]!);
  const at = (v: number) => minus(pointAt(positions, v), origin);
  const tetrahedron = (a: Vector, b: Vector, c: Vector) => dot(a, cross(b, c)) / 6;
  let volume = 0;
  for (const t of triangles)
    volume += winding[t]! * tetrahedron(at(indices[3 * t]!), at(indices[3 * t + 1]!), at(indices[3 * t + 2]!));
  // Its borders, by connection: each is spanned from its middle.
  const atPlace = new Map<number, Edge[]>();
  for (const edge of border) {
    for (const end of [edge.a, edge.b]) {
      const there = atPlace.get(end);
      if (there) there.push(edge);
      else atPlace.set(end, [edge]);
    }
  }
  const seen = new Set<Edge>();
  for (const start of border) {
    if (seen.has(start)) continue;
    seen.add(start);
    const chain = [start];
    for (let i = 0; i < chain.length; ++i) {
      for (const end of [chain[i]!.a, chain[i]!.b]) {
        for (const next of atPlace.get(end)!) {
          if (seen.has(next)) continue;
          seen.add(next);
          chain.push(next);
        }
      }
    }
    const middle = minus(middleOf(positions, chain), origin);
    for (const { a, b, uses } of chain) {
      for (const { triangle, forward } of uses) {
        if (pieceOf[triangle] !== piece) continue;
        const [from, to] = forward === (winding[triangle] === 1) ? [b, a] : [a, b]; // against the triangle
        volume += tetrahedron(at(from), at(to), middle);
      }
    }
  }
  return volume;
}

/** For each piece, the target's area that lies on its inner side less that on its outer side, as its first triangle is wound. */
function targetSidesOf(
  { areas, sides, result }: Scene,
  pieceOf: Int32Array,
  pieces: number,
  winding: Int8Array,
): { sums: Float64Array; totals: Float64Array } {
  const [sums, totals] = [new Float64Array(pieces), new Float64Array(pieces)];
  for (let v = 0; v < areas.length; ++v) {
    const t = result.triangles[v]!;
    const piece = pieceOf[t]!;
    if (sides.loops[v]! >= 0 || piece < 0) continue;
    sums[piece]! -= areas[v]! * winding[t]! * Math.sign(sides.signed[v]!);
    totals[piece]! += areas[v]!;
  }
  return { sums, totals };
}

/** The cage with inward-facing triangles flipped. */
export function facingOutward(cage: Mesh, { inward }: Orientation): Mesh {
  const indices = cage.indices.slice();
  for (let t = 0; t < inward.length; ++t) {
    if (inward[t] === 1) indices.set([cage.indices[3 * t]!, cage.indices[3 * t + 2]!, cage.indices[3 * t + 1]!], 3 * t);
  }
  return { ...cage, indices };
}

/** Normals that point at the target instead of away from it. */
export function checkNormals({ inward, share }: Orientation): Finding[] {
  const triangles = inward.reduce((sum, one) => sum + one, 0);
  if (triangles === 0) return [];
  const all = share > 0.99;
  return [
    {
      code: 'normalsInward',
      // Heavier than all findings that follow from it.
      weight: share > kMaxInward ? 20 * share + 1 : Math.max(share / kMaxInward, 0.25),
      sentence: all
        ? 'The cage is inside out: all its triangles face inward'
        : `${percent(share)} of the cage's area (${triangles} of its triangles) faces inward`,
      advice:
        'Flip these triangles ("recalculate normals outside"): seen from outside, a cage must be wound counter-clockwise. The other findings assume that they are flipped.',
      numbers: { share, triangles },
    },
  ];
}
