/** The media type of an image that glTF can hold, by its first bytes. */
export function imageType(bytes: Uint8Array): 'image/png' | 'image/jpeg' | 'image/webp' | 'image/ktx2' | undefined {
  const starts = (offset: number, ...expected: number[]) => expected.every((byte, i) => bytes[offset + i] === byte);
  if (starts(0, 0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a)) return 'image/png';
  if (starts(0, 0xff, 0xd8, 0xff)) return 'image/jpeg';
  if (starts(0, 0x52, 0x49, 0x46, 0x46) && starts(8, 0x57, 0x45, 0x42, 0x50)) return 'image/webp';
  if (starts(0, 0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb)) return 'image/ktx2';
  return undefined;
}

/** Whether a PNG, JPEG or WebP file is complete, up to its closing chunk or marker. */
export function imageIsWhole(bytes: Uint8Array): boolean {
  if (imageType(bytes) === 'image/png') {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    for (let at = 8; at + 12 <= bytes.byteLength; at += 12 + view.getUint32(at)) {
      if (view.getUint32(at + 4) === 0x49454e44) return true; // "IEND"
    }
    return false;
  }
  if (imageType(bytes) === 'image/webp')
    return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength).getUint32(4, true) + 8 <= bytes.byteLength;
  // Cameras append data of their own after the end marker, so look for the last one.
  for (let at = bytes.byteLength - 2; at > 1; --at) if (bytes[at] === 0xff && bytes[at + 1] === 0xd9) return true;
  return false;
}
