import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import type { Accessor, GLTF, Primitive } from '@gltf-transform/core';
import type { Mesh, TransferResult } from 'cagecast';

/** A GLB taken apart. */
export interface Glb {
  json: GLTF.IGLTF;
  bin: Uint8Array;
}

/** Puts a GLB together. */
export function packGlb({ json, bin }: Glb): Uint8Array {
  const text = Buffer.from(JSON.stringify(json));
  const pad = (length: number) => (4 - (length % 4)) % 4;
  const chunks = [
    { type: 0x4e4f534a, data: Buffer.concat([text, Buffer.alloc(pad(text.length), 0x20)]) },
    { type: 0x004e4942, data: Buffer.concat([bin, Buffer.alloc(pad(bin.length))]) },
  ].filter(({ data }) => data.length > 0);
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

  finish(): Uint8Array {
    if (this.#length > 0) this.json.buffers![0]!.byteLength = this.#length;
    return packGlb({ json: this.json, bin: Buffer.concat(this.#bytes) });
  }
}

function bound(values: Values, pick: (...values: number[]) => number): number[] {
  return [0, 1, 2].map((k) =>
    Array.from(values as ArrayLike<number>)
      .filter((_, i) => i % 3 === k)
      .reduce((a, b) => pick(a, b)),
  );
}

/** A GLB of one mesh. */
export function glbOf(mesh: Mesh): Uint8Array {
  const maker = new GlbMaker();
  maker.node({ mesh: maker.mesh(mesh), name: 'only' });
  return maker.finish();
}

/** Runs the command. */
export function cagecast(...args: string[]): { status: number | null; stdout: string; stderr: string } {
  const { status, stdout, stderr } = spawnSync(process.execPath, ['dist/cli.js', ...args], { encoding: 'utf8' });
  return { status, stdout, stderr };
}

/** Errors of the Khronos validator about a file. */
export async function validate(path: string): Promise<string[]> {
  const validator = createRequire(import.meta.url)('gltf-validator') as {
    validateBytes(
      bytes: Uint8Array,
      options: object,
    ): Promise<{ issues: { messages: { severity: number; code: string; message: string; pointer: string }[] } }>;
  };
  const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(path)), { maxIssues: 100 });
  return issues.messages
    .filter(({ severity }) => severity === 0)
    .map(({ code, message, pointer }) => `${pointer}: ${code}: ${message}`);
}

/**
 * Asserts that a primitive has what was transferred to it: the UV and the zone of each corner; and what it had before: its
 * vertices in their order, with copies after them that are like their sources in all attributes and morph targets.
 * @param first  Where the primitive begins in the arrays of the result.
 * @returns how many vertices were added.
 */
export function assertTransferred(
  before: Primitive,
  written: Primitive,
  result: TransferResult,
  first = { vertex: 0, triangle: 0 },
): number {
  const vertices = before.getAttribute('POSITION')!.getCount();
  const all = written.getAttribute('POSITION')!.getCount();
  const cornersOf = (primitive: Primitive) =>
    [
      ...(primitive.getIndices()?.getArray() ?? Array(primitive.getAttribute('POSITION')!.getCount()).keys()),
    ] as number[];
  const [old, corners] = [cornersOf(before), cornersOf(written)];
  assert.equal(corners.length, old.length);
  const sources = Array.from({ length: all }, (_, v) => v);
  corners.forEach((vertex, i) => {
    if (vertex < vertices) assert.equal(vertex, old[i]);
    else sources[vertex] = old[i]!;
  });

  const uvSet = written
    .listSemantics()
    .find((name) => name.startsWith('TEXCOORD_') && before.getAttribute(name) === null);
  assert.ok(uvSet);
  const [uvs, zones] = [written.getAttribute(uvSet)!.getArray()!, written.getAttribute('_NCZ')!.getArray()!];
  corners.forEach((vertex, i) => {
    const at = result.cornerUvs.length > 0 ? 2 * (3 * first.triangle + i) : -1;
    const expected =
      at >= 0
        ? result.cornerUvs.subarray(at, at + 2)
        : result.uvs.subarray(2 * (first.vertex + vertex), 2 * (first.vertex + vertex) + 2);
    assert.deepEqual(
      [uvs[2 * vertex]! + 0, uvs[2 * vertex + 1]! + 0],
      [expected[0]! + 0, expected[1]! + 0],
      `corner ${i}`,
    );
  });
  assert.deepEqual(
    [...zones],
    sources.map((v) => result.zones[first.vertex + v]),
  );

  const sameAs = (a: Accessor, b: Accessor, name: string) => {
    assert.equal(b.getNormalized(), a.getNormalized(), name);
    const size = a.getElementSize();
    const [from, to] = [a.getArray()!, b.getArray()!];
    assert.equal(to.constructor, from.constructor, name);
    assert.equal(to.length, size * all, name);
    sources.forEach((source, v) =>
      assert.deepEqual(
        to.subarray(size * v, size * (v + 1)),
        from.subarray(size * source, size * (source + 1)),
        `${name} of vertex ${v}`,
      ),
    );
  };
  for (const name of before.listSemantics()) sameAs(before.getAttribute(name)!, written.getAttribute(name)!, name);
  before.listTargets().forEach((target, t) => {
    for (const name of target.listSemantics())
      sameAs(target.getAttribute(name)!, written.listTargets()[t]!.getAttribute(name)!, `target ${t}: ${name}`);
  });
  return all - vertices;
}
