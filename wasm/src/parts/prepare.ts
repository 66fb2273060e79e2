import {
  type Classification,
  type CutTarget,
  cutBorders,
  type Mesh,
  type TransferOptions,
  type TransferResult,
  transfer,
} from '../api/index.js';
import { faultOfNames, optionNames } from '../api/option-names.js';
import { CagecastError, show } from '../core/error.js';
import { plainArray, showArray } from '../core/typed-arrays.js';
import { heaviestOf } from './blend.js';
import { type Borders, cutPart, isCut, type PartCut } from './cut-part.js';
import {
  type Copies,
  gather,
  type PartGeometry,
  type PartRange,
  type SplitPart,
  separatePaint,
  splitPart,
  turnOver,
  verticesOf,
} from './split-part.js';

/** What a part's vertex and index buffers become. The caller owns every array. */
export interface PreparedPart extends SplitPart {
  /** 1 per vertex: its `Zone`. */
  zones: Uint8Array<ArrayBuffer>;
  /** 1 per triangle: 1 if it may be painted. */
  cosmeticTriangles: Uint8Array<ArrayBuffer>;
  /** If borders were cut: what that added. */
  cut: PartCut | undefined;
}

/** The result of a transfer, and all that follows from it for the parts of its target: plain data. */
export interface Prepared {
  /** Of the whole target, before it was cut and split. */
  result: TransferResult;
  /** The number of triangles added by cutting borders. */
  cutTriangles: number;
  /** In the order of the option `ranges`. */
  parts: PreparedPart[];
}

/** Options of `prepareParts`: those of `transfer`, and how vertices are prepared. */
export interface PrepareOptions extends TransferOptions {
  /** The parts that have vertex buffers of their own, such as `joinParts` returns them. Default: the whole target is one. */
  ranges?: readonly PartRange[] | undefined;
  /** Where the paint ends: at existing triangle edges (`triangle`, the default), or at the borders of the cage, where triangles are cut. */
  borders?: Borders | undefined;
  /**
   * Whether vertices are also split where painted triangles meet others, so that a triangle is painted if, and only if, all its
   * vertices are: a shader can tell by `paintedVertices`. Default: true
   */
  separatePaint?: boolean | undefined;
  /** What `transfer` returned for this target: instead of another transfer, whose options count where borders are cut only. */
  result?: TransferResult | undefined;
}

const kOwnOptions = ['ranges', 'borders', 'separatePaint', 'result'] satisfies (keyof PrepareOptions)[];

/**
 * Transfers, cuts borders if asked to, and splits the vertices of each part of a target so that each has one UV: all that an engine
 * needs to show the paint. Existing vertices keep their numbers; new ones come after them. `applySplit` makes the engine's vertex
 * buffers of it. Needs `init`.
 *
 * Cost: that of the transfer, of `cutBorders` if borders are cut, and about 0.2 s per 100,000 triangles.
 *
 * @param cage    As for `transfer`. Not needed with a `result` whose borders are not cut.
 * @param target  As for `transfer`: all parts, as `joinParts` joins them.
 * @throws {CagecastError} `badOption` that names an option and its value; `badArgument` if a part has no place in the target, or a result
 * is of another; else as `transfer` and `cutBorders` do.
 *
 * @example
 * const { mesh, parts } = joinParts(meshes); // positions, indices and matrix of each mesh
 * const prepared = prepareParts(cage, mesh, { ranges: parts });
 * prepared.parts.forEach((part, p) => {
 *   meshes[p].positions = applySplit(meshes[p].positions, 3, part);
 *   meshes[p].uv2 = part.uvs;
 *   meshes[p].indices = part.indices;
 * });
 */
export function prepareParts(cage: Mesh | undefined, target: Mesh, options: PrepareOptions = {}): Prepared {
  const fault = faultOfNames(kFn, 'options', options, [
    ...kOwnOptions,
    ...optionNames('transfer').filter((name) => name !== 'reuse'),
  ]);
  if (fault !== undefined) throw new CagecastError('badOption', kFn, fault);
  const { ranges, borders, separatePaint: separates = true, result: known, ...own } = options;
  if (typeof separates !== 'boolean') throw wrongOption(`separatePaint = ${show(separates)} is not true or false`);
  const cuts = isCut(kFn, borders);
  const { positions, indices } = checkTarget(target);
  const [vertices, triangles] = [Math.floor(positions.length / 3), Math.floor(indices.length / 3)];
  const whole = { firstVertex: 0, vertexCount: vertices, firstTriangle: 0, triangleCount: triangles };
  if (ranges !== undefined) checkRanges(ranges, vertices, indices);
  if (known !== undefined) checkResult(known, vertices, triangles);
  const result = known ?? transfer(cage!, target, own);
  const cut = cuts ? cutBorders(cage!, target, result, own) : undefined;
  return {
    result,
    cutTriangles: cut ? cut.indices.length / 3 - triangles : 0,
    parts: (ranges ?? [whole]).map((range) =>
      preparePart({ ...range, localIndices: localIndices(range, indices) }, result, cut, separates),
    ),
  };
}

const kFn = 'prepareParts';

const wrongOption = (text: string): CagecastError => new CagecastError('badOption', kFn, `options.${text}`);
const wrong = (argument: string, text: string, at: number): CagecastError =>
  new CagecastError('badArgument', kFn, text, { argument, at });

/** Checks the types of what is read here of a target; `transfer` checks the rest. */
function checkTarget(target: Mesh): Pick<Mesh, 'positions' | 'indices'> {
  const kinds = ['Uint32Array', 'Uint16Array', 'Uint8Array'] as const;
  const positions = plainArray(target?.positions, 'Float32Array');
  const indices = plainArray(target?.indices, ...kinds);
  if (!positions || !indices) {
    const [name, value] = positions ? ['indices', target.indices] : ['positions', target?.positions];
    const what = positions ? 'Uint32Array, Uint16Array or Uint8Array' : 'Float32Array';
    throw wrong('target', `target.${name} is ${showArray(value, 'Float32Array', ...kinds)}, not a ${what}`, 0);
  }
  return { positions, indices };
}

function checkRanges(ranges: readonly PartRange[], vertices: number, indices: ArrayLike<number>): void {
  if (!Array.isArray(ranges)) throw wrongOption(`ranges is ${show(ranges)}, not an array`);
  const triangles = Math.floor(indices.length / 3);
  ranges.forEach((part: PartRange | null, p) => {
    const check = (first: 'firstVertex' | 'firstTriangle', count: 'vertexCount' | 'triangleCount', most: number) => {
      for (const [name, limit] of [
        [first, most],
        [count, most - (part?.[first] ?? 0)],
      ] as const) {
        const value = part?.[name];
        if (!(Number.isInteger(value) && value! >= 0 && value! <= limit))
          throw wrong(
            'options',
            `options.ranges[${p}].${name} = ${show(value)} is not a whole number within 0..${limit}`,
            p,
          );
      }
    };
    check('firstVertex', 'vertexCount', vertices);
    check('firstTriangle', 'triangleCount', triangles);
    const { firstVertex, vertexCount, firstTriangle, triangleCount } = part!;
    for (let i = 3 * firstTriangle; i < 3 * (firstTriangle + triangleCount); ++i)
      if (!(indices[i]! >= firstVertex && indices[i]! < firstVertex + vertexCount))
        throw wrong(
          'target',
          `target.indices[${i}] = ${indices[i]} is not a vertex of options.ranges[${p}] (${firstVertex}..${firstVertex + vertexCount - 1})`,
          i,
        );
  });
}

function checkResult(result: TransferResult, vertices: number, triangles: number): void {
  const wants = {
    uvs: ['Float32Array', 2 * vertices],
    cornerUvs: ['Float32Array', 6 * triangles],
    zones: ['Uint8Array', vertices],
    cosmeticTriangles: ['Uint8Array', triangles],
    segments: ['Uint32Array', vertices],
  } as const;
  for (const [name, [kind, length]] of Object.entries(wants)) {
    const value: unknown = (result as TransferResult | null)?.[name as keyof typeof wants];
    const array = plainArray(value, kind);
    if (!array) throw wrong('options', `options.result.${name} is ${showArray(value, kind)}, not a ${kind}`, 0);
    // UVs per corner are of some results only.
    if (array.length !== length && !(name === 'cornerUvs' && array.length === 0))
      throw wrong(
        'options',
        `options.result.${name} has ${array.length} entries, the target needs ${length}; give the target as it was transferred`,
        array.length,
      );
  }
  const { segmentStats } = result;
  if (!Array.isArray(segmentStats))
    throw wrong('options', `options.result.segmentStats is ${show(segmentStats)}, not an array`, 0);
}

/**
 * What a result makes of one part of a target.
 * @param cut  The whole target with cut borders, if they are cut.
 */
export function preparePart(
  part: PartGeometry,
  result: Pick<TransferResult, 'uvs' | 'cornerUvs' | 'zones' | 'cosmeticTriangles'>,
  cut: CutTarget | undefined,
  separates: boolean,
): PreparedPart {
  const { geometry, result: own, ...pieces } = cut ? cutPart(part, cut) : { geometry: part, result, cut: undefined };
  const { firstVertex, firstTriangle, triangleCount } = geometry;
  const split = splitPart(geometry, own);
  const prepared = {
    ...split,
    zones: Uint8Array.from(split.sources, (v) => own.zones[firstVertex + v]!),
    cosmeticTriangles: own.cosmeticTriangles.slice(
      firstTriangle,
      firstTriangle + triangleCount,
    ) as Uint8Array<ArrayBuffer>,
    cut: pieces.cut,
  };
  const copies = separates ? separatePaint(split.indices, prepared.cosmeticTriangles, split.sources.length) : undefined;
  return copies ? withCopies(prepared, copies) : prepared;
}

/** A part with more copies. */
export function withCopies(part: PreparedPart, { copied, indices }: Copies): PreparedPart {
  const { sources, uvs, zones, copies } = part;
  const all = Uint32Array.from([...sources.keys(), ...copied]);
  return {
    ...part,
    uvs: gather(uvs, 2, all),
    zones: gather(zones, 1, all),
    sources: gather(sources, 1, all),
    indices,
    copies: copies + copied.length,
  };
}

/** 1 for each vertex of a prepared part that a painted triangle has, else 0. */
export const paintedVertices = ({
  indices,
  cosmeticTriangles,
  sources,
}: Pick<PreparedPart, 'indices' | 'cosmeticTriangles' | 'sources'>): Uint8Array =>
  verticesOf(indices, cosmeticTriangles, sources.length);

/** The triangles of a part, in its own numbers and winding. */
export function localIndices(
  { firstVertex, firstTriangle, triangleCount, mirrored }: PartRange,
  indices: Mesh['indices'],
): Uint32Array<ArrayBuffer> {
  const local = Uint32Array.from(
    indices.subarray(3 * firstTriangle, 3 * (firstTriangle + triangleCount)),
    (v) => v - firstVertex,
  );
  if (mirrored) turnOver(local);
  return local;
}

type Decision = Pick<Classification, 'zones' | 'cosmeticTriangles'>;

/**
 * What another classification makes of a part. Of a cut one, pieces take the result of the whole triangle that they were cut from in
 * segments whose verdict has changed, and keep theirs elsewhere.
 * @param part     As it was prepared.
 * @param indices  Of the whole target, as the decision is.
 * @param isOther  1 per vertex of the whole target: whether its segment has another verdict.
 */
export function decideAgain(
  { zones, cosmeticTriangles, sources, cut }: PreparedPart,
  { firstVertex, vertexCount, firstTriangle, triangleCount }: PartRange,
  indices: ArrayLike<number>,
  isOther: ArrayLike<number>,
  now: Decision,
): Decision {
  if (!cut)
    return {
      zones: Uint8Array.from(sources, (v) => now.zones[firstVertex + v]!),
      cosmeticTriangles: now.cosmeticTriangles.slice(firstTriangle, firstTriangle + triangleCount),
    };
  return {
    zones: zones.map((zone, n) => {
      // A piece, and all sources of a new vertex, belong to one segment.
      const v = sources[n]! - vertexCount;
      const source = firstVertex + (v < 0 ? sources[n]! : heaviestOf(cut, v));
      return isOther[source] ? now.zones[source]! : zone;
    }),
    cosmeticTriangles: cosmeticTriangles.map((cosmetic, piece) => {
      const t = cut.triangles[piece]!;
      return isOther[indices[3 * t]!] ? now.cosmeticTriangles[t]! : cosmetic;
    }),
  };
}
