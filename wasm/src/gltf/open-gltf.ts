import type { GLTF } from '@gltf-transform/core';
import { CagecastError } from '../core/error.js';
import type { AccessorData } from '../scene/accessor.js';
import { firstLine, InputError } from '../scene/input-error.js';
import type { ImageBytes, SceneSource } from '../scene/source.js';
import type { UvSetChoice } from '../scene/uv-sets.js';
import { decodeAccessors } from './accessors.js';
import { checkGeometry } from './checks/check-geometry.js';
import { checkRest } from './checks/check-rest.js';
import { withDracoCounts } from './checks/draco-header.js';
import { checkLimits } from './checks/limits.js';
import { checkBytes, defaultLimits, exceeds, type ReadLimits } from './checks/read-limits.js';
import { isDataUri, readDataUri } from './data-uri.js';
import type { Decoders } from './decoders.js';
import { imageType } from './image-file.js';
import { parseGltf } from './parse.js';

/** A glTF file as it is, and its accessors decoded. */
export interface GltfFile extends SceneSource {
  /** As the caller named it, for messages. */
  path: string;
  /** The JSON as it stands in the file. Not to be changed. */
  json: GLTF.IGLTF;
  /** The bytes of each buffer; `undefined` for one that has none (a fallback for compressed views). */
  buffers: (Uint8Array | undefined)[];
  /** The accessors, in the file's order, decompressed and decoded. */
  accessors: AccessorData[];
  /** What was named in a file of another format, but is missing, for people. */
  missing?: readonly string[];
  /** Reads what it refers to. @throws {InputError} that begins with `name`. */
  readUri(name: string, uri: string): Promise<Uint8Array>;
}

/** How a file is opened. */
export interface Opening {
  limits?: ReadLimits;
  /** Reads a file beside it. @throws {InputError} that begins with `name`. Default: there are none. */
  readBeside?(name: string, uri: string): Promise<Uint8Array>;
  /** Default: meshopt's; what Draco compresses is refused. */
  decoders?: Decoders | undefined;
  /** As of `SceneSource`. */
  cageUvs?: UvSetChoice | undefined;
}

/**
 * Opens a GLB or glTF file: quantised, sparse, interleaved, or compressed by meshopt. Only geometry is decoded; images and materials stay as
 * they are.
 * @param path  Its name, for messages.
 * @throws {InputError} that names the file and what is wrong with it.
 */
export async function openGltf(
  path: string,
  content: Uint8Array,
  { limits = defaultLimits, readBeside = refuseBeside, decoders, cageUvs }: Opening = {},
): Promise<GltfFile> {
  try {
    checkBytes(content.byteLength, limits);
    const { json, binary } = parseGltf(content, limits);
    const readUri: GltfFile['readUri'] = async (name, uri) =>
      isDataUri(uri) ? readDataUri(name, uri) : readBeside(name, uri);
    const buffers = await readBuffers(json, binary, readUri, limits);
    const sizes = buffers.map((buffer) => buffer?.byteLength);
    checkGeometry(json, sizes);
    checkRest(json);
    const all = sizes.reduce<number>((sum, size) => sum + (size ?? 0), content.byteLength - (binary?.byteLength ?? 0));
    checkLimits(withDracoCounts(json, buffers), all, limits);
    const accessors = await decodeAccessors(json, buffers, decoders);
    const imageOf = (texture: number) => readImage({ json, buffers, readUri }, texture);
    return { path, json, buffers, accessors, readUri, imageOf, cageUvs };
  } catch (error) {
    if (error instanceof InputError) throw error.in(path);
    if (error instanceof CagecastError) throw error; // of this host, not of the file
    throw new InputError(`${path}: cannot be decoded (${firstLine(error)})`, { cause: error });
  }
}

async function refuseBeside(name: string, uri: string): Promise<never> {
  throw new InputError(`${name} is in ${uri.slice(0, 60)}, another file; give a GLB, which holds everything itself`);
}

async function readBuffers(
  { buffers: list = [] }: GLTF.IGLTF,
  binary: Uint8Array | undefined,
  readUri: GltfFile['readUri'],
  limits: ReadLimits,
): Promise<(Uint8Array | undefined)[]> {
  const buffers: (Uint8Array | undefined)[] = [];
  let total = 0;
  for (const [b, { uri, byteLength }] of list.entries()) {
    const name = `buffers[${b}]`;
    const bytes = uri === undefined ? (b === 0 ? binary : undefined) : await readUri(name, uri);
    if (bytes !== undefined && bytes.byteLength < byteLength) {
      throw new InputError(`${name} is truncated: it should have ${byteLength} bytes, there are ${bytes.byteLength}`);
    }
    total += bytes?.byteLength ?? 0;
    if (total > limits.bytes)
      throw exceeds(`its buffers up to ${name} have ${total.toLocaleString('en')} bytes`, 'bytes', limits);
    buffers.push(bytes);
  }
  return buffers;
}

/** Extensions that give a texture another image than its own `source`. */
export const sourceExtensions = ['KHR_texture_basisu', 'EXT_texture_webp', 'EXT_texture_avif'];

/** The image of a texture. */
export function sourceOf({ source, extensions }: GLTF.ITexture): number | undefined {
  const other = sourceExtensions.map((name) => (extensions?.[name] as { source?: number } | undefined)?.source);
  return other.find((found) => found !== undefined) ?? source;
}

/** Reads the image of a texture. @throws {InputError} if it is in a file that cannot be read. */
async function readImage(
  { json, buffers, readUri }: Pick<GltfFile, 'json' | 'buffers' | 'readUri'>,
  texture: number,
): Promise<ImageBytes | undefined> {
  const source = sourceOf(json.textures![texture]!);
  const image = source === undefined ? undefined : json.images?.[source];
  if (!image) return undefined;
  let bytes: Uint8Array;
  if (image.uri !== undefined) bytes = await readUri(`images[${source}]`, image.uri);
  else {
    const view = json.bufferViews?.[image.bufferView ?? -1];
    const buffer = view && buffers[view.buffer];
    if (!buffer) return undefined;
    bytes = buffer.subarray(view.byteOffset ?? 0, (view.byteOffset ?? 0) + view.byteLength);
  }
  return { bytes, mimeType: imageType(bytes) ?? image.mimeType ?? 'an unknown type' };
}
