import type { GLTF } from '@gltf-transform/core';
import { CagecastError, type ErrorDetails, show } from '../../core/error.js';
import { plainArray } from '../../core/typed-arrays.js';
import { InputError } from '../../scene/input-error.js';
import { isDataUri, readDataUri } from '../data-uri.js';
import { imageSize } from '../image-file.js';
import { parseGltf } from '../parse.js';
import { checkGeometry } from './check-geometry.js';
import { checkImages } from './check-images.js';
import { checkRest } from './check-rest.js';
import { withDracoCounts } from './draco-header.js';
import { checkLimits } from './limits.js';
import { checkBytes, defaultLimits, type ReadLimits } from './read-limits.js';

/** Options of `checkGltf`. */
export interface CheckOptions {
  /** Limits other than the default ones. */
  limits?: { [Name in keyof ReadLimits]?: number | undefined } | undefined;
  /** Bytes of the files that this one refers to. Default: 0 */
  otherBytes?: number | undefined;
}

/**
 * Checks a GLB or glTF file before anything else reads it: its references, the ranges of its data, and what decoding and showing it
 * would cost. Loaders such as GLTFLoader and glTF-Transform trust a file, and a kilobyte can demand all memory. Takes about as long
 * as parsing its JSON. It decodes nothing: values of vertices and indices are not checked, and of images only the size that they say
 * to have.
 * @param bytes  The whole file.
 * @throws {CagecastError} `badArgument` that names the element, the value and the limit.
 */
export function checkGltf(bytes: Uint8Array, { limits = {}, otherBytes = 0, ...others }: CheckOptions = {}): void {
  const own = bytesOf('checkGltf', bytes);
  for (const name in others) throw wrong('checkGltf', `${name} is not an option`);
  const all = limitsOf('checkGltf', limits);
  if (!isCount(otherBytes)) throw wrong('checkGltf', `otherBytes = ${show(otherBytes)} is not a number ≥ 0`);
  try {
    const fileBytes = own.byteLength + otherBytes;
    checkBytes(fileBytes, all);
    const { json, binary } = parseGltf(own, all);
    const sizes = (json.buffers ?? []).map(({ uri, byteLength }, b) =>
      uri === undefined ? (b === 0 ? binary?.byteLength : undefined) : byteLength,
    );
    checkGeometry(json, sizes);
    checkRest(json);
    const buffers = (json.buffers ?? []).map(({ uri }, b) => {
      if (uri === undefined) return b === 0 ? binary : undefined;
      return isDataUri(uri) ? readDataUri(`buffers[${b}]`, uri) : undefined;
    });
    checkLimits(withDracoCounts(json, buffers), fileBytes, all);
    checkImages(imagesIn(json, buffers), fileBytes, all);
  } catch (error) {
    throw error instanceof InputError ? wrong('checkGltf', error.message, { cause: error }) : error;
  }
}

/**
 * Checks an image before anything decodes it: a kilobyte can stand for gigabytes. It is refused if it would take more than 256 MiB and
 * more than `expansion` times its size. For images beside a glTF, and for paints. What has another format passes.
 * @param bytes  The whole file.
 * @returns its size in pixels, read from its header; undefined for formats other than PNG, JPEG, WebP, KTX2, AVIF, GIF, BMP and ICO.
 * @throws {CagecastError} `badArgument` that names the pixels and the limit.
 */
export function checkImage(
  bytes: Uint8Array,
  { limits = {} }: Pick<CheckOptions, 'limits'> = {},
): { width: number; height: number } | undefined {
  const own = bytesOf('checkImage', bytes);
  try {
    checkImages([['it', own]], own.byteLength, limitsOf('checkImage', limits));
    return imageSize(own);
  } catch (error) {
    throw error instanceof InputError ? wrong('checkImage', error.message, { cause: error }) : error;
  }
}

type Caller = 'checkGltf' | 'checkImage';

const wrong = (where: Caller, text: string, details?: ErrorDetails) =>
  new CagecastError('badArgument', where, text, details);

function bytesOf(where: Caller, bytes: unknown): Uint8Array {
  const own = plainArray(bytes, 'Uint8Array');
  if (!own) throw wrong(where, `bytes is ${show(bytes)}, not a Uint8Array`, { argument: 'bytes' });
  return own;
}

const isCount = (value: unknown): value is number => typeof value === 'number' && value >= 0;

/** All limits. @throws {CagecastError} */
function limitsOf(where: Caller, given: NonNullable<CheckOptions['limits']>): ReadLimits {
  const all = { ...defaultLimits };
  for (const name in given) {
    const value = given[name as keyof ReadLimits] ?? all[name as keyof ReadLimits];
    if (!(name in all && isCount(value)))
      throw wrong(
        where,
        `limits.${name} = ${show(value)} is not a number ≥ 0 of one of ${Object.keys(all).join(', ')}`,
      );
    all[name as keyof ReadLimits] = value;
  }
  return all;
}

/** The images in buffers and in data URIs, by their names in messages. */
function* imagesIn(
  { images = [], bufferViews = [] }: GLTF.IGLTF,
  buffers: readonly (Uint8Array | undefined)[],
): Generator<[name: string, bytes: Uint8Array]> {
  for (const [i, { uri, bufferView }] of images.entries()) {
    const name = `images[${i}]`;
    const view = bufferViews[bufferView ?? -1];
    const { byteOffset = 0, byteLength = 0 } = view ?? {};
    const stored = view && buffers[view.buffer]?.subarray(byteOffset, byteOffset + byteLength);
    const bytes = stored ?? (uri !== undefined && isDataUri(uri) ? readDataUri(name, uri) : undefined);
    if (bytes) yield [name, bytes];
  }
}
