import { Triangle } from 'three';
import type { ExtractedMesh } from '../model';
import { cornersOf } from '../surface';
import type { Labels } from './labels';

/** How a way to transfer agrees with labels. */
export interface Score {
  /** Vertices that are painted and must not be. */
  wrong: number;
  /** The share of the area that must not be painted which is: 0..1. A third of each triangle goes to each corner. */
  wrongArea: number;
  /** The share of the area that is to be painted, where the cage speaks of it, which is not: 0..1. */
  bareArea: number;
}

/** Scores zones. @param zones 1 per vertex. @param areas As `vertexAreas`. */
export function scoreOf({ ncz, ignore, offCage }: Labels, areas: Float64Array, zones: Uint8Array): Score {
  let wrong = 0;
  /** Of skin and of what must not be painted: all, and the part that is painted. */
  const [all, painted] = [
    [0, 0],
    [0, 0],
  ];
  areas.forEach((area, vertex) => {
    const what = ncz[vertex]!;
    if (ignore[vertex] || (!what && offCage[vertex])) return;
    all[what]! += area;
    if (zones[vertex] !== 0) return;
    painted[what]! += area;
    wrong += what;
  });
  const share = (what: 0 | 1): number => (all[what]! > 0 ? painted[what]! / all[what]! : 1 - what);
  return { wrong, wrongArea: share(1), bareArea: 1 - share(0) };
}

/** 1 per vertex: a third of the triangles around it. */
export function vertexAreas(mesh: Pick<ExtractedMesh, 'positions' | 'indices'>): Float64Array {
  const areas = new Float64Array(mesh.positions.length / 3);
  for (let corner = 0; corner < mesh.indices.length; corner += 3) {
    const third = new Triangle(...cornersOf(mesh, corner / 3)).getArea() / 3;
    for (let i = corner; i < corner + 3; i++) areas[mesh.indices[i]!]! += third;
  }
  return areas;
}
