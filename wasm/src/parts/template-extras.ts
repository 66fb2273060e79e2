import { faceMesh } from './face-mesh.js';
import { movePoints } from './points.js';
import { type CageExtras, isRegion, type TemplateMesh } from './template.js';

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

const kinds: readonly unknown[] = ['automatic', 'head', 'body', 'prop'] satisfies CageExtras['kind'][];

/**
 * A mesh as a template, with what extras say about it. A mesh without landmarks that is MediaPipe's face gets those that are known of it.
 * @param wrong  Makes the error.
 */
export function readTemplate<Of extends TemplateMesh>(
  mesh: Of,
  sources: Iterable<ExtrasSource>,
  wrong: (text: string) => Error,
): Of & CageExtras {
  const extras = readExtras(sources, wrong);
  const face = Object.keys(extras.landmarks).length === 0 ? faceMesh(mesh) : undefined;
  return { ...mesh, ...(face ?? extras) } as Of & CageExtras;
}

/**
 * Reads what extras say about a cage, and moves it to the space and the numbers of the arrays.
 * @param wrong  Makes the error.
 */
function readExtras(sources: Iterable<ExtrasSource>, wrong: (text: string) => Error): CageExtras {
  const out: CageExtras = { landmarks: {}, holes: {}, kind: 'automatic' };
  const bare: string[] = [];
  for (const { extras, place, matrix, firstVertex, vertexCount } of sources) {
    const { landmarks, holes, kind, regions } = (extras ?? {}) as Record<string, unknown>;
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
    for (const [name, outlines] of entriesOf(regions, `${place}.extras.regions`, wrong)) {
      if (!isRegion(outlines))
        throw wrong(`${place}.extras.regions.${name} is not a list of outlines, each of at least 3 corners [u, v]`);
      out.regions = { ...out.regions, [name]: outlines };
    }
    bare.push(...bareNames([extras]));
    if (kinds.includes(kind)) out.kind = kind as CageExtras['kind'];
  }
  return bare.length > 0 ? { ...out, bare } : out;
}

/** The names of parts that cages leave bare, by what their nodes and meshes have in their extras. */
export const bareNames = (extras: Iterable<unknown>): string[] =>
  [...extras].flatMap((one) => {
    const bare = (one as Partial<CageExtras> | undefined)?.bare;
    return Array.isArray(bare) ? bare.filter((name) => typeof name === 'string') : [];
  });

function entriesOf(value: unknown, place: string, wrong: (text: string) => Error): [string, unknown][] {
  if (value === undefined) return [];
  if (typeof value !== 'object' || value === null || Array.isArray(value)) throw wrong(`${place} is not an object`);
  return Object.entries(value);
}

/** Whether a value is x, y and z. */
export const isPosition = (value: unknown): value is [number, number, number] =>
  Array.isArray(value) && value.length === 3 && value.every((x) => Number.isFinite(x));
