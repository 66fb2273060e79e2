import { CagecastError } from '../core/error.js';

/** The first bytes of packed data: "CGCT", and the version of the format. */
const kMagic = 0x54434743;
const kVersion = 2;

const kTypes = { Uint8Array, Int8Array, Uint16Array, Int16Array, Uint32Array, Float32Array, Float64Array };
type Packable = InstanceType<(typeof kTypes)[keyof typeof kTypes]>;

/** How an array is named in the text: its type, its first byte behind the text, and its length. */
interface ArrayNote {
  $array: [type: keyof typeof kTypes, at: number, length: number];
}

/**
 * Packs plain data with typed arrays in it into bytes: magic, version, length of a text and a checksum, 4 bytes each; then JSON, in
 * which each array is a note; then the arrays, aligned to 8 bytes.
 */
export function pack(data: unknown): Uint8Array<ArrayBuffer> {
  const arrays: { array: Packable; at: number }[] = [];
  let end = 0;
  const text = JSON.stringify(data, (_, value: unknown) => {
    if (value === Infinity) return { $infinity: true };
    if (!ArrayBuffer.isView(value)) return value;
    const array = value as Packable;
    arrays.push({ array, at: end });
    const note: ArrayNote = { $array: [array.constructor.name as keyof typeof kTypes, end, array.length] };
    end += align(array.byteLength);
    return note;
  });
  const bytes = new TextEncoder().encode(text);
  const start = align(16 + bytes.length);
  const out = new Uint8Array(start + end);
  out.set(bytes, 16);
  for (const { array, at } of arrays)
    out.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), start + at);
  new Uint32Array(out.buffer, 0, 4).set([kMagic, kVersion, bytes.length, hash(out.subarray(16))]);
  return out;
}

/**
 * What `pack` packed. Arrays are views of one copy of the bytes.
 * @throws {CagecastError} `badArgument` if the bytes are not from `pack`, or incomplete.
 */
export function unpack(bytes: Uint8Array): unknown {
  const own = new Uint8Array(bytes); // `slice` of Node's Buffer is no copy.
  const [magic, version, length, sum] = own.length >= 16 ? new Uint32Array(own.buffer, 0, 4) : [];
  if (magic !== kMagic) throw refused(`is nothing that serialize wrote (${own.length} bytes)`);
  if (version !== kVersion) throw refused(`has version ${version} of the format; this one reads version ${kVersion}`);
  if (hash(own.subarray(16)) !== sum) throw refused('is damaged or not whole');
  const start = align(16 + length!);
  const text = new TextDecoder().decode(own.subarray(16, 16 + length!));
  try {
    return JSON.parse(text, (_, value: (Partial<ArrayNote> & { $infinity?: true }) | null) => {
      if (value?.$infinity) return Infinity;
      if (!value?.$array) return value;
      const [type, at, count] = value.$array;
      return new kTypes[type](own.buffer, start + at, count);
    });
  } catch {
    throw refused('is damaged or not whole'); // The sum does not cover the length of the text.
  }
}

const align = (length: number): number => Math.ceil(length / 8) * 8;
const refused = (what: string): CagecastError => new CagecastError('badArgument', 'deserialize', `bytes ${what}`);

/** A hash of bytes, of 32 bits; not for secrets. @param seed  An earlier hash, to be continued; by another one, all is another hash. */
export function hash(bytes: Uint8Array, seed = 0): number {
  const count = bytes.length >> 2;
  const words =
    bytes.byteOffset % 4 === 0
      ? new Int32Array(bytes.buffer, bytes.byteOffset, count)
      : new Int32Array(bytes.slice(0, 4 * count).buffer);
  let sum = seed ^ bytes.length;
  for (let i = 0; i < count; ++i) sum = Math.imul(sum ^ (sum >>> 15) ^ words[i]!, 0x85ebca6b);
  for (let i = 4 * count; i < bytes.length; ++i) sum = Math.imul(sum ^ bytes[i]!, 0x85ebca6b);
  return (sum ^ (sum >>> 16)) >>> 0;
}
