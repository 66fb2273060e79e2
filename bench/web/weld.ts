import type { SceneMesh } from '../scene-file.js';
import type { Kept } from './kept.js';

/** A target whose vertices of equal position and group are one point. */
export interface Welded {
  count: number;
  /** 3 per point. */
  positions: Float32Array;
  /** The point of each vertex. */
  ofVertex: Uint32Array;
  diagonal: number;
  low: readonly [number, number, number];
  side: number;
}

/** Welds by a hash table in typed arrays: a Map of strings or numbers takes five times as long. */
export function weld({ positions, groups }: SceneMesh, kept: Kept): Welded {
  const vertexCount = positions.length / 3;
  const slots = 2 ** Math.ceil(Math.log2(2 * vertexCount));
  const table = kept.take('table', Int32Array, slots).fill(-1);
  const firstVertex = kept.take('firstVertex', Uint32Array, vertexCount);
  const ofVertex = kept.take('ofVertex', Uint32Array, vertexCount);
  const points = kept.take('points', Float32Array, positions.length);
  const bits = new Uint32Array(positions.buffer, positions.byteOffset, positions.length);
  let count = 0;
  let [lx, ly, lz, hx, hy, hz] = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
  for (let v = 0; v < vertexCount; ++v) {
    // −0 counts as 0.
    const x = positions[3 * v]! + 0;
    const y = positions[3 * v + 1]! + 0;
    const z = positions[3 * v + 2]! + 0;
    const group = groups === undefined ? 0 : groups[v]!;
    let hash = Math.imul(
      (x === 0 ? 0 : bits[3 * v]!) ^ Math.imul(y === 0 ? 0 : bits[3 * v + 1]!, 0x85ebca6b),
      0x9e3779b1,
    );
    hash = Math.imul(hash ^ (hash >>> 15) ^ (z === 0 ? 0 : bits[3 * v + 2]!) ^ (group << 20), 0x9e3779b1);
    let slot = ((hash ^ (hash >>> 16)) >>> 0) & (slots - 1);
    let point = table[slot]!;
    while (
      point !== -1 &&
      !(
        points[3 * point] === x &&
        points[3 * point + 1] === y &&
        points[3 * point + 2] === z &&
        (groups === undefined || groups[firstVertex[point]!] === group)
      )
    ) {
      slot = (slot + 1) & (slots - 1);
      point = table[slot]!;
    }
    if (point === -1) {
      point = count++;
      table[slot] = point;
      firstVertex[point] = v;
      points[3 * point] = x;
      points[3 * point + 1] = y;
      points[3 * point + 2] = z;
      if (x < lx) lx = x;
      if (x > hx) hx = x;
      if (y < ly) ly = y;
      if (y > hy) hy = y;
      if (z < lz) lz = z;
      if (z > hz) hz = z;
    }
    ofVertex[v] = point;
  }
  const [dx, dy, dz] = [hx - lx, hy - ly, hz - lz];
  return {
    count,
    positions: points,
    ofVertex,
    diagonal: Math.sqrt(dx * dx + dy * dy + dz * dz),
    low: [lx, ly, lz],
    side: Math.max(dx, dy, dz),
  };
}

/** The points in the order of a Morton curve, so that neighbours come one after the other. */
export function alongCurve({ count, positions, low, side }: Welded, kept: Kept): Uint32Array {
  const few = count < 2 ** 16;
  const digitBits = few ? 11 : 10;
  const scale = side > 0 ? (few ? 127 : 1023) / side : 0;
  const keys = kept.take('keys', Uint32Array, count);
  let order = kept.take('order', Uint32Array, count);
  let spare = kept.take('spare', Uint32Array, count);
  for (let i = 0; i < count; ++i) {
    order[i] = i;
    keys[i] =
      spread((positions[3 * i]! - low[0]) * scale) |
      (spread((positions[3 * i + 1]! - low[1]) * scale) << 1) |
      (spread((positions[3 * i + 2]! - low[2]) * scale) << 2);
  }
  const starts = kept.take('starts', Uint32Array, 2 ** digitBits);
  for (let shift = 0; shift < (few ? 21 : 30); shift += digitBits) {
    starts.fill(0);
    const mask = starts.length - 1;
    for (let i = 0; i < count; ++i) ++starts[(keys[i]! >>> shift) & mask]!;
    let sum = 0;
    for (let d = 0; d <= mask; ++d) {
      const here = starts[d]!;
      starts[d] = sum;
      sum += here;
    }
    for (let i = 0; i < count; ++i) spare[starts[(keys[order[i]!]! >>> shift) & mask]!++] = order[i]!;
    [order, spare] = [spare, order];
  }
  return order;
}

/** Spreads 10 bits three apart. */
function spread(value: number): number {
  let bits = value | 0;
  bits = (bits | (bits << 16)) & 0x030000ff;
  bits = (bits | (bits << 8)) & 0x0300f00f;
  bits = (bits | (bits << 4)) & 0x030c30c3;
  return (bits | (bits << 2)) & 0x09249249;
}
