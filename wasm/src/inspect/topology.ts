import { counted, type Finding, percent } from './finding.js';
import { length, minus, pointAt, UnionFind } from './geometry.js';
import type { Scene } from './scene.js';
import { countSets, type Surface } from './surface.js';

/** Open edges closer together than this share of the diagonal are a crack: their vertices should be merged. */
const kCrackWidth = 1e-4;
/** A hole is a slit if its area is less than this share of its perimeter squared (a circle has 0.08), */
const kNarrow = 0.002;
/** or if its box has a diagonal of less than this share of the target's. */
const kTiny = 0.004;
/** A cage with more open edges than this is not searched for cracks, which would take too long. */
const kMaxOpenEdges = 20000;

/** What is wrong with a cage as a surface. */
export interface Topology {
  /** Triangles without area, which are ignored. */
  degenerateTriangles: number;
  /** Triangles with the same corners as an earlier one, in any order. */
  doubledTriangles: number;
  /** Edges of more than two triangles, not counting duplicate triangles. */
  nonManifoldEdges: number;
  /** Open edges so close to another one that the gap cannot be intended. */
  crackEdges: number;
  /** Holes that are too narrow or too small to be intended. */
  slits: number;
  /** Connected components, over edges. */
  pieces: number;
}

/** Examines a cage's triangles and edges; vertices at the same position count as one. */
export function topologyOf({ surface, diagonal }: Scene): Topology {
  const degenerateTriangles = surface.areas.reduce((sum, area) => sum + (area === 0 ? 1 : 0), 0);
  const nonManifoldEdges = surface.edges.filter(({ uses }) => uses.length > 2).length;
  const doubledTriangles = surface.doubled.reduce((sum, one) => sum + one, 0);
  return {
    degenerateTriangles,
    doubledTriangles,
    nonManifoldEdges,
    crackEdges: cracksIn(surface, kCrackWidth * diagonal),
    slits: slitsIn(surface, kTiny * diagonal),
    pieces: piecesOf(surface),
  };
}

function slitsIn({ loops }: Surface, least: number): number {
  return loops.filter(({ diagonal, area, perimeter }) => diagonal < least || area < kNarrow * perimeter ** 2).length;
}

function piecesOf(surface: Surface): number {
  const sets = new UnionFind(surface.areas.length);
  for (const { uses } of surface.edges) for (const { triangle } of uses) sets.join(triangle, uses[0]!.triangle);
  return countSets(surface, sets);
}

/** Counts open edges both ends of which lie within `width` of the ends of another. */
function cracksIn({ mesh, edges }: Surface, width: number): number {
  const open = edges.filter(({ uses }) => uses.length === 1);
  if (open.length > kMaxOpenEdges) return 0;
  const ends = [...new Set(open.flatMap(({ a, b }) => [a, b]))].sort(
    (v, w) => mesh.positions[3 * v]! - mesh.positions[3 * w]!,
  );
  // Each end gets the first of those beside it, swept along x.
  const twin = new Map<number, number>();
  ends.forEach((v, i) => {
    if (!twin.has(v)) twin.set(v, v);
    const p = pointAt(mesh.positions, v);
    for (let k = i + 1; k < ends.length && mesh.positions[3 * ends[k]!]! - p[0] <= width; ++k) {
      if (!twin.has(ends[k]!) && length(minus(pointAt(mesh.positions, ends[k]!), p)) <= width)
        twin.set(ends[k]!, twin.get(v)!);
    }
  });
  const counts = new Map<string, number>();
  const keys = open
    .map(({ a, b }) => [twin.get(a)!, twin.get(b)!].sort((v, w) => v - w))
    .map(([a, b]) => (a === b ? '' : `${a} ${b}`));
  for (const key of keys) counts.set(key, (counts.get(key) ?? 0) + 1);
  return keys.filter((key) => key !== '' && counts.get(key)! > 1).length;
}

/** Triangles without area, edges of three triangles, and gaps where vertices almost meet. */
export function checkTopology(
  { surface }: Scene,
  { degenerateTriangles, doubledTriangles, nonManifoldEdges, crackEdges, slits }: Topology,
): Finding[] {
  const findings: Finding[] = [];
  if (degenerateTriangles > 0) {
    findings.push({
      code: 'degenerateTriangles',
      weight: Math.min(0.9, (2 * degenerateTriangles) / surface.areas.length),
      sentence: `${counted(degenerateTriangles, 'triangle')} of the cage ${degenerateTriangles === 1 ? 'has' : 'have'} no area and ${degenerateTriangles === 1 ? 'is' : 'are'} ignored`,
      advice: 'Remove them ("degenerate dissolve").',
      numbers: { triangles: degenerateTriangles },
    });
  }
  if (doubledTriangles > 0) {
    findings.push({
      code: 'doubledTriangles',
      weight: Math.min(0.9, 0.25 + doubledTriangles / surface.areas.length),
      sentence: `${counted(doubledTriangles, 'triangle')} of the cage ${doubledTriangles === 1 ? 'is a duplicate' : 'are duplicates'}`,
      advice:
        'Remove duplicate triangles, including those that face the other way: a cage is a single layer around the target.',
      numbers: { triangles: doubledTriangles },
    });
  }
  if (nonManifoldEdges > 0) {
    findings.push({
      code: 'nonManifoldEdges',
      weight: Math.min(0.9, 0.25 + (2 * nonManifoldEdges) / surface.edges.length),
      sentence: `${counted(nonManifoldEdges, 'edge')} of the cage ${nonManifoldEdges === 1 ? 'belongs' : 'belong'} to more than two triangles`,
      advice: 'Remove inner faces: a cage is a single layer around the target.',
      numbers: { edges: nonManifoldEdges },
    });
  }
  if (crackEdges > 0 || slits > 0) {
    const share = crackEdges / surface.edges.length;
    const edges = `${counted(crackEdges, 'open edge')} ${crackEdges === 1 ? 'runs' : 'run'} along another one, less than ${percent(kCrackWidth)} of the diagonal away`;
    findings.push({
      code: 'cracks',
      weight: Math.min(0.9, 0.1 + 4 * share),
      sentence: `The cage has cracks through which rays pass: ${[crackEdges > 0 ? edges : '', slits > 0 ? `${counted(slits, 'hole')} ${slits === 1 ? 'is' : 'are'} too narrow or too small to be intended` : ''].filter(Boolean).join('; ')}`,
      advice:
        'Merge vertices by distance, and fill such holes. Vertices that are split for UVs must be in exactly the same place.',
      numbers: { edges: crackEdges, share, slits },
    });
  }
  return findings;
}
