import { CagecastError, show } from '../core/error.js';

/** An image: 4 bytes per pixel (red, green, blue, alpha), not premultiplied, upper row first, as in glTF's UV space. */
export interface Image {
  width: number;
  height: number;
  data: Uint8Array | Uint8ClampedArray;
}

/** The longest side of an image that can be baked, in texels: some 32 bytes of memory for each texel are needed. */
export const mostTexels = 8192;

/** Linear light, 0..1, for each byte of sRGB. */
export const linearOf = Float32Array.from({ length: 256 }, (_, byte) =>
  byte <= 10 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4,
);

/** The same for bytes that are not colours. */
export const shareOf = Float32Array.from({ length: 256 }, (_, byte) => byte / 255);

const kSteps = 1 << 16;
let bytes: Uint8Array | undefined;

/** Bytes of sRGB for linear light, in steps of 1/65536: 20 of them lie between two dark bytes. */
function srgbBytes(): Uint8Array {
  bytes ??= Uint8Array.from({ length: kSteps + 1 }, (_, step) => {
    const linear = step / kSteps;
    return Math.round(255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055));
  });
  return bytes;
}

/** Returns a function from linear light to bytes of sRGB. */
export function colorByte(): (linear: number) => number {
  const table = srgbBytes();
  return (linear) => table[linear <= 0 ? 0 : linear >= 1 ? kSteps : (linear * kSteps + 0.5) | 0]!;
}

/** @throws {CagecastError} `badOption` for what is no object, and for a name that is unknown. */
export function checkNames(fn: string, argument: string, given: unknown, known: string): void {
  const wrong = (text: string) => new CagecastError('badOption', fn, argument + text, { argument });
  if (typeof given !== 'object' || given === null) throw wrong(` is ${show(given)}, not an object`);
  for (const name in given)
    if (!known.split(', ').includes(name)) throw wrong(`.${name} is not an option; there are: ${known}`);
}

/** An error of an argument, or of a member of one. @param name  As in "image.width". */
export const wrongArgument = (fn: string, name: string, text: string, at?: number): CagecastError =>
  new CagecastError('badArgument', fn, `${name} ${text}`, { argument: name.split('.')[0], at });

/**
 * Checks a size in texels.
 * @throws {CagecastError} `badArgument`
 */
export function checkSize(fn: string, name: string, value: unknown): number {
  if (!Number.isInteger(value) || (value as number) < 1 || (value as number) > mostTexels)
    throw wrongArgument(fn, name, `is ${show(value)}, not a whole number of texels from 1 to ${mostTexels}`);
  return value as number;
}

/**
 * Checks an image.
 * @throws {CagecastError} `badArgument`
 */
export function checkImage(fn: string, name: string, image: unknown): Image {
  if (typeof image !== 'object' || image === null)
    throw wrongArgument(fn, name, `is ${show(image)}, not an image { width, height, data }`);
  const { width, height, data } = image as Partial<Image>;
  checkSize(fn, `${name}.width`, width);
  checkSize(fn, `${name}.height`, height);
  if (!(data instanceof Uint8Array || data instanceof Uint8ClampedArray))
    throw wrongArgument(fn, `${name}.data`, `is ${show(data)}, not a Uint8Array or Uint8ClampedArray`);
  if (data.length !== 4 * width! * height!)
    throw wrongArgument(fn, `${name}.data`, `has ${data.length} bytes, not 4 for each of ${width} × ${height} pixels`);
  return image as Image;
}

/** Stands for an alpha of 0 where colours are weighted by it: opaque materials show them too. */
const kFaint = 1e-6;

/**
 * Resizes an image: every pixel is the mean of the area that it covers. Colours are averaged as they are stored, weighted by
 * alpha; where all of it is 0, plainly.
 * @throws {CagecastError} `badArgument` for a size that is not 1 to 8192.
 */
export function resize(image: Image, width: number, height: number): Image {
  const from = checkImage('resize', 'image', image);
  checkSize('resize', 'width', width);
  checkSize('resize', 'height', height);
  if (from.width === width && from.height === height) return from;
  const [columns, rows] = [spansOf(from.width, width), spansOf(from.height, height)];
  const data = new Uint8ClampedArray(4 * width * height);
  const { data: source } = from;
  const blended = new Float64Array(4 * from.width); // a row of the new height in the old width, weighted by alpha
  for (let y = 0; y < height; ++y) {
    blended.fill(0);
    let wholeDown = 0;
    for (let j = rows.starts[y]!; j < rows.starts[y + 1]!; ++j) {
      const down = rows.weights[j]!;
      wholeDown += down;
      for (let i = 0, at = blended.length * rows.places[j]!; i < blended.length; i += 4, at += 4) {
        const weight = down * (source[at + 3]! || kFaint);
        blended[i]! += weight * source[at]!;
        blended[i + 1]! += weight * source[at + 1]!;
        blended[i + 2]! += weight * source[at + 2]!;
        blended[i + 3]! += weight;
      }
    }
    for (let x = 0, to = 4 * width * y; x < width; ++x, to += 4) {
      let [r, g, b, a, whole] = [0, 0, 0, 0, 0];
      for (let j = columns.starts[x]!; j < columns.starts[x + 1]!; ++j) {
        const [across, i] = [columns.weights[j]!, 4 * columns.places[j]!];
        r += across * blended[i]!;
        g += across * blended[i + 1]!;
        b += across * blended[i + 2]!;
        a += across * blended[i + 3]!;
        whole += across;
      }
      data[to] = r / a;
      data[to + 1] = g / a;
      data[to + 2] = b / a;
      data[to + 3] = a / (whole * wholeDown);
    }
  }
  return { width, height, data };
}

/** The pixels of an old line that each pixel of a new one covers, and how much of each; at least two are blended. */
interface Spans {
  /** 1 per new pixel, and an end: where its pixels begin in the other arrays. */
  starts: Uint32Array;
  places: Uint32Array;
  weights: Float64Array;
}

function spansOf(before: number, after: number): Spans {
  const scale = before / after;
  const reach = Math.max(scale, 1);
  const starts = new Uint32Array(after + 1);
  const [places, weights]: [number[], number[]] = [[], []];
  for (let place = 0; place < after; ++place) {
    const middle = (place + 0.5) * scale;
    for (let i = Math.floor(middle - reach); i <= Math.ceil(middle + reach); ++i) {
      const weight = 1 - Math.abs(i + 0.5 - middle) / reach;
      if (weight <= 0) continue;
      places.push(Math.min(before - 1, Math.max(0, i)));
      weights.push(weight);
    }
    starts[place + 1] = places.length;
  }
  return { starts, places: Uint32Array.from(places), weights: Float64Array.from(weights) };
}
