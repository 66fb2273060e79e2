const kIdentifier = [0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb, 0x0d, 0x0a, 0x1a, 0x0a];

/** A KTX2 texture of one Basis Universal block, 4 × 4 texels of one colour. */
export function ktx2Of(red: number, green: number, blue: number): Uint8Array<ArrayBuffer> {
  // Mode 8 of UASTC, from the lowest bit on: its code in 5 bits, then the colour.
  const block = Buffer.alloc(16);
  block.writeBigUInt64LE(0x17n | (BigInt(red) << 5n) | (BigInt(green) << 13n) | (BigInt(blue) << 21n) | (255n << 29n));
  const [header, levels, format] = [Buffer.alloc(80), Buffer.alloc(24), Buffer.alloc(44)];
  header.set(kIdentifier);
  // Format (none: Basis), size of a type, width, height, depth, layers, faces, levels, compression; then where the format is described.
  [0, 1, 4, 4, 0, 0, 1, 1, 0, 104, 44].forEach((word, at) => header.writeUInt32LE(word, 12 + 4 * at));
  [148, 16, 16].forEach((word, at) => levels.writeBigUInt64LE(BigInt(word), 8 * at));
  format.writeUInt32LE(44, 0);
  format.writeUInt32LE(2 | (40 << 16), 8);
  format.set([166, 1, 2, 0, 3, 3, 0, 0, 16], 12); // UASTC, BT.709, sRGB; blocks of 4 × 4 texels, 16 bytes each
  format.set([0, 0, 127, 0], 28);
  format.writeUInt32LE(0xffffffff, 40);
  return new Uint8Array(Buffer.concat([header, levels, format, block]));
}
