import type { Upload } from './site';

/** What goes into a GLB: one mesh, as raw as the test wants it. */
export interface RawMesh {
  positions: Float32Array;
  indices: Uint16Array;
  uvs?: Float32Array;
  /** What its indices join, as glTF has it: 0 points, 4 triangles, which they are unless it says so. */
  mode?: number;
}

/** Writes a GLB without looking at what is in it, so that it may be wrong. */
export function writeGlb({ positions, indices, uvs, mode = 4 }: RawMesh): Buffer {
  const arrays = [positions, indices, ...(uvs ? [uvs] : [])];
  let byteOffset = 0;
  const bufferViews = arrays.map(({ byteLength }) => {
    const view = { buffer: 0, byteOffset, byteLength };
    byteOffset += Math.ceil(byteLength / 4) * 4;
    return view;
  });
  const accessors = [
    {
      bufferView: 0,
      componentType: 5126,
      count: positions.length / 3,
      type: 'VEC3',
      min: [-1, -1, -1],
      max: [1, 1, 1],
    },
    { bufferView: 1, componentType: 5123, count: indices.length, type: 'SCALAR' },
    ...(uvs ? [{ bufferView: 2, componentType: 5126, count: uvs.length / 2, type: 'VEC2' }] : []),
  ];
  const attributes = { POSITION: 0, ...(uvs && { TEXCOORD_0: 2 }) };
  const json = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, name: 'thing' }],
    meshes: [{ primitives: [{ attributes, indices: 1, mode }] }],
    accessors,
    bufferViews,
    buffers: [{ byteLength: byteOffset }],
  };
  const data = Buffer.alloc(byteOffset);
  arrays.forEach((array, i) =>
    Buffer.from(array.buffer, array.byteOffset, array.byteLength).copy(data, bufferViews[i]!.byteOffset),
  );
  const text = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
  const words = (...values: number[]): Buffer => Buffer.from(Uint32Array.from(values).buffer);
  const length = 12 + 8 + padded.length + 8 + data.length;
  return Buffer.concat([
    words(0x46546c67, 2, length),
    words(padded.length, 0x4e4f534a),
    padded,
    words(data.length, 0x004e4942),
    data,
  ]);
}

/** A tetrahedron about the origin with corners at distance `size`; counter-clockwise seen from outside. */
export function tetrahedron(size = 1): Required<Omit<RawMesh, 'mode'>> {
  const corners = [1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1].map((value) => (value * size) / Math.sqrt(3));
  return {
    positions: Float32Array.from(corners),
    indices: Uint16Array.of(0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3),
    uvs: Float32Array.of(0, 0, 1, 0, 0, 1, 1, 1),
  };
}

/** A GLB to give to the page. */
export function glb(name: string, buffer: Buffer): Upload {
  return { name, mimeType: 'model/gltf-binary', buffer };
}
