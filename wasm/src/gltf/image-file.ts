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

/** The pixels that a PNG, JPEG, WebP, KTX2, AVIF, GIF, BMP or ICO file says to have: all that browsers read. Undefined if it does not say it. */
export function imageSize(bytes: Uint8Array): { width: number; height: number } | undefined {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  try {
    const type = imageType(bytes);
    const [width, height] = type ? sizes[type](view) : otherSize(view);
    return { width, height };
  } catch {
    return undefined; // it ends before
  }
}

const u24 = (view: DataView, at: number): number => view.getUint16(at, true) | (view.getUint8(at + 2) << 16);

type Size = [width: number, height: number];

const sizes = {
  'image/png': (view: DataView): Size => {
    const isHeader = view.getUint32(8) === 13 && view.getUint32(12) === 0x49484452; // "IHDR"
    if (!isHeader) throw new RangeError('it has no header');
    return [view.getUint32(16), view.getUint32(20)];
  },
  'image/jpeg': jpegSize,
  'image/webp': (view: DataView): Size => {
    const kind = view.getUint32(12);
    if (kind === 0x56503858) return [u24(view, 24) + 1, u24(view, 27) + 1]; // "VP8X"
    if (kind === 0x56503820) return [view.getUint16(26, true) & 0x3fff, view.getUint16(28, true) & 0x3fff]; // "VP8 "
    const bits = view.getUint32(21, true); // "VP8L"
    return [(bits & 0x3fff) + 1, ((bits >> 14) & 0x3fff) + 1];
  },
  'image/ktx2': (view: DataView): Size => [view.getUint32(20, true), view.getUint32(24, true)],
};

/** What browsers read although glTF does not have it. @throws RangeError for all else. */
function otherSize(view: DataView): Size {
  const begin = view.getUint32(0);
  if (view.getUint32(4) === 0x66747970) return avifSize(view); // "ftyp"
  if (begin === 0x47494638) return [view.getUint16(6, true), view.getUint16(8, true)]; // "GIF8"
  if (begin >>> 16 === 0x424d) return bitmapSize(view, 14); // "BM"
  if (begin === 0x00000100 || begin === 0x00000200) return iconSize(view);
  throw new RangeError('not an image');
}

/** The largest of the boxes "ispe", which are in the header: parts of a picture have some, too. */
function avifSize(view: DataView): Size {
  let largest: Size | undefined;
  for (let at = 8; at + 16 <= view.byteLength; ++at) {
    if (view.getUint32(at) !== 0x69737065) continue;
    const size: Size = [view.getUint32(at + 8), view.getUint32(at + 12)];
    if (!largest || size[0] * size[1] > largest[0] * largest[1]) largest = size;
  }
  if (!largest) throw new RangeError('no size');
  return largest;
}

/** The header of a bitmap, of which the oldest kind has shorter numbers. Heights below zero count from the top. */
function bitmapSize(view: DataView, at: number): Size {
  if (view.getUint32(at, true) === 12) return [view.getUint16(at + 4, true), view.getUint16(at + 6, true)];
  return [Math.abs(view.getInt32(at + 4, true)), Math.abs(view.getInt32(at + 8, true))];
}

/** The largest picture of an icon: each is a PNG or a bitmap. */
function iconSize(view: DataView): Size {
  let largest: Size = [0, 0];
  for (let n = 0; n < view.getUint16(4, true); ++n) {
    const at = view.getUint32(6 + 16 * n + 12, true);
    const size: Size =
      view.getUint32(at) === 0x89504e47 ? [view.getUint32(at + 16), view.getUint32(at + 20)] : bitmapSize(view, at);
    if (size[0] * size[1] > largest[0] * largest[1]) largest = size;
  }
  return largest;
}

/** The frame header of a JPEG, after other segments. */
function jpegSize(view: DataView): Size {
  for (let at = 2; ; at += 2 + view.getUint16(at + 2)) {
    while (view.getUint8(at + 1) === 0xff) ++at; // fill bytes
    const marker = view.getUint8(at + 1);
    const isFrame = marker >= 0xc0 && marker <= 0xcf && ![0xc4, 0xc8, 0xcc].includes(marker);
    if (isFrame) return [view.getUint16(at + 7), view.getUint16(at + 5)];
  }
}
