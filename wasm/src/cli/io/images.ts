import { createRequire } from 'node:module';
import { join } from 'node:path';
import { PNG } from 'pngjs';
import { type Image, mostTexels } from '../../bake/index.js';
import { smallSize } from '../../bake/small-image.js';
import { imageIsWhole, imageSize, imageType, pngLength } from '../../gltf/image-file.js';
import { firstLine, InputError, naming } from '../../scene/input-error.js';
import type { ReadOptions } from '../model/reading.js';
import { readBeside, readBytes } from './files.js';

/**
 * Reads an image file.
 * @param folder  Where it has to be, as a regular file, unless files outside may be read. Default: anywhere, and pipes too.
 * @throws {InputError} that names the file.
 */
export const readImage = (path: string, reading: ReadOptions, folder?: string): Promise<Image> =>
  naming(path, async () =>
    decodeImage(await (folder === undefined ? readBytes(path, reading.limits) : readBeside(path, folder, reading))),
  );

/**
 * Decodes a PNG; other types by sharp, if it is installed.
 * @throws {InputError}
 */
export const decodeImage = (bytes: Uint8Array): Promise<Image> => decode(bytes, Infinity);

/**
 * Decodes an image to look for a face in it. A far larger one than `smallSize` gets that size, unless it has transparency or sharp is missing.
 * @throws {InputError}
 */
export const decodeSmall = (bytes: Uint8Array): Promise<Image> => decode(bytes, kFarLarger);

/** An image of so many times the small size is far larger. Smaller ones take hardly longer at full size. */
const kFarLarger = 4;

/** @param most  Up to so many times the small size, an image is read at full size. */
async function decode(bytes: Uint8Array, most: number): Promise<Image> {
  const type = imageType(bytes);
  if (type === undefined) throw new InputError('is not a PNG, JPEG or WebP image');
  if (type === 'image/ktx2') throw new InputError('is a KTX2 image, which cannot be baked; convert it to PNG');
  if (!imageIsWhole(bytes)) throw new InputError('is truncated: the image is incomplete');
  // The header comes first: nothing is decoded that is too large.
  const { width, height } = imageSize(bytes) ?? { width: 0, height: 0 };
  if (width === 0 || height === 0 || width > mostTexels || height > mostTexels)
    throw new InputError(`has ${width} × ${height} pixels; both must be from 1 to ${mostTexels}`);
  const [columns, rows] = smallSize({ width, height });
  const isFarLarger = Math.max(width / columns, height / rows) > most;
  const sharp = type === 'image/png' && !isFarLarger ? undefined : loadSharp();
  if (!sharp && type === 'image/png') return decodePng(bytes, width, height);
  if (!sharp)
    throw new InputError(
      `is a ${type === 'image/jpeg' ? 'JPEG' : 'WebP'} image; to read those, npm install sharp beside cagecast`,
    );
  try {
    const image = sharp(bytes);
    // Of transparent pixels, sharp drops the colours.
    if (isFarLarger && !(await image.metadata()).hasAlpha)
      image.resize(columns, rows, { fit: 'fill', kernel: 'linear' });
    const { data, info } = await image.ensureAlpha().raw().toBuffer({ resolveWithObject: true });
    return { width: info.width, height: info.height, data };
  } catch (error) {
    throw new InputError(`cannot be decoded (${firstLine(error)})`);
  }
}

function decodePng(bytes: Uint8Array, width: number, height: number): Image {
  try {
    const { data } = PNG.sync.read(Buffer.from(bytes.subarray(0, pngLength(bytes))));
    return { width, height, data };
  } catch (error) {
    throw new InputError(`cannot be decoded (${firstLine(error)})`);
  }
}

/** Encodes a PNG. */
export async function encodePng({ width, height, data }: Image): Promise<Uint8Array> {
  const png = new PNG({ width, height });
  png.data = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
  return PNG.sync.write(png);
}

/** The quality of JPEGs that are written, of 100. */
const kQuality = 90;

/** Encodes an image that takes the place of one of some type: as a JPEG if that was one and sharp is there, else as a PNG. */
export async function encodeLike(image: Image, mimeType: string | undefined): Promise<Uint8Array> {
  const sharp = mimeType === 'image/jpeg' ? loadSharp() : undefined;
  if (!sharp) return encodePng(image);
  const { width, height, data } = image;
  return sharp(data, { raw: { width, height, channels: 4 } })
    .jpeg({ quality: kQuality })
    .toBuffer();
}

/** The endings of images that can be written; all but the first by sharp. */
export const imageEndings = ['.png', '.jpg', '.jpeg', '.webp'];

/** Returns what encodes images for a file with one of these endings. @throws {InputError} if sharp is needed and not there. */
export function encoderFor(path: string): (image: Image) => Promise<Uint8Array> {
  const type = /\.(jpe?g|webp)$/i.exec(path)?.[1]?.toLowerCase();
  if (type === undefined) return encodePng;
  const sharp = loadSharp();
  if (!sharp) throw new InputError('to write JPEG and WebP, npm install sharp beside cagecast').in(path);
  return async ({ width, height, data }) => {
    const image = sharp(data, { raw: { width, height, channels: 4 } });
    return (type === 'webp' ? image.webp({ quality: kQuality }) : image.jpeg({ quality: kQuality })).toBuffer();
  };
}

/** The parts of sharp that are used here. */
type Sharp = (
  bytes: Uint8Array | Uint8ClampedArray,
  options?: object,
) => {
  jpeg(options: { quality: number }): { toBuffer(): Promise<Uint8Array> };
  webp(options: { quality: number }): { toBuffer(): Promise<Uint8Array> };
  metadata(): Promise<{ hasAlpha: boolean }>;
  resize(width: number, height: number, options: { fit: 'fill'; kernel: 'linear' }): void;
  ensureAlpha(): {
    raw(): {
      toBuffer(options: object): Promise<{ data: Uint8Array; info: { width: number; height: number } }>;
    };
  };
};

/** sharp, which has native code and is no dependency: the one beside this package, or, as `npx` runs it elsewhere, the project's. */
function loadSharp(): Sharp | undefined {
  for (const from of [import.meta.url, join(process.cwd(), 'package.json')])
    try {
      return createRequire(from)('sharp') as Sharp;
    } catch {
      // It is not there.
    }
  return undefined;
}
