import type { GLTF } from '@gltf-transform/core';
import type { Mesh } from 'cagecast';

/** A GLB taken apart. */
export interface Glb {
  json: GLTF.IGLTF;
  bin: Uint8Array;
}

/** Puts a GLB together. */
export function packGlb({ json, bin }: Glb): Buffer {
  const text = Buffer.from(JSON.stringify(json));
  const pad = (length: number) => (4 - (length % 4)) % 4;
  const chunks = [
    { type: 0x4e4f534a, data: Buffer.concat([text, Buffer.alloc(pad(text.length), 0x20)]) },
    { type: 0x004e4942, data: Buffer.concat([bin, Buffer.alloc(pad(bin.length))]) },
  ].filter(({ data }) => data.length > 0 || json.bufferViews?.length);
  const words = (...values: number[]) => Buffer.from(new Uint32Array(values).buffer);
  const body = Buffer.concat(chunks.flatMap(({ type, data }) => [words(data.length, type), data]));
  return Buffer.concat([words(0x46546c67, 2, 12 + body.length), body]);
}

/** Takes a GLB apart. */
export function unpackGlb(bytes: Uint8Array): Glb {
  const buffer = Buffer.from(bytes);
  const textLength = buffer.readUInt32LE(12);
  const json = JSON.parse(buffer.toString('utf8', 20, 20 + textLength)) as GLTF.IGLTF;
  const at = 20 + textLength;
  return {
    json,
    bin:
      at < buffer.length ? new Uint8Array(buffer.subarray(at + 8, at + 8 + buffer.readUInt32LE(at))) : new Uint8Array(),
  };
}

type Values = Float32Array | Uint32Array | Uint16Array | Int16Array | Uint8Array | Int8Array;
const componentTypes = {
  Int8Array: 5120,
  Uint8Array: 5121,
  Int16Array: 5122,
  Uint16Array: 5123,
  Uint32Array: 5125,
  Float32Array: 5126,
};

/** Makes a GLB by hand, so that a test can put into it what no exporter would. */
export class GlbMaker {
  json: GLTF.IGLTF & {
    accessors: GLTF.IAccessor[];
    bufferViews: GLTF.IBufferView[];
    meshes: GLTF.IMesh[];
    nodes: GLTF.INode[];
  } = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [] }],
    nodes: [],
    meshes: [],
    accessors: [],
    bufferViews: [],
    buffers: [{ byteLength: 0 }],
  };
  #bytes: Buffer[] = [];
  #length = 0;

  view(bytes: Uint8Array, more: object = {}): number {
    const byteOffset = this.#length;
    const padded = Buffer.concat([bytes, Buffer.alloc((4 - (bytes.byteLength % 4)) % 4)]);
    this.#bytes.push(padded);
    this.#length += padded.length;
    return (
      this.json.bufferViews.push({ buffer: 0, byteOffset, byteLength: bytes.byteLength, ...more } as GLTF.IBufferView) -
      1
    );
  }

  accessor(values: Values, type: 'SCALAR' | 'VEC2' | 'VEC3' | 'VEC4' | 'MAT4', more: object = {}): number {
    const size = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 }[type];
    const bufferView = this.view(new Uint8Array(values.buffer, values.byteOffset, values.byteLength));
    const bounds = type === 'VEC3' ? { min: bound(values, Math.min), max: bound(values, Math.max) } : {};
    const componentType = componentTypes[values.constructor.name as keyof typeof componentTypes];
    return (
      this.json.accessors.push({
        bufferView,
        componentType,
        count: values.length / size,
        type,
        ...bounds,
        ...more,
      } as GLTF.IAccessor) - 1
    );
  }

  /** Adds a mesh of one primitive. @returns its number. */
  mesh({ positions, indices, uvs }: Mesh, more: Partial<GLTF.IMeshPrimitive> = {}): number {
    const attributes = {
      POSITION: this.accessor(positions, 'VEC3'),
      ...(uvs && { TEXCOORD_0: this.accessor(uvs, 'VEC2') }),
    };
    return (
      this.json.meshes.push({ primitives: [{ attributes, indices: this.accessor(indices, 'SCALAR'), ...more }] }) - 1
    );
  }

  /** Adds a node to the scene. @returns its number. */
  node(node: GLTF.INode, root = true): number {
    const number = this.json.nodes.push(node) - 1;
    if (root) this.json.scenes![0]!.nodes!.push(number);
    return number;
  }

  finish(): Buffer {
    if (this.#length > 0) this.json.buffers![0]!.byteLength = this.#length;
    return packGlb({ json: this.json, bin: Buffer.concat(this.#bytes) });
  }
}

function bound(values: Values, pick: (...values: number[]) => number): number[] {
  return [0, 1, 2].map((k) =>
    Array.from(values as ArrayLike<number>)
      .filter((_, i) => i % 3 === k)
      .reduce((a, b) => pick(a, b), pick()),
  );
}

/** A mesh for a GLB; tests may put wrong data into it. */
export interface RawMesh extends Mesh {
  /** glTF's primitive mode: 0 points, 4 triangles (the default). */
  mode?: number;
}

/** A GLB of one mesh in one node. */
export function glbOf({ mode, ...mesh }: RawMesh, name = 'only'): Buffer {
  const maker = new GlbMaker();
  maker.node({ mesh: maker.mesh(mesh, mode === undefined ? {} : { mode: mode as GLTF.MeshPrimitiveMode }), name });
  return maker.finish();
}

/** A tetrahedron around the origin with corners at distance `size`; counter-clockwise seen from outside. */
export function tetrahedron(size = 1): { positions: Float32Array; indices: Uint16Array; uvs: Float32Array } {
  const corners = [1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1].map((value) => (value * size) / Math.sqrt(3));
  return {
    positions: Float32Array.from(corners),
    indices: Uint16Array.of(0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3),
    uvs: Float32Array.of(0, 0, 1, 0, 0, 1, 1, 1),
  };
}
