import type { GLTF } from '@gltf-transform/core';
import { dracoOf } from './check-geometry.js';

/** Reads numbers of a stream one after the other; beyond its end all are 0. */
class Cursor {
  #at = 0;
  constructor(private readonly bytes: Uint8Array) {}

  byte(): number {
    return this.bytes[this.#at++] ?? 0;
  }
  skip(count: number): void {
    this.#at += count;
  }
  /** A number of 7 bits per byte. */
  number(): number {
    let value = 0;
    for (let i = 0; i < 10; ++i) {
      const byte = this.byte();
      value += (byte & 0x7f) * 2 ** (7 * i);
      if (byte < 0x80) break;
    }
    return value;
  }
  get isOver(): boolean {
    return this.#at >= this.bytes.length;
  }
}

/** Skips metadata: names with values, then other metadata with names, each followed by what is below it. */
function skipMetadata(cursor: Cursor): void {
  let left = 0; // of other metadata, in the order of the stream
  do {
    for (let entries = cursor.number(); entries > 0 && !cursor.isOver; --entries) {
      cursor.skip(cursor.byte()); // its name
      cursor.skip(cursor.number()); // its value
    }
    left += cursor.number();
    if (left > 0) cursor.skip(cursor.byte()); // the name of the next
  } while (left-- > 0 && !cursor.isOver);
}

/**
 * What a Draco stream of triangles says to have. It has at least so many points: those at seams are told later.
 * Bitstream: https://google.github.io/draco/spec
 */
function countsOf(stream: Uint8Array): { points: number; faces: number } {
  const cursor = new Cursor(stream);
  cursor.skip(5); // "DRACO"
  if (cursor.byte() !== 2 || cursor.byte() !== 2) return { points: 0, faces: 0 }; // The decoder refuses other versions.
  cursor.skip(1); // the kind of geometry
  const isEdgebreaker = cursor.byte() === 1;
  cursor.skip(1); // the lower byte of the flags
  const hasMetadata = (cursor.byte() & 0x80) !== 0;
  if (hasMetadata) {
    for (let attributes = cursor.number(); attributes > 0 && !cursor.isOver; --attributes) {
      cursor.number(); // of which attribute
      skipMetadata(cursor);
    }
    skipMetadata(cursor);
  }
  if (isEdgebreaker) {
    cursor.skip(1); // how triangles are walked
    return { points: cursor.number(), faces: cursor.number() };
  }
  const faces = cursor.number();
  return { points: cursor.number(), faces };
}

/**
 * The same glTF, with accessors that have at least as many elements as the streams of Draco that are decoded into them: for a judgement of
 * what that costs. Streams have more where the decoder joins equal points, and where somebody wants to see memory run out.
 */
export function withDracoCounts(json: GLTF.IGLTF, buffers: readonly (Uint8Array | undefined)[]): GLTF.IGLTF {
  const { meshes = [], bufferViews = [] } = json;
  const accessors = (json.accessors ?? []).map((accessor) => ({ ...accessor }));
  const raise = (accessor: number, count: number) => {
    accessors[accessor]!.count = Math.max(accessors[accessor]!.count, count);
  };
  for (const { primitives } of meshes) {
    for (const primitive of primitives) {
      const draco = dracoOf(primitive);
      if (!draco) continue;
      const { buffer, byteOffset = 0, byteLength } = bufferViews[draco.bufferView]!;
      const stream = buffers[buffer]?.subarray(byteOffset, byteOffset + byteLength) ?? new Uint8Array();
      const { points, faces } = countsOf(stream);
      for (const accessor of Object.values(primitive.attributes)) raise(accessor, points);
      if (primitive.indices !== undefined) raise(primitive.indices, 3 * faces);
    }
  }
  return { ...json, accessors };
}
