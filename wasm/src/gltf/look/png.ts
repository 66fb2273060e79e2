import { type Image, mostTexels } from '../../bake/image.js';
import { joinBytes } from '../../parts/glb.js';
import { imageSize } from '../image-file.js';

const kSignature = [137, 80, 78, 71, 13, 10, 26, 10];
const kUp = 2; // the filter by the row above

/** Writes a PNG by what browsers, Node and edge functions have. */
export async function encodePng({ width, height, data }: Image): Promise<Uint8Array> {
  const row = 4 * width;
  const filtered = new Uint8Array((row + 1) * height);
  for (let y = 0, to = 0; y < height; ++y) {
    filtered[to++] = kUp;
    for (let at = row * y; at < row * (y + 1); ++at) filtered[to++] = data[at]! - (y > 0 ? data[at - row]! : 0);
  }
  const header = new Uint8Array(13);
  const view = new DataView(header.buffer);
  view.setUint32(0, width);
  view.setUint32(4, height);
  header.set([8, 6], 8); // bits of a channel; red, green, blue, alpha
  return joinBytes([
    Uint8Array.from(kSignature),
    chunk('IHDR', header),
    chunk('IDAT', await through(new CompressionStream('deflate'), filtered, Infinity)),
    chunk('IEND', new Uint8Array(0)),
  ]);
}

/** Numbers of a pixel, by the type of its colours. */
const kChannels: Record<number, number> = { 0: 1, 2: 3, 3: 1, 4: 2, 6: 4 };

/**
 * Reads a PNG of 8 bits a channel that is not interlaced, as nearly all are, where a host has nothing of its own for it.
 * @throws {Error} for others.
 */
export async function decodePng(png: Uint8Array, mimeType: string): Promise<Image> {
  const size = mimeType === 'image/png' ? imageSize(png) : undefined;
  const [bits, type, , , interlaced] = png.subarray(24, 29);
  const channels = kChannels[type!];
  if (!size || !channels || bits !== 8 || interlaced)
    throw new Error('is not a plain PNG; what reads such images can be given: options.decode');
  const { width, height } = size;
  // The header comes first: nothing is unpacked that is too large.
  if (Math.max(width, height) > mostTexels)
    throw new Error(`has ${width} × ${height} pixels, more than ${mostTexels} × ${mostTexels}`);
  const chunks = new Map<string, Uint8Array[]>();
  const view = new DataView(png.buffer, png.byteOffset, png.byteLength);
  for (let at = 8; at + 12 <= png.length; at += 12 + view.getUint32(at)) {
    const name = String.fromCharCode(...png.subarray(at + 4, at + 8));
    const chunk = png.subarray(at + 8, at + 8 + view.getUint32(at));
    const before = chunks.get(name);
    if (before) before.push(chunk);
    else chunks.set(name, [chunk]);
  }
  const row = channels * width;
  const packed = joinBytes(chunks.get('IDAT') ?? []);
  const bytes = await through(new DecompressionStream('deflate'), packed, (row + 1) * height);
  if (bytes.length !== (row + 1) * height) throw new Error('is incomplete');
  const [palette, clear] = [chunks.get('PLTE')?.[0], chunks.get('tRNS')?.[0]];
  if (type === 3 && !palette) throw new Error('has no palette');
  const values = unfiltered(bytes, row, channels);
  // Of grey and of red, green and blue: the one colour that is clear, as numbers of 2 bytes.
  const key = type === 0 || type === 2 ? clear : undefined;
  const isKey = (from: number) => {
    for (let k = 0; k < channels; ++k) if (key![2 * k] !== 0 || values[from + k] !== key![2 * k + 1]) return false;
    return true;
  };
  const data = new Uint8ClampedArray(4 * width * height);
  for (let from = 0, to = 0; to < data.length; from += channels, to += 4) {
    const first = values[from]!;
    const isGrey = channels < 3;
    for (let k = 0; k < 3; ++k) data[to + k] = type === 3 ? palette![3 * first + k]! : values[from + (isGrey ? 0 : k)]!;
    if (type === 3) data[to + 3] = clear?.[first] ?? 255;
    else if (channels % 2 === 0) data[to + 3] = values[from + channels - 1]!;
    else data[to + 3] = key && isKey(from) ? 0 : 255;
  }
  return { width, height, data };
}

/** Undoes the filters of rows. @throws {Error} for one that there is not. */
function unfiltered(bytes: Uint8Array, row: number, channels: number): Uint8Array {
  const values = new Uint8Array((bytes.length / (row + 1)) * row);
  for (let from = 0, to = 0; to < values.length; from += row + 1, to += row)
    unfilterRow(bytes.subarray(from, from + row + 1), values, { to, row, channels });
  return values;
}

/** Undoes the filter of a row, which its first byte names. @param values  Get it at `to`; rows above are there. */
function unfilterRow(
  bytes: Uint8Array,
  values: Uint8Array,
  { to, row, channels }: { to: number; row: number; channels: number },
): void {
  const left = (x: number) => (x < channels ? 0 : values[to + x - channels]!);
  const above = (x: number) => (to === 0 ? 0 : values[to + x - row]!);
  const corner = (x: number) => (x < channels || to === 0 ? 0 : values[to + x - row - channels]!);
  switch (bytes[0]) {
    case 0:
      values.set(bytes.subarray(1), to);
      break;
    case 1:
      for (let x = 0; x < row; ++x) values[to + x] = bytes[1 + x]! + left(x);
      break;
    case kUp:
      for (let x = 0; x < row; ++x) values[to + x] = bytes[1 + x]! + above(x);
      break;
    case 3:
      for (let x = 0; x < row; ++x) values[to + x] = bytes[1 + x]! + ((left(x) + above(x)) >> 1);
      break;
    case 4:
      for (let x = 0; x < row; ++x) values[to + x] = bytes[1 + x]! + paeth(left(x), above(x), corner(x));
      break;
    default:
      throw new Error(`has a row with filter ${bytes[0]}, which there is not`);
  }
}

/** The one of three neighbours that is nearest to what a plane through them gives. */
function paeth(left: number, above: number, corner: number): number {
  const a = Math.abs(above - corner);
  const b = Math.abs(left - corner);
  const c = Math.abs(left + above - 2 * corner);
  return a <= b && a <= c ? left : b <= c ? above : corner;
}

/** Packs or unpacks bytes. @throws {Error} for more than `most`, before they are all there. */
async function through(
  stream: CompressionStream | DecompressionStream,
  bytes: Uint8Array<ArrayBuffer>,
  most: number,
): Promise<Uint8Array> {
  const parts: Uint8Array[] = [];
  let length = 0;
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  for (let next = await reader.read(); !next.done; next = await reader.read()) {
    length += next.value.byteLength;
    if (length > most) throw new Error('has more pixels than it says');
    parts.push(next.value);
  }
  return joinBytes(parts);
}

function chunk(type: string, content: Uint8Array): Uint8Array {
  const bytes = new Uint8Array(12 + content.length);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, content.length);
  bytes.set(new TextEncoder().encode(type), 4);
  bytes.set(content, 8);
  view.setUint32(8 + content.length, crc(bytes.subarray(4, 8 + content.length)));
  return bytes;
}

const kTable = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c;
});

/** The checksum of a chunk. */
function crc(bytes: Uint8Array): number {
  let c = 0xffffffff;
  for (const byte of bytes) c = kTable[(c ^ byte) & 255]! ^ (c >>> 8);
  return ~c >>> 0;
}
