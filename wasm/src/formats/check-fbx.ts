import { exceeds, type ReadLimits } from '../gltf/checks/read-limits.js';

/** Arrays of up to this many bytes may be in any file. */
const kFreeBytes = 2 ** 25;
/** The bytes of a value in an array of a type. */
const kArrays: Record<string, number> = { f: 4, d: 8, l: 8, i: 4, b: 1 };
const kValues: Record<string, number> = { Y: 2, C: 1, I: 4, F: 4, D: 8, L: 8 };

/**
 * Checks what the arrays of a binary FBX take once they are decompressed, before a loader does that: a megabyte can hold a gigabyte of
 * zeros. Cost: that of decompressing them.
 * @throws {InputError} that names the bytes and the limit. What is no binary FBX, or a damaged one, is left to the loader.
 */
export async function checkFbx(bytes: Uint8Array, limits: ReadLimits): Promise<void> {
  const most = Math.max(kFreeBytes, limits.expansion * bytes.length);
  let all = 0;
  for (const { size, packed } of arraysOf(bytes)) {
    all += Math.max(size, packed ? await inflatedSize(packed, most - all) : 0);
    if (all > most)
      throw exceeds(`its arrays decompress to more than ${most.toLocaleString('en')} bytes`, 'expansion', limits);
  }
}

interface PackedArray {
  /** What it says to take, in bytes. */
  size: number;
  /** Its bytes, if they are compressed. */
  packed: Uint8Array | undefined;
}

/** The arrays of all records, one inside the other. */
function* arraysOf(bytes: Uint8Array): Generator<PackedArray> {
  if (bytes.length < 27 || new TextDecoder().decode(bytes.subarray(0, 18)) !== 'Kaydara FBX Binary') return;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const isLong = view.getUint32(23, true) >= 7500;
  const word = (at: number) => (isLong ? Number(view.getBigUint64(at, true)) : view.getUint32(at, true));
  const head = isLong ? 24 : 12;
  try {
    for (let at = 27; at + head < bytes.length; ) {
      const [end, properties, length] = [0, 1, 2].map((n) => word(at + (n * head) / 3)) as [number, number, number];
      at += head + 1 + view.getUint8(at + head);
      if (end === 0) continue; // what ends a list of records
      const after = at + length;
      for (let p = 0; p < properties && at < after; ++p) {
        const type = String.fromCharCode(view.getUint8(at));
        if (type in kArrays) {
          const [count, encoding, stored] = [1, 5, 9].map((n) => view.getUint32(at + n, true)) as [
            number,
            number,
            number,
          ];
          const size = count * kArrays[type]!;
          yield { size, packed: encoding === 1 ? bytes.subarray(at + 13, at + 13 + stored) : undefined };
          at += 13 + (encoding === 1 ? stored : size);
        } else at += 1 + (kValues[type] ?? 4 + view.getUint32(at + 1, true));
      }
      at = after; // its own records, if it has some, come next
    }
  } catch (error) {
    if (!(error instanceof RangeError)) throw error;
  }
}

/** How many bytes a zlib stream holds; not much more than `most` are looked at. A damaged stream holds what came before the damage. */
async function inflatedSize(packed: Uint8Array, most: number): Promise<number> {
  const stream = new Blob([Uint8Array.from(packed)]).stream().pipeThrough(new DecompressionStream('deflate'));
  const reader = stream.getReader();
  let size = 0;
  try {
    for (let part = await reader.read(); !part.done && size <= most; part = await reader.read())
      size += part.value.length;
  } catch {
    // The loader says what is wrong with it.
  } finally {
    await reader.cancel().catch(() => {});
  }
  return size;
}
