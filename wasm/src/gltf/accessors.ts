import type { GLTF } from '@gltf-transform/core';
import type { AccessorData, ArrayData } from '../scene/accessor.js';
import { InputError } from '../scene/input-error.js';
import { dracoOf, type MeshoptView, meshoptView } from './checks/check-geometry.js';
import type { Decoders } from './decoders.js';
import { decodeStreams } from './draco.js';
import { meshoptDecoder } from './meshopt.js';

/** The component type of an array. */
export function componentTypeOf(values: ArrayData): GLTF.AccessorComponentType {
  if (values instanceof Int8Array) return 5120;
  if (values instanceof Uint8Array) return 5121;
  if (values instanceof Int16Array) return 5122;
  if (values instanceof Uint16Array) return 5123;
  return values instanceof Uint32Array ? 5125 : 5126;
}

/** By component types. */
const arrays: Record<number, new (length: number) => ArrayData> = {
  5120: Int8Array,
  5121: Uint8Array,
  5122: Int16Array,
  5123: Uint16Array,
  5125: Uint32Array,
  5126: Float32Array,
};
const sizes = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT2: 4, MAT3: 9, MAT4: 16 } as const;

/**
 * Decodes the accessors of a glTF whose references are checked: sparse, interleaved, or compressed by meshopt or Draco.
 * @param buffers   The bytes of each buffer, if it has any.
 * @param decoders  Default: meshopt's own, and none of Draco.
 * @throws {InputError} for what Draco compresses, without its decoder.
 */
export async function decodeAccessors(
  { accessors = [], bufferViews = [], meshes = [] }: GLTF.IGLTF,
  buffers: readonly (Uint8Array | undefined)[],
  { meshopt = meshoptDecoder, draco = refuseDraco }: Decoders = {},
): Promise<AccessorData[]> {
  const views = await decodeViews(bufferViews, buffers, meshopt);
  const isDraco = meshes.some(({ primitives }) => primitives.some(dracoOf));
  const streams = isDraco ? decodeStreams(await draco(), { accessors, meshes }, (view) => views[view]!) : undefined;
  return accessors.map((accessor, a) => {
    const size = sizes[accessor.type];
    const values = streams?.get(a) ?? new arrays[accessor.componentType]!(size * accessor.count);
    const { bufferView, byteOffset = 0, sparse } = accessor;
    if (bufferView !== undefined)
      copyElements(views[bufferView]!, { byteOffset, byteStride: bufferViews[bufferView]!.byteStride }, values, size);
    if (sparse) {
      const places = new arrays[sparse.indices.componentType]!(sparse.count);
      const own = new arrays[accessor.componentType]!(size * sparse.count);
      copyElements(views[sparse.indices.bufferView]!, sparse.indices, places, 1);
      copyElements(views[sparse.values.bufferView]!, sparse.values, own, size);
      places.forEach((place, i) => values.set(own.subarray(size * i, size * (i + 1)), size * place));
    }
    return {
      getArray: () => values,
      getCount: () => values.length / size,
      getElementSize: () => size,
      getType: () => accessor.type,
      getNormalized: () => accessor.normalized ?? false,
    };
  });
}

async function refuseDraco(): Promise<never> {
  throw new InputError(
    'its geometry is compressed by Draco, whose decoder has to be given; the command has it, and glTF-Transform can write it without',
  );
}

/** Copies elements out of the bytes of a view. */
function copyElements(
  view: Uint8Array,
  { byteOffset = 0, byteStride }: { byteOffset?: number; byteStride?: number | undefined },
  values: ArrayData,
  size: number,
): void {
  const out = new Uint8Array(values.buffer);
  const length = size * values.BYTES_PER_ELEMENT;
  const stride = byteStride ?? length;
  if (stride === length) out.set(view.subarray(byteOffset, byteOffset + out.length));
  else
    for (let to = 0, from = byteOffset; to < out.length; to += length, from += stride)
      out.set(view.subarray(from, from + length), to);
}

/** The bytes of each view, decompressed. */
async function decodeViews(
  views: readonly GLTF.IBufferView[],
  buffers: readonly (Uint8Array | undefined)[],
  meshopt: NonNullable<Decoders['meshopt']>,
): Promise<Uint8Array[]> {
  const bytesOf = ({ buffer, byteOffset = 0, byteLength }: Pick<MeshoptView, 'buffer' | 'byteOffset' | 'byteLength'>) =>
    buffers[buffer]?.subarray(byteOffset, byteOffset + byteLength) ?? new Uint8Array(0);
  if (!views.some(meshoptView)) return views.map(bytesOf);
  const decoder = await meshopt();
  return views.map((view) => {
    const compressed = meshoptView(view);
    if (!compressed) return bytesOf(view);
    const { count, byteStride, mode, filter } = compressed;
    const bytes = new Uint8Array(count * byteStride);
    decoder.decodeGltfBuffer(bytes, count, byteStride, bytesOf(compressed), mode, filter);
    return bytes;
  });
}
