import { exceeds } from '../../checks/read-limits.js';
import { type FormatLimits, mostBytes } from '../limits.js';
import { checkBraces, tooDeep } from './nesting.js';

/** The bytes of a value in an array of a type. */
const kArrays: Record<string, number> = { f: 4, d: 8, l: 8, i: 4, b: 1, c: 1 };
const kValues: Record<string, number> = { Y: 2, C: 1, I: 4, F: 4, D: 8, L: 8 };

/**
 * Checks what the arrays of a binary FBX take once they are decompressed, before a loader does that: a megabyte can hold a gigabyte of
 * zeros. Checks how deep its records are nested, in a text too. Cost: that of decompressing the arrays.
 * @throws {InputError} that names the bytes and the limit. What is no binary FBX, or a damaged one, is left to the loader.
 */
export async function checkFbx(bytes: Uint8Array, limits: FormatLimits): Promise<void> {
  if (!isBinaryFbx(bytes)) {
    checkBraces(bytes, 'records', limits); // the loader looks at each line by a pattern as long as it is deep
    return;
  }
  const most = mostBytes(bytes.length, limits);
  let all = 0;
  for (const { arrays } of recordsOf(bytes, limits))
    for (const { size, packed } of arrays) {
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

/** A record of a binary FBX. */
interface FbxRecord {
  name: string;
  /** In how many others it is. */
  depth: number;
  texts: string[];
  arrays: PackedArray[];
}

export const isBinaryFbx = (bytes: Uint8Array): boolean => textOf(bytes.subarray(0, 18)) === 'Kaydara FBX Binary';

const textOf = (bytes: Uint8Array): string => new TextDecoder().decode(bytes);

/**
 * All records, one inside the other, as the loader comes to them: it goes from property to property, and takes no notice of how long a
 * record says that they are. Ends where the file is damaged.
 * @throws {InputError} if they are nested too deep.
 */
export function* recordsOf(bytes: Uint8Array, limits: FormatLimits): Generator<FbxRecord> {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  /** Where the records end that are open. */
  const ends: number[] = [];
  try {
    const isLong = view.getUint32(23, true) >= 7500;
    const word = (at: number) => (isLong ? Number(view.getBigUint64(at, true)) : view.getUint32(at, true));
    const size = isLong ? 8 : 4;
    for (let at = 27; ends.length > 0 || !isEnd(at, bytes.length); ) {
      while (ends.length > 0 && at >= ends.at(-1)!) ends.pop();
      const [end, properties] = [word(at), word(at + size)];
      const length = view.getUint8(at + 3 * size);
      at += 3 * size + 1 + length;
      if (end === 0) continue; // what ends a list of records
      const name = textOf(bytes.subarray(at - length, at));
      const record: FbxRecord = { name, depth: ends.length, texts: [], arrays: [] };
      for (let p = 0; p < properties; ++p) {
        const type = String.fromCharCode(view.getUint8(at));
        if (type in kArrays) {
          const [count, encoding, stored] = [1, 5, 9].map((n) => view.getUint32(at + n, true)) as [
            number,
            number,
            number,
          ];
          const taken = count * kArrays[type]!;
          const packed = encoding === 0 ? undefined : bytes.subarray(at + 13, at + 13 + stored);
          record.arrays.push({ size: taken, packed });
          at += 13 + (encoding === 0 ? taken : stored);
        } else if (type in kValues) at += 1 + kValues[type]!;
        else if (type === 'S' || type === 'R') {
          const end = at + 5 + view.getUint32(at + 1, true);
          if (type === 'S') record.texts.push(textOf(bytes.subarray(at + 5, end)));
          at = end;
        } else return; // the loader knows no other
      }
      yield record;
      if (at < end && ends.push(end) > limits.nesting) throw tooDeep('records', limits);
    }
  } catch (error) {
    if (!(error instanceof RangeError)) throw error;
  }
}

/** Whether nothing but what ends a file follows, as the loader sees it. */
const isEnd = (at: number, length: number): boolean =>
  length % 16 === 0 ? ((at + 176) & ~15) >= length : at + 176 >= length;

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
