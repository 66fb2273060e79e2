import type { GLTF } from '@gltf-transform/core';
import { joinBytes, paddedLength } from '../../parts/glb.js';
import { bytesOf, meshoptView } from '../checks/check-geometry.js';

/** Where the indices or the values of a sparse accessor are. */
interface Slot {
  at: { bufferView: number; byteOffset?: number };
  length: number;
  isDropped: boolean;
}

/**
 * Gives sparse accessors a view of their own that share one with such to which nothing refers any more.
 * @param bytes       Of the first buffer.
 * @param isDropped   Whether nothing refers to an accessor any more.
 * @param references  How many refer to a view.
 * @param addView     Adds bytes. @returns the number of their view.
 */
export function splitSparseViews(
  { accessors = [], bufferViews = [] }: GLTF.IGLTF,
  bytes: Uint8Array,
  {
    isDropped,
    references,
    addView,
  }: {
    isDropped(accessor: number): boolean;
    references: ReadonlyMap<number, number>;
    addView(bytes: Uint8Array): number;
  },
): void {
  const slotsOf = new Map<number, Slot[]>();
  for (const [a, accessor] of accessors.entries()) {
    const { sparse } = accessor;
    if (!sparse) continue;
    const { indices, values } = sparse as unknown as Record<'indices' | 'values', Slot['at']>;
    const { componentType } = sparse.indices;
    for (const [at, size] of [
      [indices, bytesOf({ type: 'SCALAR', componentType, count: 1 })],
      [values, bytesOf(accessor)],
    ] as const) {
      const slots = slotsOf.get(at.bufferView) ?? [];
      slotsOf.set(at.bufferView, slots);
      slots.push({ at, length: size * sparse.count, isDropped: isDropped(a) });
    }
  }
  for (const [number, slots] of slotsOf) {
    const view = bufferViews[number]!;
    if (view.buffer !== 0 || meshoptView(view) || references.get(number) !== slots.length) continue;
    const kept = slots.filter((slot) => !slot.isDropped);
    if (kept.length === slots.length) continue;
    const places = new Map<string, number>();
    const chunks: Uint8Array[] = [];
    let length = 0;
    for (const { at, length: own } of kept) {
      const first = (view.byteOffset ?? 0) + (at.byteOffset ?? 0);
      const key = `${first} ${own}`;
      if (!places.has(key)) {
        places.set(key, length);
        chunks.push(bytes.subarray(first, first + own), new Uint8Array(paddedLength(own) - own));
        length += paddedLength(own);
      }
      at.byteOffset = places.get(key)!;
    }
    if (kept.length === 0) continue;
    const made = addView(joinBytes(chunks));
    for (const { at } of kept) at.bufferView = made;
  }
}
