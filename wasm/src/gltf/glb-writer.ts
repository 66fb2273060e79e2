import { dirname } from 'node:path';
import type { GLTF } from '@gltf-transform/core';
import { meshoptExtensions, meshoptView } from './check.js';
import { type ReadOptions, readUri } from './files.js';
import { imageType } from './image.js';
import { InputError } from './input-error.js';
import type { GltfFile } from './read.js';

const arrayBuffer = 34962;
const elementArrayBuffer = 34963;
const types = { 1: 'SCALAR', 2: 'VEC2', 3: 'VEC3', 4: 'VEC4' } as const;

type AttributeArray = Float32Array | Int8Array | Uint8Array | Int16Array | Uint16Array | Uint32Array;

function componentTypeOf(values: AttributeArray): GLTF.AccessorComponentType {
  if (values instanceof Int8Array) return 5120;
  if (values instanceof Uint8Array) return 5121;
  if (values instanceof Int16Array) return 5122;
  if (values instanceof Uint16Array) return 5123;
  return values instanceof Uint32Array ? 5125 : 5126;
}

/** Pads the elements of an attribute, which begin at multiples of four bytes. */
function align(values: AttributeArray, size: number): { aligned: AttributeArray; byteStride?: number } {
  const perWord = 4 / values.BYTES_PER_ELEMENT;
  const stride = Math.ceil(size / perWord) * perWord;
  if (stride === size) return { aligned: values };
  const aligned = new (values.constructor as new (length: number) => AttributeArray)((values.length / size) * stride);
  for (let i = 0; i < values.length; ++i) aligned[Math.floor(i / size) * stride + (i % size)] = values[i]!;
  return { aligned, byteStride: stride * values.BYTES_PER_ELEMENT };
}

/**
 * Writes a GLB that has everything of a glTF file, with additions.
 *
 * It works on the file's JSON and bytes, not on a decoded document. So all contents stay unchanged, byte for byte, even those that
 * no library knows (extensions for avatars, extras, compressed data).
 */
export class GlbWriter {
  /** The JSON of the file to be written; add to it freely. */
  readonly json: GLTF.IGLTF;
  readonly #chunks: Uint8Array[] = [];
  #length = 0;

  private constructor(json: GLTF.IGLTF) {
    this.json = structuredClone(json);
  }

  /**
   * Starts from a file: its buffers are joined into one, and images in separate files are embedded.
   * @throws {InputError} if such an image cannot be read.
   */
  static async from(file: GltfFile): Promise<GlbWriter> {
    const writer = new GlbWriter(file.json);
    writer.#mergeBuffers(file.buffers);
    await writer.#embedImages(dirname(file.path), file.reading);
    return writer;
  }

  #mergeBuffers(buffers: (Uint8Array | undefined)[]): void {
    const { json } = this;
    const offsets = buffers.map((bytes, b) =>
      bytes ? this.#append(bytes.subarray(0, json.buffers![b]!.byteLength)) : 0,
    );
    // Buffers without bytes are fallbacks for compressed views; they are kept after the joined buffer.
    const kept = buffers.flatMap((bytes, b) => (bytes ? [] : [b]));
    const numbers = buffers.map((bytes, b) => (bytes ? 0 : 1 + kept.indexOf(b)));
    const move = (view: { buffer: number; byteOffset?: number }) => {
      const offset = (view.byteOffset ?? 0) + offsets[view.buffer]!;
      if (offset > 0) view.byteOffset = offset;
      view.buffer = numbers[view.buffer]!;
    };
    for (const view of json.bufferViews ?? []) {
      move(view);
      const compressed = meshoptView(view);
      if (compressed) move(compressed);
    }
    const fallbacks = kept.map((b) => json.buffers![b]!);
    const first = buffers[0] ? json.buffers![0]! : { byteLength: 0 };
    delete first.uri;
    // The joined buffer has bytes, so it must not be marked as a fallback.
    for (const name of meshoptExtensions) delete first.extensions?.[name];
    if (Object.keys(first.extensions ?? {}).length === 0) delete first.extensions;
    json.buffers = [first, ...fallbacks];
  }

  async #embedImages(folder: string, reading: ReadOptions): Promise<void> {
    for (const [i, image] of (this.json.images ?? []).entries()) {
      if (image.uri === undefined) continue;
      const bytes = await readUri(`images[${i}]`, image.uri, folder, reading);
      const mimeType = image.mimeType ?? imageType(bytes) ?? /^data:([^;,]+)/.exec(image.uri)?.[1];
      if (mimeType === undefined) throw new InputError(`images[${i}] is not an image that a GLB can contain`);
      delete image.uri;
      image.mimeType = mimeType;
      image.bufferView = this.#addView(bytes);
    }
  }

  #append(bytes: Uint8Array): number {
    const padding = (4 - (this.#length % 4)) % 4;
    if (padding > 0) this.#chunks.push(new Uint8Array(padding));
    const offset = this.#length + padding;
    this.#chunks.push(bytes);
    this.#length = offset + bytes.byteLength;
    return offset;
  }

  #addView(bytes: Uint8Array, target?: number, byteStride?: number): number {
    const byteOffset = this.#append(bytes);
    const view = {
      buffer: 0,
      byteOffset,
      byteLength: bytes.byteLength,
      ...(byteStride !== undefined && { byteStride }),
      ...(target !== undefined && { target }),
    };
    return (this.json.bufferViews ??= []).push(view as GLTF.IBufferView) - 1;
  }

  /** Adds a vertex attribute of `size` numbers per vertex. @returns the number of its accessor. */
  addAttribute(values: AttributeArray, size: number, more: Partial<GLTF.IAccessor> = {}): number {
    const count = values.length / size;
    const { aligned, byteStride } = align(values, size);
    return this.#addAccessor(
      aligned,
      arrayBuffer,
      { componentType: componentTypeOf(values), count, type: types[size as keyof typeof types], ...more },
      byteStride,
    );
  }

  /** Adds the indices of triangles, as small as they can be. @returns the number of their accessor. */
  addIndices(indices: Uint32Array, vertexCount: number): number {
    // The largest value of a type is reserved.
    const small = vertexCount < 65536;
    return this.#addAccessor(small ? Uint16Array.from(indices) : indices, elementArrayBuffer, {
      componentType: small ? 5123 : 5125,
      count: indices.length,
      type: 'SCALAR',
    });
  }

  #addAccessor(
    values: AttributeArray,
    target: number,
    accessor: Omit<GLTF.IAccessor, 'bufferView'>,
    byteStride?: number,
  ): number {
    const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
    return (
      (this.json.accessors ??= []).push({
        bufferView: this.#addView(bytes, target, byteStride),
        ...accessor,
      } as GLTF.IAccessor) - 1
    );
  }

  /** Adds a texture of a PNG or JPEG file's bytes. @returns the number of the texture. */
  addTexture(image: Uint8Array, mimeType: string, name: string): number {
    const { json } = this;
    const source = (json.images ??= []).push({ bufferView: this.#addView(image), mimeType, name }) - 1;
    return (json.textures ??= []).push({ source, name }) - 1;
  }

  /** The bytes of the GLB. */
  finish(): Uint8Array {
    const { json } = this;
    const padding = (4 - (this.#length % 4)) % 4;
    const binLength = this.#length + padding;
    if (this.#length > 0) json.buffers![0]!.byteLength = this.#length;
    else json.buffers!.shift();
    if (json.buffers!.length === 0) delete json.buffers;
    const text = new TextEncoder().encode(JSON.stringify(json));
    const textPadding = (4 - (text.byteLength % 4)) % 4;
    const textLength = text.byteLength + textPadding;

    const total = 12 + 8 + textLength + (binLength > 0 ? 8 + binLength : 0);
    const out = new Uint8Array(total);
    const view = new DataView(out.buffer);
    const words = [0x46546c67, 2, total, textLength, 0x4e4f534a]; // "glTF", its version, "JSON"
    words.forEach((word, i) => view.setUint32(4 * i, word, true));
    out.set(text, 20);
    out.fill(0x20, 20 + text.byteLength, 20 + textLength);
    if (binLength > 0) {
      let at = 20 + textLength;
      view.setUint32(at, binLength, true);
      view.setUint32(at + 4, 0x004e4942, true); // "BIN\0"
      at += 8;
      for (const chunk of this.#chunks) {
        out.set(chunk, at);
        at += chunk.byteLength;
      }
    }
    return out;
  }
}
