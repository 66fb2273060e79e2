/** Texels as an image has them: sRGB, 4 bytes each, colours not multiplied by alpha, upper row first. */
export interface Texels {
  width: number;
  height: number;
  data: Uint8ClampedArray<ArrayBuffer>;
}

/** Sides of the sheets that may be packed, the finest first. */
export const packedSides = [512, 256] as const;
const kMaxColors = 64;
const kAlphas = 15; // the greatest of the steps of alpha

/**
 * Packs what is drawn on a square sheet for an address: the rectangle that is touched, in few colours and steps of alpha. Strokes
 * of a few brushes keep their colours; those of a photo lose some.
 * @returns Letters of base64 for addresses; empty if nothing is drawn.
 */
export async function packTexels({ width, data }: Texels): Promise<string> {
  const side = packedSides.indexOf(width as (typeof packedSides)[number]);
  const alphaAt = (at: number): number => Math.round((data[4 * at + 3]! / 255) * kAlphas);
  let [left, top, right, bottom] = [width, width, 0, 0];
  for (let at = 0; at < width * width; at++) {
    if (alphaAt(at) === 0) continue;
    const [x, y] = [at % width, Math.floor(at / width)];
    [left, top, right, bottom] = [Math.min(left, x), Math.min(top, y), Math.max(right, x + 1), Math.max(bottom, y + 1)];
  }
  if (left >= right) return '';
  const places: number[] = [];
  for (let y = top; y < bottom; y++) for (let x = left; x < right; x++) places.push(y * width + x);
  const { colors, indexOf } = fewColors(
    data,
    places.filter((at) => alphaAt(at) > 0),
  );
  const body = new Uint8Array(2 * places.length);
  let last = 0;
  places.forEach((at, i) => {
    const alpha = alphaAt(at);
    // Transparent texels have the index before them, to pack well.
    if (alpha > 0) last = indexOf(at);
    body[i] = last;
    body[places.length + i] = alpha;
  });
  const head = [side, left, right, top, bottom].flatMap((value) => [value >> 8, value & 255]);
  const bytes = Uint8Array.from([...head, colors.length / 3, ...colors, ...body]);
  const packed = await new Response(through(bytes, new CompressionStream('deflate-raw'))).arrayBuffer();
  return toText(new Uint8Array(packed));
}

/** The colours of some texels, and which of them each has: as many bits as give no more than `kMaxColors`. */
function fewColors(
  data: Uint8ClampedArray,
  places: readonly number[],
): { colors: number[]; indexOf(at: number): number } {
  for (let bits = 8; ; bits--) {
    const keyOf = (at: number): number =>
      [0, 1, 2].reduce((key, channel) => (key << bits) | (data[4 * at + channel]! >> (8 - bits)), 0);
    const sums = new Map<number, [number, number, number, number]>();
    for (const at of places) {
      const sum = sums.get(keyOf(at)) ?? [0, 0, 0, 0];
      for (const channel of [0, 1, 2] as const) sum[channel] += data[4 * at + channel]! * data[4 * at + 3]!;
      sum[3] += data[4 * at + 3]!;
      sums.set(keyOf(at), sum);
      if (sums.size > kMaxColors) break;
    }
    if (sums.size > kMaxColors) continue;
    const indices = new Map([...sums.keys()].map((key, i) => [key, i]));
    return {
      colors: [...sums.values()].flatMap(([red, green, blue, weight]) =>
        [red, green, blue].map((sum) => Math.round(sum / weight)),
      ),
      indexOf: (at) => indices.get(keyOf(at))!,
    };
  }
}

/** Restores what `packTexels` packed. @returns Undefined if it was cut off, or changed. */
export async function unpackTexels(text: string): Promise<Texels | undefined> {
  const bytes = await unpack(text).catch(() => undefined);
  if (!bytes) return undefined;
  const [side = 0, left = 0, right = 0, top = 0, bottom = 0] = [0, 2, 4, 6, 8].map(
    (at) => (bytes[at]! << 8) | bytes[at + 1]!,
  );
  const size = packedSides[side];
  const [colors, from] = [bytes[kHead - 1]!, kHead + 3 * bytes[kHead - 1]!];
  const count = (right - left) * (bottom - top);
  if (!size || left >= right || top >= bottom || right > size || bottom > size) return undefined;
  if (bytes.length !== from + 2 * count) return undefined;
  const data = new Uint8ClampedArray(4 * size * size);
  for (let i = 0; i < count; i++) {
    const [color, alpha] = [bytes[from + i]!, bytes[from + count + i]!];
    if (color >= colors || alpha > kAlphas) return undefined;
    const at = 4 * ((top + Math.floor(i / (right - left))) * size + left + (i % (right - left)));
    if (alpha > 0) data.set(bytes.subarray(kHead + 3 * color, kHead + 3 * color + 3), at);
    data[at + 3] = (255 * alpha) / kAlphas;
  }
  return { width: size, height: size, data };
}

const kHead = 11; // bytes
const kMost = kHead + 3 * 255 + 2 * packedSides[0] ** 2;

/** @throws Error if it is damaged, or more than can be packed: a short text may claim a great deal. */
async function unpack(text: string): Promise<Uint8Array> {
  const letters = atob(text.replaceAll('-', '+').replaceAll('_', '/'));
  const packed = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
  const parts: Uint8Array[] = [];
  let size = 0;
  const reader = through(packed, new DecompressionStream('deflate-raw')).getReader();
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    size += part.value.length;
    if (size > kMost) {
      await reader.cancel();
      throw new Error('too much');
    }
    parts.push(part.value);
  }
  const bytes = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}

const through = (
  bytes: Uint8Array<ArrayBuffer>,
  stream: CompressionStream | DecompressionStream,
): ReadableStream<Uint8Array<ArrayBuffer>> => new Blob([bytes]).stream().pipeThrough(stream);

function toText(bytes: Uint8Array): string {
  let letters = '';
  for (const byte of bytes) letters += String.fromCharCode(byte);
  return btoa(letters).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}
