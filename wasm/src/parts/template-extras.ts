import { movePoints } from './points.js';

/** What a cage's node or mesh has in its extras: docs/cages.md describes the format. */
interface ReadExtras {
  landmarks: Record<string, [number, number, number]>;
  holes: Record<string, number[]>;
  kind: 'automatic' | 'head' | 'body' | 'prop';
}

/** The extras of a node or mesh. */
interface ExtrasSource {
  extras: unknown;
  /** For messages. */
  place: string;
  /** From its space to that of the arrays, column by column. */
  matrix: ArrayLike<number>;
  /** The number of its first vertex in the arrays, and how many it has. */
  firstVertex: number;
  vertexCount: number;
}

const kinds: readonly unknown[] = ['automatic', 'head', 'body', 'prop'] satisfies ReadExtras['kind'][];

/**
 * Reads what extras say about a cage, and moves it to the space and the numbers of the arrays.
 * @param wrong  Makes the error.
 */
export function readExtras(sources: Iterable<ExtrasSource>, wrong: (text: string) => Error): ReadExtras {
  const out: ReadExtras = { landmarks: {}, holes: {}, kind: 'automatic' };
  for (const { extras, place, matrix, firstVertex, vertexCount } of sources) {
    const { landmarks, holes, kind } = (extras ?? {}) as Record<string, unknown>;
    for (const [name, point] of entriesOf(landmarks, `${place}.extras.landmarks`, wrong)) {
      if (!isPosition(point)) throw wrong(`${place}.extras.landmarks.${name} is not 3 finite numbers [x, y, z]`);
      out.landmarks[name] = movePoints(matrix, point, [0, 0, 0]);
    }
    for (const [name, loop] of entriesOf(holes, `${place}.extras.holes`, wrong)) {
      const isVertex = (v: unknown) => Number.isInteger(v) && (v as number) >= 0 && (v as number) < vertexCount;
      if (!Array.isArray(loop) || !loop.every(isVertex))
        throw wrong(`${place}.extras.holes.${name} is not a list of vertices (0..${vertexCount - 1})`);
      out.holes[name] = loop.map((v) => firstVertex + v);
    }
    if (kinds.includes(kind)) out.kind = kind as ReadExtras['kind'];
  }
  return out;
}

function entriesOf(value: unknown, place: string, wrong: (text: string) => Error): [string, unknown][] {
  if (value === undefined) return [];
  if (typeof value !== 'object' || value === null || Array.isArray(value)) throw wrong(`${place} is not an object`);
  return Object.entries(value);
}

/** Whether a value is x, y and z. */
export const isPosition = (value: unknown): value is [number, number, number] =>
  Array.isArray(value) && value.length === 3 && value.every((x) => Number.isFinite(x));
