import type { BufferGeometry, InterleavedBufferAttribute } from 'three';
import { BufferAttribute } from 'three';

type Attribute = BufferAttribute | InterleavedBufferAttribute;

/** The values of an attribute, `size` numbers per vertex. */
interface Column {
  values: Float32Array | Uint16Array;
  size: 2 | 3 | 4;
}

/** A geometry as glTF has it. */
interface Attributes {
  attributes: Record<string, Column>;
  /** The movement of each vertex, for each morph target. */
  targets: Float32Array[];
  indices: Uint32Array;
}

/** The corners of all triangles, if there are any. */
export function cornersOf({ index, attributes }: BufferGeometry): Uint32Array | undefined {
  const position = attributes['position'];
  if (!position) return undefined;
  const count = index ? index.count : position.count;
  return Uint32Array.from({ length: count - (count % 3) }, (_, i) => (index ? index.getX(i) : i));
}

const sizes = { uv: 2, uv1: 2, position: 3, normal: 3, skinWeight: 4, skinIndex: 4 } as const;
const semantics = {
  position: 'POSITION',
  normal: 'NORMAL',
  uv: 'TEXCOORD_0',
  uv1: 'TEXCOORD_1',
  color: 'COLOR_0',
  skinIndex: 'JOINTS_0',
  skinWeight: 'WEIGHTS_0',
} as const;

/** The attributes of a geometry. Without an index, vertices that are alike in all of them become one. */
export function attributesOf(geometry: BufferGeometry, corners: Uint32Array): Attributes {
  const attributes: Record<string, Column> = {};
  for (const [name, semantic] of Object.entries(semantics) as [keyof typeof semantics, string][]) {
    const attribute = geometry.attributes[name];
    // glTF's second set of UVs needs a first.
    if (!attribute || (name === 'uv1' && !geometry.attributes['uv'])) continue;
    const size = name === 'color' ? (Math.min(4, attribute.itemSize) as 3 | 4) : sizes[name];
    const change = finish[name];
    const values = change ? floatsOf(attribute, size).slice() : floatsOf(attribute, size);
    change?.(values);
    attributes[semantic] = { values: name === 'skinIndex' ? Uint16Array.from(values) : values, size };
  }
  const positions = attributes['POSITION']!.values as Float32Array;
  const isRelative = geometry.morphTargetsRelative;
  const targets = (geometry.morphAttributes['position'] ?? []).map((target) => {
    const deltas = floatsOf(target, 3);
    return isRelative ? deltas : deltas.map((x, i) => x - positions[i]!);
  });
  if (geometry.index) return { attributes, targets, indices: corners };
  return merged({ attributes, targets, indices: corners });
}

function floatsOf(attribute: Attribute, size: number): Float32Array {
  const plain = attribute instanceof BufferAttribute && attribute.array instanceof Float32Array;
  if (plain && attribute.itemSize === size) return attribute.array as Float32Array;
  const out = new Float32Array(size * attribute.count);
  for (let v = 0; v < attribute.count; ++v)
    for (let k = 0; k < Math.min(size, attribute.itemSize); ++k) out[size * v + k] = attribute.getComponent(v, k);
  return out;
}

/** What glTF demands of attributes. */
const finish: { [Name in keyof typeof semantics]?: (values: Float32Array) => void } = {
  // The first row of an image is at v = 0.
  uv: flip,
  uv1: flip,
  normal(values) {
    for (let i = 0; i < values.length; i += 3) {
      const length = Math.hypot(values[i]!, values[i + 1]!, values[i + 2]!);
      if (length > 0) for (let k = 0; k < 3; ++k) values[i + k]! /= length;
      else values[i + 2] = 1;
    }
  },
  skinWeight(values) {
    for (let i = 0; i < values.length; i += 4) {
      const sum = values[i]! + values[i + 1]! + values[i + 2]! + values[i + 3]!;
      if (sum > 0) for (let k = 0; k < 4; ++k) values[i + k]! /= sum;
      else values[i] = 1;
    }
  },
};

function flip(uvs: Float32Array): void {
  for (let i = 1; i < uvs.length; i += 2) uvs[i] = 1 - uvs[i]!;
}

/** Vertices that are alike become one. */
function merged({ attributes, targets, indices }: Attributes): Attributes {
  const columns = [...Object.values(attributes), ...targets.map((values): Column => ({ values, size: 3 }))];
  const row = new Float32Array(columns.reduce((sum, { size }) => sum + size, 0));
  const words = new Uint16Array(row.buffer);
  const known = new Map<string, number>();
  const sources: number[] = [];
  const own = indices.map((vertex) => {
    let at = 0;
    for (const { values, size } of columns) for (let k = 0; k < size; ++k) row[at++] = values[size * vertex + k]! + 0;
    const key = String.fromCharCode(...words);
    const found = known.get(key);
    if (found !== undefined) return found;
    known.set(key, sources.length);
    return sources.push(vertex) - 1;
  });
  const gather = <V extends Float32Array | Uint16Array>(values: V, size: number): V => {
    const out = new (values.constructor as new (length: number) => V)(size * sources.length);
    sources.forEach((vertex, v) => out.set(values.subarray(size * vertex, size * (vertex + 1)), size * v));
    return out;
  };
  return {
    attributes: Object.fromEntries(
      Object.entries(attributes).map(([name, { values, size }]) => [name, { values: gather(values, size), size }]),
    ),
    targets: targets.map((values) => gather(values, 3)),
    indices: own,
  };
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
