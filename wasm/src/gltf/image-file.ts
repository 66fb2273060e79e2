/** The media type of an image that glTF can hold, by its first bytes. */
export function imageType(bytes: Uint8Array): 'image/png' | 'image/jpeg' | 'image/webp' | 'image/ktx2' | undefined {
  const starts = (offset: number, ...expected: number[]) => expected.every((byte, i) => bytes[offset + i] === byte);
  if (starts(0, 0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a)) return 'image/png';
  if (starts(0, 0xff, 0xd8, 0xff)) return 'image/jpeg';
  if (starts(0, 0x52, 0x49, 0x46, 0x46) && starts(8, 0x57, 0x45, 0x42, 0x50)) return 'image/webp';
  if (starts(0, 0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb)) return 'image/ktx2';
  return undefined;
}

/** Whether an image file is complete, up to its closing chunk or marker, or its last level. */
export function imageIsWhole(bytes: Uint8Array): boolean {
  if (imageType(bytes) === 'image/png') return pngLength(bytes) !== undefined;
  if (imageType(bytes) === 'image/webp')
    return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength).getUint32(4, true) + 8 <= bytes.byteLength;
  if (imageType(bytes) === 'image/ktx2') return ktx2IsWhole(bytes);
  // Cameras append data of their own after the end marker, so look for the last one.
  for (let at = bytes.byteLength - 2; at > 1; --at) if (bytes[at] === 0xff && bytes[at + 1] === 0xd9) return true;
  return false;
}

/** Where a PNG file ends, before what some programs put after it; undefined for a truncated one. */
export function pngLength(bytes: Uint8Array): number | undefined {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  for (let at = 8; at + 12 <= bytes.byteLength; at += 12 + view.getUint32(at))
    if (view.getUint32(at + 4) === 0x49454e44) return at + 12; // "IEND"
  return undefined;
}

/** The bytes of a KTX2 file before the list of its levels, and those of an entry of the list. */
const [ktx2Head, ktx2Level] = [80, 24];

function ktx2IsWhole(bytes: Uint8Array): boolean {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.byteLength < ktx2Head) return false;
  const levels = Math.max(1, view.getUint32(40, true));
  if (bytes.byteLength < ktx2Head + levels * ktx2Level) return false;
  for (let at = ktx2Head; at < ktx2Head + levels * ktx2Level; at += ktx2Level)
    if (view.getBigUint64(at, true) + view.getBigUint64(at + 8, true) > bytes.byteLength) return false;
  return true;
}

/** Why glTF cannot hold a whole KTX2 file, if so: it has to be one picture by Basis Universal, of whole blocks. */
export function ktx2Problem(bytes: Uint8Array): string | undefined {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const [format, , width, height, depth, layers, faces] = [0, 1, 2, 3, 4, 5, 6].map((n) =>
    view.getUint32(12 + 4 * n, true),
  );
  if (format !== 0) return `vkFormat is ${format}, not 0 (Basis Universal)`;
  if (depth !== 0 || layers !== 0 || faces !== 1) return 'it is not a single picture';
  return width! % 4 === 0 && height! % 4 === 0 ? undefined : `it has ${width} × ${height} pixels, not multiples of 4`;
}
