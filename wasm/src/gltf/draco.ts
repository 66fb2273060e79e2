import type { GLTF } from '@gltf-transform/core';
import type { DataType, DecoderModule, Mesh } from 'draco3dgltf';
import type { ArrayData } from '../scene/accessor.js';
import { dracoOf } from './checks/check-geometry.js';

/** Numbers of an element of an accessor. */
const kSizes: Record<GLTF.AccessorType, number> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT2: 4, MAT3: 9, MAT4: 16 };

/**
 * Decodes all streams of Draco of a glTF whose references are checked.
 * @param bytesOf  Of a buffer view.
 * @returns the values of those accessors that are in streams. They may have other counts than the file says.
 * @throws Error for a damaged stream.
 */
export function decodeStreams(
  draco: unknown,
  { accessors, meshes }: { accessors: readonly GLTF.IAccessor[]; meshes: readonly GLTF.IMesh[] },
  bytesOf: (view: number) => Uint8Array,
): Map<number, ArrayData> {
  const module = draco as DecoderModule;
  const values = new Map<number, ArrayData>();
  const [decoder, meshOf] = [new module.Decoder(), new Map<number, Mesh>()];
  try {
    for (const primitive of meshes.flatMap(({ primitives }) => primitives)) {
      const stream = dracoOf(primitive);
      if (!stream) continue;
      const mesh = meshOf.get(stream.bufferView) ?? decodeMesh(module, bytesOf(stream.bufferView));
      meshOf.set(stream.bufferView, mesh);
      const { indices, attributes } = primitive;
      if (indices !== undefined && !values.has(indices))
        values.set(
          indices,
          read(module, Uint32Array, 3 * mesh.num_faces(), (bytes, at) =>
            decoder.GetTrianglesUInt32Array(mesh, bytes, at),
          ),
        );
      for (const [semantic, id] of Object.entries(stream.attributes)) {
        const accessor = attributes[semantic];
        if (accessor === undefined || values.has(accessor)) continue;
        const attribute = decoder.GetAttributeByUniqueId(mesh, id);
        const [kind, type] = typeOf(module, accessors[accessor]!.componentType);
        const size = kSizes[accessors[accessor]!.type];
        // Without such an attribute the pointer is null.
        const isThere = (module as unknown as { getPointer(of: object): number }).getPointer(attribute) !== 0;
        if (!isThere || attribute.num_components() !== size)
          throw new Error(`Draco: a stream has no ${semantic} of ${size} numbers`);
        const count = mesh.num_points() * size;
        values.set(
          accessor,
          read(module, kind, count, (bytes, at) =>
            decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, type, bytes, at),
          ),
        );
      }
    }
    return values;
  } finally {
    for (const mesh of meshOf.values()) module.destroy(mesh);
    module.destroy(decoder);
  }
}

function decodeMesh(module: DecoderModule, bytes: Uint8Array): Mesh {
  const [decoder, buffer, mesh] = [new module.Decoder(), new module.DecoderBuffer(), new module.Mesh()];
  try {
    buffer.Init(bytes as unknown as Int8Array, bytes.length);
    const isOfTriangles = decoder.GetEncodedGeometryType(buffer) === module.TRIANGULAR_MESH;
    if (isOfTriangles && decoder.DecodeBufferToMesh(buffer, mesh).ok()) return mesh;
  } finally {
    module.destroy(buffer);
    module.destroy(decoder);
  }
  module.destroy(mesh);
  throw new Error('Draco: a stream is damaged, or not one of triangles');
}

type ArrayKind = { new (buffer: ArrayBuffer, at: number, length: number): ArrayData; BYTES_PER_ELEMENT: number };

/** Reads an array out of the memory of Draco. */
function read(
  module: DecoderModule,
  kind: ArrayKind,
  length: number,
  fill: (bytes: number, at: number) => unknown,
): ArrayData {
  const bytes = length * kind.BYTES_PER_ELEMENT;
  const at = module._malloc(bytes);
  try {
    if ((at === 0 && bytes > 0) || fill(bytes, at) === false) throw new Error('Draco: a stream cannot be read');
    return new kind(module.HEAPF32.buffer as ArrayBuffer, at, length).slice();
  } finally {
    module._free(at);
  }
}

/** The array and Draco's name of a component type. */
function typeOf(module: DecoderModule, type: GLTF.AccessorComponentType): [ArrayKind, DataType] {
  switch (type) {
    case 5120:
      return [Int8Array, module.DT_INT8];
    case 5121:
      return [Uint8Array, module.DT_UINT8];
    case 5122:
      return [Int16Array, module.DT_INT16];
    case 5123:
      return [Uint16Array, module.DT_UINT16];
    case 5125:
      return [Uint32Array, module.DT_UINT32];
    default:
      return [Float32Array, module.DT_FLOAT32];
  }
}
