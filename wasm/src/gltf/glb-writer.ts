import type { GLTF } from '@gltf-transform/core';
import type { MeshoptEncoder } from 'meshoptimizer/encoder';
import { show } from '../core/error.js';
import { joinBytes, packGlb, paddedLength } from '../parts/glb.js';
import type { AccessorData, ArrayData } from '../scene/accessor.js';
import { InputError } from '../scene/input-error.js';
import { componentTypeOf } from './accessors.js';
import { type MeshoptView, meshoptExtensions, meshoptView } from './checks/check-geometry.js';
import { isDataUri, stemOf } from './data-uri.js';
import { imageType } from './image-file.js';
import { meshoptEncoder } from './meshopt.js';
import type { GltfFile } from './open-gltf.js';
import { type Contents, imageFile, type NamedFile, packGltf } from './output/pack-gltf.js';
import { subtract } from './output/ranges.js';
import { splitSparseViews } from './output/sparse-views.js';
import type { Paint } from './overlay.js';
import { sparseElements } from './primitive-group.js';
import { addedByTransfer, drop, eachAccessor, eachView, hasUnknownReferences, numbersOf } from './references.js';

const kArrayBuffer = 34962;
const kElementArrayBuffer = 34963;
const kClampToEdge = 33071;
/** The extensions by which textures have images that are neither PNG nor JPEG, by the media types of these. */
export const extensionsByType: Readonly<Record<string, string>> = {
  'image/webp': 'EXT_texture_webp',
  'image/ktx2': 'KHR_texture_basisu',
};
/** Media types of images that textures can have by extensions, by the endings of their files. */
const typesByEnding: Readonly<Record<string, string>> = { dds: 'image/vnd-ms.dds', avif: 'image/avif' };
const extensionLists = ['extensionsUsed', 'extensionsRequired'] as const;
const types = { 1: 'SCALAR', 2: 'VEC2', 3: 'VEC3', 4: 'VEC4' } as const;

/** How the geometry of written files is compressed: as that of the file that was read, or in another way. */
export const forms = ['keep', 'none', 'meshopt', 'draco'] as const;
export type Form = (typeof forms)[number];

/** What an accessor that was added holds. */
interface Stored {
  values: ArrayData;
  size: number;
  accessor: GLTF.IAccessor;
}

/** Pads the elements of an attribute, which begin at multiples of four bytes. */
function align(values: ArrayData, size: number): { aligned: ArrayData; byteStride?: number } {
  const perWord = 4 / values.BYTES_PER_ELEMENT;
  const stride = Math.ceil(size / perWord) * perWord;
  if (stride === size) return { aligned: values };
  const aligned = new (values.constructor as new (length: number) => ArrayData)((values.length / size) * stride);
  for (let i = 0; i < values.length; ++i) aligned[Math.floor(i / size) * stride + (i % size)] = values[i]!;
  return { aligned, byteStride: stride * values.BYTES_PER_ELEMENT };
}

const bytesOf = (values: ArrayData) => new Uint8Array(values.buffer, values.byteOffset, values.byteLength);

/**
 * Writes a GLB that has everything of a glTF file, with additions, and without what they replace.
 *
 * It works on the file's JSON and bytes, not on a decoded document. So all other contents stay unchanged, byte for byte, even those
 * that no library knows (extensions for avatars, extras, compressed data). If the file is compressed by meshopt, additions are, too.
 */
export class GlbWriter {
  /** The JSON of the file to be written; add to it freely. */
  readonly json: GLTF.IGLTF;
  /** Of the accessors and views that were read: those to be dropped once nothing refers to them, and how many keep their numbers. */
  readonly #before: Record<'accessors' | 'views', { droppable: Set<number>; count: number; fixed: number }>;
  /** What the buffers of the file hold, one after another. */
  #bytes = new Uint8Array(0);
  readonly #added = new Map<GLTF.IBufferView, Uint8Array>();
  readonly #stored = new Map<GLTF.IAccessor, Stored>();
  /** The name of the extension that compresses views. */
  readonly #meshopt: string | undefined;
  #encoder: typeof MeshoptEncoder | undefined;

  /** The accessors of the file, decoded. */
  readonly #decoded: AccessorData[];

  private constructor({ json, accessors }: GltfFile, form: Form) {
    this.json = structuredClone(json);
    this.#decoded = accessors;
    // Extensions may refer to all the others.
    const isKept = hasUnknownReferences(json);
    const known = isKept ? addedByTransfer(json) : json;
    const before = (droppable: Set<number>, { length: count }: unknown[] = []) => ({
      droppable,
      count,
      fixed: isKept ? count : 0,
    });
    this.#before = {
      accessors: before(numbersOf(eachAccessor, known), json.accessors),
      views: before(numbersOf(eachView, known), json.bufferViews),
    };
    const own = meshoptExtensions.find((name) => json.bufferViews?.some((view) => view.extensions?.[name]));
    this.#meshopt = form === 'keep' ? own : form === 'meshopt' ? (own ?? meshoptExtensions[0]) : undefined;
  }

  /**
   * Starts from a file: its buffers are joined into one, and images in separate files are embedded.
   * @throws {InputError} if such an image cannot be read.
   */
  static async from(file: GltfFile, form: Form): Promise<GlbWriter> {
    const writer = new GlbWriter(file, form);
    writer.#mergeBuffers(file.buffers);
    await writer.#embedImages(file);
    if (writer.#meshopt !== undefined) writer.#encoder = await meshoptEncoder();
    return writer;
  }

  #mergeBuffers(buffers: (Uint8Array | undefined)[]): void {
    const { json } = this;
    const chunks: Uint8Array[] = [];
    let length = 0;
    const offsets = buffers.map((bytes, b) => {
      if (!bytes) return 0;
      const offset = paddedLength(length);
      chunks.push(new Uint8Array(offset - length), bytes.subarray(0, json.buffers![b]!.byteLength));
      length = offset + json.buffers![b]!.byteLength;
      return offset;
    });
    this.#bytes = joinBytes(chunks);
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

  async #embedImages(file: GltfFile): Promise<void> {
    for (const [i, image] of (this.json.images ?? []).entries()) {
      if (image.uri === undefined) continue;
      const bytes = await file.readUri(`images[${i}]`, image.uri);
      const [, named, ending = ''] = /^data:([^;,]+)|\.(\w+)$/.exec(image.uri) ?? [];
      const mimeType = image.mimeType ?? imageType(bytes) ?? named ?? typesByEnding[ending.toLowerCase()];
      if (mimeType === undefined)
        throw new InputError(`images[${i}] (${show(image.uri)}) is of an unknown type; give it a mimeType`);
      // As in the glTF, where it is known by its file.
      if (!isDataUri(image.uri)) image.name ??= stemOf(image.uri);
      delete image.uri;
      image.mimeType = mimeType;
      image.bufferView = this.addView(bytes);
    }
  }

  /** Adds bytes. @returns the number of their view. */
  addView(bytes: Uint8Array, view: Partial<GLTF.IBufferView> = {}): number {
    const added = { buffer: 0, byteLength: bytes.byteLength, ...view };
    this.#added.set(added, bytes);
    return (this.json.bufferViews ??= []).push(added) - 1;
  }

  /**
   * Adds bytes of accessors, compressed if the file is.
   * @param mode  That of meshopt. `TRIANGLES` may turn triangles, so it is only for lists of them.
   */
  #addData(values: ArrayData, mode: 'ATTRIBUTES' | 'TRIANGLES' | 'INDICES', byteStride?: number): number {
    const bytes = bytesOf(values);
    const target = mode === 'ATTRIBUTES' ? kArrayBuffer : kElementArrayBuffer;
    const view = { target, ...(byteStride !== undefined && { byteStride }) };
    const name = this.#meshopt;
    const stride = byteStride ?? values.BYTES_PER_ELEMENT;
    // meshopt does not compress indices of one byte.
    if (name === undefined || bytes.byteLength === 0 || stride === 1) return this.addView(bytes, view);
    const count = bytes.byteLength / stride;
    const packed = this.#encoder!.encodeGltfBuffer(bytes, count, stride, mode, 0);
    const { buffer, byteOffset } = this.#standIn(bytes.byteLength);
    const compressed = { buffer: 0, byteLength: packed.byteLength, byteStride: stride, count, mode };
    return this.addView(packed, {
      buffer,
      byteOffset,
      byteLength: bytes.byteLength,
      ...view,
      extensions: { [name]: compressed },
    });
  }

  /** Room in the buffer that stands for uncompressed views, which has no bytes. */
  #standIn(length: number): { buffer: number; byteOffset: number } {
    const buffers = this.json.buffers!;
    if (buffers.length === 1)
      buffers.push({ byteLength: 0, extensions: { [this.#meshopt!]: { fallback: true } } } as GLTF.IBuffer);
    const byteOffset = paddedLength(buffers[1]!.byteLength);
    buffers[1]!.byteLength = byteOffset + length;
    return { buffer: 1, byteOffset };
  }

  /**
   * Adds a vertex attribute of `size` numbers per vertex.
   * @param maySparse  Whether only elements that are not 0 may be stored, where that takes fewer bytes.
   * @returns the number of its accessor.
   */
  addAttribute(values: ArrayData, size: number, more: Partial<GLTF.IAccessor> = {}, maySparse = false): number {
    const count = values.length / size;
    const accessor = {
      componentType: componentTypeOf(values),
      count,
      type: types[size as keyof typeof types],
      ...more,
    };
    const listed = maySparse && this.#meshopt === undefined ? sparseElements(values, size) : undefined;
    if (listed) return this.#addAccessor({ ...accessor, ...this.#sparse(values, size, listed) }, values, size);
    return this.#addAccessor({ ...accessor, bufferView: this.#addVertices(values, size) }, values, size);
  }

  /** Adds the bytes of a vertex attribute. @returns the number of their view. */
  #addVertices(values: ArrayData, size: number): number {
    const { aligned, byteStride } = align(values, size);
    const stride = byteStride ?? (this.#meshopt === undefined ? undefined : size * values.BYTES_PER_ELEMENT);
    return this.#addData(aligned, 'ATTRIBUTES', stride);
  }

  /** Stores some elements of an accessor; the others are 0. */
  #sparse(values: ArrayData, size: number, listed: Uint32Array): { sparse?: GLTF.IAccessorSparse } {
    if (listed.length === 0) return {};
    const indices = values.length / size <= 65536 ? Uint16Array.from(listed) : listed;
    const own = new (values.constructor as new (length: number) => ArrayData)(size * listed.length);
    listed.forEach((element, i) => own.set(values.subarray(size * element, size * (element + 1)), size * i));
    const sparse = {
      count: listed.length,
      indices: { bufferView: this.addView(bytesOf(indices)), componentType: componentTypeOf(indices) },
      values: { bufferView: this.addView(bytesOf(own)) },
    };
    return { sparse: sparse as unknown as GLTF.IAccessorSparse };
  }

  /** Adds the indices of triangles, as small as they can be. @returns the number of their accessor. */
  addIndices(indices: Uint32Array, vertexCount: number): number {
    // The largest value of a type is reserved.
    const values = vertexCount < 65536 ? Uint16Array.from(indices) : indices;
    const accessor = { componentType: componentTypeOf(values), count: indices.length, type: 'SCALAR' as const };
    return this.#addAccessor({ ...accessor, bufferView: this.#addData(values, 'TRIANGLES') }, values, 1);
  }

  #addAccessor(accessor: Omit<GLTF.IAccessor, 'max' | 'min'>, values: ArrayData, size: number): number {
    const added = accessor as GLTF.IAccessor;
    this.#stored.set(added, { values, size, accessor: added });
    return this.addAccessor(added);
  }

  /** Adds an accessor without bytes. @returns its number. */
  addAccessor(accessor: GLTF.IAccessor): number {
    return (this.json.accessors ??= []).push(accessor) - 1;
  }

  /** What an accessor holds, if it was added. */
  stored(accessor: number): Stored | undefined {
    return this.#stored.get(this.json.accessors![accessor]!);
  }

  /**
   * Adds a texture of an image file's bytes.
   * @param isClamped  Whether its border goes on outside of 0..1, instead of the whole texture once more.
   * @returns the number of the texture.
   */
  addTexture({ bytes, mimeType, name }: Paint, isClamped = false): number {
    const { json } = this;
    const source = (json.images ??= []).push({ bufferView: this.addView(bytes), mimeType, name }) - 1;
    const sampler = isClamped
      ? (json.samplers ??= []).push({ wrapS: kClampToEdge, wrapT: kClampToEdge }) - 1
      : undefined;
    const texture = { name, ...(sampler !== undefined && { sampler }) };
    const extension = extensionsByType[mimeType];
    if (extension === undefined) return (json.textures ??= []).push({ source, ...texture }) - 1;
    this.requireExtension(extension);
    return (json.textures ??= []).push({ ...texture, extensions: { [extension]: { source } } }) - 1;
  }

  /** Lists an extension as one without which the file cannot be shown. */
  requireExtension(name: string): void {
    for (const list of extensionLists) if (!this.json[list]?.includes(name)) (this.json[list] ??= []).push(name);
  }

  /** Takes an extension that nothing uses off the lists. */
  unlistExtension(name: string): void {
    const { json } = this;
    for (const list of extensionLists) {
      if (!json[list]?.includes(name)) continue;
      json[list] = json[list].filter((other) => other !== name);
      if (json[list].length === 0) delete json[list];
    }
  }

  /** Gives accessors views of their own that share one with accessors to which nothing refers any more. */
  #splitViews(): void {
    const { accessors = [] } = this.json;
    const used = numbersOf(eachAccessor, this.json);
    const isDropped = (a: number) => this.#before.accessors.droppable.has(a) && !used.has(a);
    const usersOf = new Map<number, number[]>();
    accessors.forEach(({ bufferView }, a) => {
      if (bufferView !== undefined) usersOf.set(bufferView, [...(usersOf.get(bufferView) ?? []), a]);
    });
    const references = new Map<number, number>();
    eachView(this.json, (owner, key) => references.set(owner[key]!, (references.get(owner[key]!) ?? 0) + 1));
    splitSparseViews(this.json, this.#bytes, { isDropped, references, addView: (bytes) => this.addView(bytes) });
    const primitives = (this.json.meshes ?? []).flatMap((mesh) => mesh.primitives);
    const indices = new Set(primitives.flatMap((primitive) => primitive.indices ?? []));
    const others = new Set(primitives.flatMap(({ mode = 4, indices }) => (mode === 4 ? [] : (indices ?? []))));
    const isTriangles = (a: number) => !others.has(a) && accessors[a]!.count % 3 === 0;
    const isVertices = numbersOf(eachAccessor, {
      ...this.json,
      skins: [],
      animations: [],
      nodes: [],
    } as unknown as GLTF.IGLTF);
    for (const [view, users] of usersOf) {
      if (!users.some(isDropped) || references.get(view) !== users.length) continue;
      const kept = users.filter((a) => !isDropped(a));
      if (kept.some((a) => accessors[a]!.sparse || a >= this.#decoded.length)) continue;
      for (const a of kept) {
        const values = this.#decoded[a]!.getArray()!;
        delete accessors[a]!.byteOffset;
        accessors[a]!.bufferView = indices.has(a)
          ? this.#addData(values, isTriangles(a) ? 'TRIANGLES' : 'INDICES')
          : isVertices.has(a)
            ? this.#addVertices(values, this.#decoded[a]!.getElementSize())
            : this.addView(bytesOf(values)); // of a skin or an animation
      }
    }
  }

  /**
   * Drops accessors and views that nothing refers to any more. Those to which nothing referred before stay. If extensions that are not
   * known here may refer to any, only what an earlier transfer added goes.
   */
  #dropUnused(): GLTF.IBufferView[] {
    const { json } = this;
    const all = [...(json.bufferViews ?? [])];
    for (const [list, each, { droppable, count, fixed }] of [
      [json.accessors, eachAccessor, this.#before.accessors],
      [json.bufferViews, eachView, this.#before.views],
    ] as const) {
      const used = numbersOf(each, json);
      const isDropped = (n: number) => !used.has(n) && (n >= count || droppable.has(n));
      drop<unknown>(list ?? [], isDropped, (visit) => each(json, visit), fixed);
    }
    for (const name of meshoptExtensions) {
      const users = json.bufferViews?.filter((view) => view.extensions?.[name]) ?? [];
      if (users.some((view) => this.#added.has(view))) this.requireExtension(name);
      else if (users.length === 0 && all.some((view) => view.extensions?.[name])) this.unlistExtension(name);
    }
    // The buffer that stands for uncompressed views goes with the last of them.
    if (
      json.buffers!.length === 2 &&
      all.some(({ buffer }) => buffer === 1) &&
      !json.bufferViews?.some(({ buffer }) => buffer === 1)
    )
      json.buffers!.pop();
    const kept = new Set(json.bufferViews);
    return all.filter((view) => !kept.has(view));
  }

  /** The bytes of the GLB. */
  finish(): Uint8Array {
    const { json, chunks } = this.#contents([]);
    return packGlb(json, chunks);
  }

  /** The text of a glTF, and what belongs beside it. @param stem  How its file is named, without the ending. */
  finishText(stem: string): { text: Uint8Array; beside: NamedFile[] } {
    return packGltf(this.#contents(this.#takeImages(stem)), stem);
  }

  /** Takes images out of the buffer, which get files of their own. */
  #takeImages(stem: string): Contents['images'] {
    return (this.json.images ?? []).flatMap((image, i) => {
      const view = image.bufferView === undefined ? undefined : this.json.bufferViews![image.bufferView]!;
      if (view === undefined) return [];
      const { byteOffset = 0, byteLength } = view;
      const bytes = this.#added.get(view) ?? this.#bytes.subarray(byteOffset, byteOffset + byteLength);
      const name = imageFile(stem, i, image.mimeType);
      delete image.bufferView;
      image.uri = encodeURIComponent(name);
      return [{ name, bytes }];
    });
  }

  #contents(images: Contents['images']): Contents {
    const { json } = this;
    this.#splitViews();
    const dropped = this.#dropUnused();
    const chunks = this.#cutOut(dropped.filter((view) => !this.#added.has(view)));
    let length = chunks.reduce((sum, { byteLength }) => sum + byteLength, 0);
    for (const view of json.bufferViews ?? []) {
      const bytes = this.#added.get(view);
      if (bytes === undefined) continue;
      const byteOffset = paddedLength(length);
      chunks.push(new Uint8Array(byteOffset - length), bytes);
      length = byteOffset + bytes.byteLength;
      (meshoptView(view) ?? view).byteOffset = byteOffset;
    }
    chunks.push(new Uint8Array(paddedLength(length) - length));
    if (length > 0) json.buffers![0]!.byteLength = length;
    else json.buffers!.shift();
    for (const name of ['accessors', 'bufferViews', 'buffers'] as const)
      if (json[name]?.length === 0) delete json[name];
    return { json, chunks, images };
  }

  /** The bytes of the file without those of some views; moves the others to where their bytes are then. */
  #cutOut(views: readonly GLTF.IBufferView[]): Uint8Array[] {
    const rangeOf = (view: GLTF.IBufferView | MeshoptView): [number, number] => {
      const { byteOffset = 0, byteLength } = view;
      return view.buffer === 0 ? [byteOffset, byteOffset + byteLength] : [0, 0];
    };
    const rangesOf = (list: readonly GLTF.IBufferView[]) => list.map((view) => rangeOf(meshoptView(view) ?? view));
    const kept = (this.json.bufferViews ?? []).filter((view) => !this.#added.has(view));
    // With the bytes that pad a view to a whole number of words.
    const padded = rangesOf(views).map(([first, end]): [number, number] => [first, paddedLength(end)]);
    const removed = subtract(padded, rangesOf(kept)).map(([first, end]) => [paddedLength(first), end - (end % 4)]);
    const chunks: Uint8Array[] = [];
    let from = 0;
    for (const [first, end] of removed) {
      if (end! <= first!) continue;
      chunks.push(this.#bytes.subarray(from, first));
      from = end!;
    }
    chunks.push(this.#bytes.subarray(from));
    for (const view of kept) {
      for (const one of [view, meshoptView(view)]) {
        if (one?.byteOffset === undefined || one.buffer !== 0) continue;
        const gone = removed.reduce(
          (sum, [first, end]) => sum + (end! <= one.byteOffset! ? Math.max(0, end! - first!) : 0),
          0,
        );
        one.byteOffset -= gone;
      }
    }
    return chunks;
  }
}
