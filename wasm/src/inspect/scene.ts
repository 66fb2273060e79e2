import { project, type TransferOptions, type TransferResult, Visibility } from '../api/index.js';
import type { Mesh } from '../api/mesh.js';
import { optionTable } from '../generated/options.js';
import { type Box, boxOf, dot, doubleAreaNormal, minus, nearestPoint, pointAt, vertexAreas } from './geometry.js';
import { type Surface, surfaceOf } from './surface.js';

/** A named range of a target's vertices. */
export interface PartName {
  name: string;
  firstVertex: number;
  vertexCount: number;
}

/** The input of all checks. */
export interface Scene {
  cage: Mesh;
  surface: Surface;
  target: Mesh;
  parts: readonly PartName[];
  /** 1 per target vertex: a third of the area of each of its triangles. */
  areas: Float64Array;
  targetBox: Box;
  /** The diagonal of the target's box; never 0. */
  diagonal: number;
  threshold: number;
  /** The result of the transfer. */
  result: TransferResult;
  sides: Sides;
  /** Whether a vertex is in the region that the cage covers, not beyond an outer border of it. */
  isInRegion(vertex: number): boolean;
}

/** On which side of the cage each target vertex lies. */
interface Sides {
  /** Distance to the cage, negative on the inner side of the nearest triangle's plane, where a target should be. */
  signed: Float64Array;
  /** The loop of open edges that the nearest point of the cage lies on; -1 if on none. On a loop, `signed` means nothing. */
  loops: Int32Array;
  /** 1 per vertex that is under the cage: its nearest point is on no such loop, and no farther away than the cage is large. */
  areUnder: Uint8Array;
}

/** Prepares the input of the checks. */
export function sceneOf(
  cage: Mesh,
  target: Mesh,
  result: TransferResult,
  options: TransferOptions,
  parts: readonly PartName[],
): Scene {
  const surface = surfaceOf(cage);
  let isIn: Scene['isInRegion'] | undefined;
  const targetBox = boxOf(target.positions);
  return {
    cage,
    surface,
    target,
    parts,
    areas: vertexAreas(target),
    targetBox,
    diagonal: targetBox.diagonal || 1,
    threshold: options.threshold ?? 0.5,
    result,
    sides: sidesOf(surface, target, result),
    isInRegion: (vertex) => (isIn ??= regionOf(cage, target, result, options))(vertex),
  };
}

/** Costs a projection if anything is beyond: a result does not tell which vertices are. */
function regionOf(
  cage: Mesh,
  target: Mesh,
  { segmentStats }: TransferResult,
  { preset, steps, ...others }: TransferOptions,
) {
  // Of a cage that is too small all may be beyond; then all is judged.
  const hasRegion = segmentStats.some(({ beyondArea }) => beyondArea > 0) && segmentStats.some(({ culled }) => !culled);
  if (!hasRegion) return () => true;
  const ofProject = <T extends object>(options: T): Partial<T> =>
    Object.fromEntries(
      Object.entries(options).filter(([name]) => optionTable[name as keyof typeof optionTable]?.stage === 'project'),
    ) as Partial<T>;
  const { visibility } = project(cage, target, { preset, ...ofProject(others), steps: ofProject(steps ?? {}) });
  return (vertex: number) => visibility[vertex] !== Visibility.Beyond;
}

function sidesOf(
  surface: Surface,
  target: Mesh,
  { triangles, distances }: Pick<TransferResult, 'triangles' | 'distances'>,
): Sides {
  const { mesh, place, loopOfVertex, loopOfEdge, edgeKey } = surface;
  const signed = new Float64Array(distances.length);
  const loops = new Int32Array(distances.length).fill(-1);
  for (let v = 0; v < distances.length; ++v) {
    const first = 3 * triangles[v]!;
    const corners = [mesh.indices[first]!, mesh.indices[first + 1]!, mesh.indices[first + 2]!] as const;
    const [a, b, c] = [
      pointAt(mesh.positions, corners[0]),
      pointAt(mesh.positions, corners[1]),
      pointAt(mesh.positions, corners[2]),
    ];
    const p = pointAt(target.positions, v);
    signed[v] = Math.sign(dot(doubleAreaNormal(a, b, c), minus(p, a))) * distances[v]!;
    // Most triangles touch no open edge.
    if (loopOfVertex[corners[0]]! < 0 && loopOfVertex[corners[1]]! < 0 && loopOfVertex[corners[2]]! < 0) continue;
    const touched = nearestPoint(p, a, b, c).corners;
    if (touched.length === 1) loops[v] = loopOfVertex[corners[touched[0]!]!]!;
    if (touched.length === 2)
      loops[v] = loopOfEdge.get(edgeKey(place[corners[touched[0]!]!]!, place[corners[touched[1]!]!]!)) ?? -1;
  }
  const most = boxOf(mesh.positions, mesh.indices).diagonal;
  return { signed, loops, areUnder: Uint8Array.from(loops, (loop, v) => Number(loop < 0 && distances[v]! <= most)) };
}

/** The part of each vertex. */
export function partsOf(parts: readonly PartName[], vertices: number): Uint32Array {
  const partOf = new Uint32Array(vertices);
  parts.forEach(({ firstVertex, vertexCount }, p) => partOf.fill(p, firstVertex, firstVertex + vertexCount));
  return partOf;
}
