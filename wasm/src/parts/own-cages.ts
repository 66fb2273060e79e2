// Files with cages of their own, as Roblox's: `Head_OuterCage` is the cage of `Head_Geo`, by name.
import type { Mesh } from '../api/mesh.js';
import { show } from '../core/error.js';

/** The part that an outer cage is of. */
const kCage = /^(?:TransferTarget_)?(.+)_OuterCage(?:[._]?\d+)?$/i;
const kPrefix = /^TransferTarget_/i;
const kEnding = /(_Geo)?([._]?(?<!\d)\d+)?$/i;

type Names = readonly (string | undefined)[];

const caged = (names: Names): string | undefined =>
  names.map((name) => kCage.exec(name ?? '')?.[1]?.toLowerCase()).find((key) => key !== undefined);

/** Which parts of a model are the cage: the outer cages, if there are any; else all. */
export function cageParts(parts: readonly Names[]): (part: number) => boolean {
  const keys = parts.map(caged);
  return keys.some((key) => key !== undefined) ? (p) => keys[p] !== undefined : () => true;
}

/** Whether a model has outer cages. */
export const hasCages = (parts: readonly Pick<Range, 'aliases'>[]): boolean =>
  parts.some(({ aliases }) => caged(aliases) !== undefined);

/** A part, its names, and its vertices. */
interface Range {
  name: string;
  aliases: Names;
  firstVertex: number;
  vertexCount: number;
}

/** A target and its cage, and their parts. */
export interface Caged<M extends Mesh = Mesh> {
  mesh: M;
  parts: readonly Range[];
}

/** What was moved apart. */
export interface Apart<T extends Mesh, C extends Mesh> {
  target: T;
  cage: C;
  /** Puts triangles of the cage in place of those of lids in a result. */
  mend(result: { triangles: Uint32Array }): void;
}

/**
 * Moves the parts of a target apart, each with the cage of its name: arms that hang down are nearer to the cage of the body than to their own.
 * Where a cage is open towards another, it gets a lid. What is computed holds for the parts where they were; only the diagonal is another.
 * @returns both as `transfer` takes them; `undefined` if the cage is one, or has other names.
 * @throws {Error} of `fail` that names a part without a cage.
 */
export function moveApart<T extends Mesh, C extends Mesh>(
  cage: Caged<C>,
  target: Caged<T>,
  fail: (text: string) => Error,
): Apart<T, C> | undefined {
  const own = cage.mesh.uvs && cagesOf(target.parts, cage.parts, fail);
  if (own === undefined) return undefined;
  const lids = lidsOf(cage);
  const boxes = cage.parts.map((part, c) => {
    const box = emptyBox();
    extend(box, cage.mesh.positions, part);
    for (const lid of lids) if (lid.part === c) extend(box, lid.positions);
    target.parts.forEach((other, p) => own[p] === c && extend(box, target.mesh.positions, other));
    return box;
  });
  const places = sideBySide(boxes);
  const moves = boxes.map(({ low, high }, c) => places[c]!.map((x, k) => x - (low[k]! + high[k]!) / 2));
  const positions = target.mesh.positions.slice();
  target.parts.forEach((part, p) => move(positions, moves[own[p]!]!, part));
  const poses = target.mesh.poses?.slice();
  for (let i = 0; poses && i < poses.length; i += positions.length) {
    const pose = poses.subarray(i, i + positions.length);
    target.parts.forEach((part, p) => move(pose, moves[own[p]!]!, part));
  }
  const around = cage.mesh.positions.slice();
  cage.parts.forEach((part, c) => move(around, moves[c]!, part));
  for (const lid of lids) move(lid.positions, moves[lid.part]!);
  const count = cage.mesh.indices.length / 3;
  const besides = lids.flatMap(({ besides }) => besides);
  return {
    target: { ...target.mesh, positions, ...(poses && { poses }) },
    cage: { ...cage.mesh, ...joined(cage.mesh, around, lids) },
    mend: ({ triangles }) => {
      for (const [v, t] of triangles.entries()) if (t >= count) triangles[v] = besides[t - count]!;
    },
  };
}

/** A cage and its lids. @param positions  Of the cage where it was moved. */
function joined({ indices, uvs }: Mesh, positions: Float32Array, lids: readonly Lid[]) {
  const all = { positions: [...positions], indices: [...indices], uvs: [...uvs!] };
  for (const lid of lids) {
    const first = all.positions.length / 3;
    all.positions.push(...lid.positions);
    all.uvs.push(...lid.uvs);
    // Vertices of the loop itself are those of the cage.
    all.indices.push(...lid.indices.map((vertex) => (vertex < 0 ? -1 - vertex : first + vertex)));
  }
  return {
    positions: Float32Array.from(all.positions),
    indices: Uint32Array.from(all.indices),
    uvs: Float32Array.from(all.uvs),
    groups: undefined,
  };
}

/** How far a part is from others, as a share of its size. */
const kRoom = 0.25;

/** Where the middles of boxes go so that they lie in rows, close together: tolerances are shares of the diagonal of all. */
function sideBySide(boxes: readonly Box[]): number[][] {
  const sizes = boxes.map(({ low, high }) => {
    const size = high.map((x, k) => x - low[k]!);
    const room = kRoom * Math.max(...size);
    return { width: size[0]! + room, height: size[1]! + room };
  });
  const places: number[][] = [];
  const most = Math.sqrt(sizes.reduce((sum, { width, height }) => sum + width * height, 0));
  let [x, y, row] = [0, 0, 0];
  for (const c of [...boxes.keys()].sort((a, b) => sizes[b]!.height - sizes[a]!.height)) {
    const { width, height } = sizes[c]!;
    if (x > 0 && x + width > most) [x, y, row] = [0, y + row, 0];
    places[c] = [x + width / 2, y + height / 2, 0];
    x += width;
    row = Math.max(row, height);
  }
  return places;
}

/** The number of the cage of each part. */
function cagesOf(parts: readonly Range[], cages: readonly Range[], fail: (text: string) => Error) {
  const byKey = new Map(cages.map(({ aliases }, c) => [caged(aliases), c]));
  byKey.delete(undefined);
  if (byKey.size < 2) return undefined;
  const own = parts.map(({ aliases }) => {
    const keys = aliases.flatMap((name) => {
      const key = name?.replace(kPrefix, '').toLowerCase();
      return key === undefined ? [] : [key, key.replace(/_geo$/, ''), key.replace(kEnding, '')];
    });
    return keys.map((key) => byKey.get(key)).find((c) => c !== undefined);
  });
  if (own.every((c) => c === undefined)) return undefined;
  const lost = parts[own.indexOf(undefined)];
  if (lost) throw fail(`${show(lost.name)} has no cage: none is named ${lost.name.replace(/_Geo$/i, '')}_OuterCage`);
  return own as number[];
}

interface Box {
  low: number[];
  high: number[];
}

const emptyBox = (): Box => ({ low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] });

type Vertices = Pick<Range, 'firstVertex' | 'vertexCount'>;
const allOf = (positions: Float32Array): Vertices => ({ firstVertex: 0, vertexCount: positions.length / 3 });

function extend({ low, high }: Box, positions: Float32Array, { firstVertex, vertexCount } = allOf(positions)): void {
  for (let i = 3 * firstVertex; i < 3 * (firstVertex + vertexCount); ++i) {
    low[i % 3] = Math.min(low[i % 3]!, positions[i]!);
    high[i % 3] = Math.max(high[i % 3]!, positions[i]!);
  }
}

function move(positions: Float32Array, by: readonly number[], { firstVertex, vertexCount } = allOf(positions)): void {
  for (let i = 3 * firstVertex; i < 3 * (firstVertex + vertexCount); ++i) positions[i]! += by[i % 3]!;
}

/** An open edge of a cage, as its triangle has it. */
interface Edge {
  from: number;
  to: number;
  triangle: number;
  part: number;
}

/** What closes a loop of a cage. */
interface Lid {
  part: number;
  positions: Float32Array;
  uvs: number[];
  /** 3 per triangle; −1 and below for the vertices of the cage itself, −1 − number. */
  indices: number[];
  /** For each triangle, the one of the cage that it goes on from. */
  besides: number[];
}

/**
 * Closes the loops at which the cages of parts meet. A limb goes on beyond its end for as far as it is wide, with the UVs of the end: a
 * lid that lay on it would be nearest to the skin there.
 */
function lidsOf({ mesh, parts }: Caged): Lid[] {
  const places = placesOf(mesh, parts);
  const edges = openEdges(mesh, places);
  const at = (v: number) => [0, 1, 2].map((k) => mesh.positions[3 * v + k]!);
  const reach = kNear * diagonalOf(mesh, parts);
  const distance = (a: readonly number[], b: readonly number[]) => Math.hypot(...a.map((x, k) => x - b[k]!));
  const starts = edges.map(({ from, part }) => ({ part, point: at(from) }));
  const meets = ({ from, part }: Edge) => {
    const point = at(from);
    return starts.some((other) => other.part !== part && distance(point, other.point) <= reach);
  };
  return loopsOf(edges, places.of)
    .filter((loop) => loop.filter(meets).length >= kMeeting * loop.length)
    .map((loop) => {
      const n = loop.length;
      const mean = (values: (edge: Edge) => readonly number[], k: number) =>
        loop.reduce((sum, edge) => sum + values(edge)[k]! / n, 0);
      const uvOf = (v: number) => [mesh.uvs![2 * v]!, mesh.uvs![2 * v + 1]!];
      const centre = [0, 1, 2].map((k) => mean(({ from }) => at(from), k));
      // Edges run as in their triangles, which are seen from outside: against the direction in which the limb ends.
      const normal = [0, 0, 0];
      for (const { from, to } of loop) {
        const [a, b] = [at(from), at(to)].map((p) => p.map((x, k) => x - centre[k]!)) as [number[], number[]];
        for (let k = 0; k < 3; ++k) normal[k]! += a[(k + 2) % 3]! * b[(k + 1) % 3]! - a[(k + 1) % 3]! * b[(k + 2) % 3]!;
      }
      const length =
        loop.reduce((sum, { from }) => sum + distance(at(from), centre) / n, 0) / (Math.hypot(...normal) || 1);
      const beyond = (point: readonly number[]) => point.map((x, k) => x + length * normal[k]!);
      // Each edge has vertices of its own: the UVs of its ends may be those of a seam.
      const indices = loop.flatMap(({ from, to }, i) => {
        const [start, end] = [2 * i, 2 * i + 1];
        return [...[-1 - to, -1 - from, start], ...[-1 - to, start, end], ...[end, start, 2 * n]];
      });
      const ends = loop.flatMap(({ from, to }) => [from, to]);
      const uvs = loop.flatMap(({ from, to, triangle }) => {
        const third = mesh.indices.subarray(3 * triangle, 3 * triangle + 3).find((one) => one !== from && one !== to)!;
        const [[u, v], [toU, toV], [inU, inV]] = [from, to, third].map(uvOf) as [Uv, Uv, Uv];
        // Towards the triangle: beside it may be another tile.
        const side = Math.sign((inU - u) * (v - toV) + (inV - v) * (toU - u));
        const aside = (side * kAside) / (Math.hypot(toU - u, toV - v) || 1);
        const [du, dv] = [aside * (v - toV), aside * (toU - u)];
        return [...[u + du, v + dv], ...[toU + du, toV + dv]];
      });
      return {
        part: loop[0]!.part,
        positions: Float32Array.from([...ends.map(at), centre].flatMap(beyond)),
        uvs: [...uvs, ...[0, 1].map((k) => mean(({ from }) => uvOf(from), k))],
        indices,
        besides: loop.flatMap(({ triangle }) => [triangle, triangle, triangle]),
      };
    });
}

type Uv = [number, number];

/** How far the UVs of a lid are from those of the end, so that its triangles have an area in the texture. */
const kAside = 1e-4;

/** How far points of two cages that meet may be apart, as a share of the diagonal of all cages. */
const kNear = 1e-3;

/** The share of a loop that has to meet other cages to be closed: ends of limbs do not always have the same points. */
const kMeeting = 0.5;

function diagonalOf(mesh: Mesh, parts: readonly Range[]): number {
  const box = emptyBox();
  for (const part of parts) extend(box, mesh.positions, part);
  return Math.hypot(...box.high.map((x, k) => x - box.low[k]!));
}

/** The place of each vertex, the same for those in one place of a part; and its part. */
function placesOf({ positions }: Mesh, parts: readonly Range[]) {
  const [of, partOf] = [new Uint32Array(positions.length / 3), new Uint32Array(positions.length / 3)];
  parts.forEach(({ firstVertex, vertexCount }, p) => {
    const first = new Map<string, number>();
    for (let v = firstVertex; v < firstVertex + vertexCount; ++v) {
      const key = positions.subarray(3 * v, 3 * v + 3).join();
      if (!first.has(key)) first.set(key, v);
      [of[v], partOf[v]] = [first.get(key)!, p];
    }
  });
  return { of, partOf };
}

/** The edges that only one triangle has. */
function openEdges({ indices }: Mesh, { of, partOf }: ReturnType<typeof placesOf>): Edge[] {
  const edges = new Map<string, Edge | undefined>();
  for (let i = 0; i < indices.length; ++i) {
    const [from, to] = [indices[i]!, indices[i % 3 === 2 ? i - 2 : i + 1]!];
    const key = [of[from]!, of[to]!].sort((a, b) => a - b).join();
    edges.set(key, edges.has(key) ? undefined : { from, to, triangle: Math.floor(i / 3), part: partOf[from]! });
  }
  return [...edges.values()].filter((edge) => edge !== undefined);
}

/** The loops that edges form. */
function loopsOf(edges: readonly Edge[], of: Uint32Array): Edge[][] {
  const next = new Map(edges.map((edge) => [of[edge.from]!, edge]));
  const loops: Edge[][] = [];
  for (const edge of edges) {
    const loop: Edge[] = [];
    for (let one = next.get(of[edge.from]!); one; one = next.get(of[one.to]!)) {
      loop.push(one);
      next.delete(of[one.from]!);
    }
    if (loop.length > 2) loops.push(loop);
  }
  return loops;
}
