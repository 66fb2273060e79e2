import type { BufferAttribute, BufferGeometry, InterleavedBufferAttribute } from 'three';

type Attribute = BufferAttribute | InterleavedBufferAttribute;

/** The values of an attribute, `size` numbers per vertex. */
interface Column {
  values: Float32Array | Uint16Array;
  size: 2 | 3 | 4;
}

/** A geometry as glTF has it. */
export interface Attributes {
  attributes: Record<string, Column>;
  /** The movement of each vertex, for each morph target. */
  targets: Float32Array[];
  indices: Uint32Array;
}

/** The triangles of a geometry that have all their corners, at finite places. */
interface Corners {
  indices: Uint32Array;
  /** For each triangle of the geometry, whether it is one of them; undefined if all are. */
  kept: Uint8Array | undefined;
}

/** The corners of all triangles, if there are any. */
export function cornersOf({ index, attributes }: BufferGeometry): Corners | undefined {
  const position = attributes['position'];
  if (!position) return undefined;
  const count = index ? index.count : position.count;
  const indices = new Uint32Array(count - (count % 3));
  for (let c = 0; c < indices.length; ++c) indices[c] = index ? index.getX(c) : c;
  const isThere = (vertex: number) =>
    vertex < position.count && [0, 1, 2].every((k) => Number.isFinite(Math.fround(position.getComponent(vertex, k))));
  const isGood = Uint8Array.from({ length: position.count }, (_, vertex) => Number(isThere(vertex)));
  const kept = new Uint8Array(indices.length / 3);
  for (let c = 0; c < indices.length; c += 3)
    kept[c / 3] = Number([0, 1, 2].every((k) => isGood[indices[c + k]!] === 1));
  return { indices, kept: kept.includes(0) ? kept : undefined };
}

const sizes = { uv: 2, uv1: 2, uv2: 2, uv3: 2, position: 3, normal: 3, skinWeight: 4, skinIndex: 4 } as const;
const semantics = {
  position: 'POSITION',
  normal: 'NORMAL',
  uv: 'TEXCOORD_0',
  uv1: 'TEXCOORD_1',
  uv2: 'TEXCOORD_2',
  uv3: 'TEXCOORD_3',
  color: 'COLOR_0',
  skinIndex: 'JOINTS_0',
  skinWeight: 'WEIGHTS_0',
} as const;

/**
 * The attributes of a geometry, of the vertices that its triangles have. Without an index, vertices that are alike in all of them
 * become one. All its triangles are there, whether they are kept or not.
 * @param joints  The bones of its skin; 0 without one.
 */
export function attributesOf(geometry: BufferGeometry, { indices, kept }: Corners, joints: number): Attributes {
  const attributes: Record<string, Column> = {};
  const { count } = geometry.attributes['position']!;
  // glTF's second set of UVs needs a first.
  const isBeyond = (semantic: string) => {
    const [, set = '0'] = /^TEXCOORD_(\d)$/.exec(semantic) ?? [];
    return set !== '0' && !(`TEXCOORD_${Number(set) - 1}` in attributes);
  };
  for (const [name, semantic] of Object.entries(semantics) as [keyof typeof semantics, string][]) {
    const attribute = geometry.attributes[name];
    if (!attribute || isBeyond(semantic)) continue;
    if (joints === 0 && name.startsWith('skin')) continue;
    const size = name === 'color' ? (Math.min(4, Math.max(3, attribute.itemSize)) as 3 | 4) : sizes[name];
    const values = floatsOf(attribute, size, count);
    finish[name](values);
    attributes[semantic] = {
      values: name === 'skinIndex' ? Uint16Array.from(values, (joint) => (joint < joints ? joint : 0)) : values,
      size,
    };
  }
  const [skinIndex, skinWeight] = [attributes['JOINTS_0'], attributes['WEIGHTS_0']];
  if (skinIndex && skinWeight) joinJoints(skinIndex.values, skinWeight.values);
  const positions = attributes['POSITION']!.values as Float32Array;
  const isRelative = geometry.morphTargetsRelative;
  const targets = (geometry.morphAttributes['position'] ?? []).map((target) => {
    const deltas = floatsOf(target, 3, count);
    if (!isRelative) for (let i = 0; i < deltas.length; ++i) deltas[i]! -= positions[i]!;
    clean(deltas);
    return deltas;
  });
  if (geometry.index && !kept) return { attributes, targets, indices };
  return gathererOf({ attributes, targets })(indices, kept, !geometry.index);
}

/** Gives what a vertex has of a joint more than once to the first of these. */
function joinJoints(joints: Column['values'], weights: Column['values']): void {
  for (let i = 0; i < joints.length; ++i) {
    for (let first = i - (i % 4); first < i; ++first) {
      if (joints[first] !== joints[i] || weights[i] === 0) continue;
      weights[first]! += weights[i]!;
      weights[i] = 0;
      joints[i] = 0;
    }
  }
}

/** The values of an attribute; of vertices that it does not have, zeros. */
function floatsOf(attribute: Attribute, size: number, count: number): Float32Array {
  const out = new Float32Array(size * count);
  for (let v = 0; v < Math.min(count, attribute.count); ++v)
    for (let k = 0; k < Math.min(size, attribute.itemSize); ++k) out[size * v + k] = attribute.getComponent(v, k);
  return out;
}

function clean(values: Float32Array): void {
  for (let i = 0; i < values.length; ++i) if (!Number.isFinite(values[i])) values[i] = 0;
}

/** What glTF demands of attributes. */
const finish: { [Name in keyof typeof semantics]: (values: Float32Array) => void } = {
  position: clean,
  // The first row of an image is at v = 0.
  uv: flip,
  uv1: flip,
  uv2: flip,
  uv3: flip,
  normal(values) {
    clean(values);
    for (let i = 0; i < values.length; i += 3) {
      const length = Math.hypot(values[i]!, values[i + 1]!, values[i + 2]!);
      // Numbers that are hardly any lose their direction when they are divided.
      if (length > 1e-30) for (let k = 0; k < 3; ++k) values[i + k]! /= length;
      else values.set([0, 0, 1], i);
    }
  },
  color(values) {
    for (let i = 0; i < values.length; ++i) values[i] = values[i]! >= 0 ? Math.min(1, values[i]!) : 0;
  },
  skinIndex: clean,
  skinWeight(values) {
    for (let i = 0; i < values.length; ++i) if (!(values[i]! >= 0 && values[i]! < Infinity)) values[i] = 0;
    for (let i = 0; i < values.length; i += 4) {
      const sum = values[i]! + values[i + 1]! + values[i + 2]! + values[i + 3]!;
      if (sum > 1e-30 && sum < Infinity) for (let k = 0; k < 4; ++k) values[i + k]! /= sum;
      else values.set([1, 0, 0, 0], i);
    }
  },
};

function flip(uvs: Float32Array): void {
  clean(uvs);
  for (let i = 1; i < uvs.length; i += 2) uvs[i] = 1 - uvs[i]!;
}

/**
 * Returns what gathers the vertices of triangles, in their order; it can be called for each of many lists of triangles.
 * Corners of triangles that are not kept are at the first vertex.
 */
export function gathererOf({ attributes, targets }: Pick<Attributes, 'attributes' | 'targets'>) {
  const columns = [...Object.values(attributes), ...targets.map((values): Column => ({ values, size: 3 }))];
  /** One more than the place of each vertex; 0 if it has none yet. */
  const places = new Uint32Array(columns[0]!.values.length / columns[0]!.size);
  /** @param isMerged  Whether vertices that are alike become one, too. */
  return (indices: Uint32Array, kept?: Uint8Array, isMerged = false): Attributes => {
    const known = isMerged ? new AlikeRows(columns, indices.length) : undefined;
    const sources: number[] = [];
    const out = new Uint32Array(indices.length);
    for (let c = 0; c < indices.length; ++c) {
      if (kept && kept[(c - (c % 3)) / 3] === 0) continue;
      const vertex = known ? known.firstLike(indices[c]!) : indices[c]!;
      if (places[vertex] === 0) places[vertex] = sources.push(vertex);
      out[c] = places[vertex]! - 1;
    }
    for (const vertex of sources) places[vertex] = 0;
    const gather = <V extends Float32Array | Uint16Array>(values: V, size: number): V => {
      const out = new (values.constructor as new (length: number) => V)(size * sources.length);
      for (let v = 0; v < sources.length; ++v)
        for (let k = 0; k < size; ++k) out[size * v + k] = values[size * sources[v]! + k]!;
      return out;
    };
    return {
      attributes: Object.fromEntries(
        Object.entries(attributes).map(([name, { values, size }]) => [name, { values: gather(values, size), size }]),
      ),
      targets: targets.map((values) => gather(values, 3)),
      indices: out,
    };
  };
}

/** Finds rows of columns that are alike, by a table of their hashes. */
class AlikeRows {
  readonly #columns: readonly { words: Uint32Array | Uint16Array; size: number }[];
  /** Rows, and one more than that; 0 is free. */
  readonly #table: Uint32Array;

  constructor(columns: readonly Column[], rows: number) {
    this.#columns = columns.map(({ values, size }) => ({
      words: values instanceof Uint16Array ? values : wordsOf(values),
      size,
    }));
    this.#table = new Uint32Array(2 ** Math.ceil(Math.log2(2 * rows + 1)));
  }

  /** The first row of those asked for that is like this one. */
  firstLike(row: number): number {
    const last = this.#table.length - 1;
    for (let at = this.#hash(row) & last; ; at = (at + 1) & last) {
      const found = this.#table[at]!;
      if (found === 0) {
        this.#table[at] = row + 1;
        return row;
      }
      if (this.#alike(found - 1, row)) return found - 1;
    }
  }

  #hash(row: number): number {
    let hash = 0;
    for (const { words, size } of this.#columns)
      for (let k = 0; k < size; ++k) {
        hash = Math.imul(hash ^ words[size * row + k]!, 0x5bd1e995);
        hash ^= hash >>> 15;
      }
    return hash >>> 0;
  }

  #alike(one: number, other: number): boolean {
    for (const { words, size } of this.#columns)
      for (let k = 0; k < size; ++k) if (words[size * one + k] !== words[size * other + k]) return false;
    return true;
  }
}

/** The bits of numbers; those of -0 are those of 0. */
function wordsOf(values: Float32Array): Uint32Array {
  for (let i = 0; i < values.length; ++i) values[i]! += 0;
  return new Uint32Array(values.buffer, values.byteOffset, values.length);
}

/** The least and the greatest x, y and z. */
export function boundsOf(positions: ArrayLike<number>): { min: number[]; max: number[] } {
  const [min, max] = [new Array<number>(3).fill(Infinity), new Array<number>(3).fill(-Infinity)];
  for (let i = 0; i < positions.length; ++i) {
    min[i % 3] = Math.min(min[i % 3]!, positions[i]!);
    max[i % 3] = Math.max(max[i % 3]!, positions[i]!);
  }
  return { min, max };
}
