// Files of less than a megabyte that would cost a viewer gigabytes or minutes, each in another way.
import { deflateSync } from 'node:zlib';
import type { GLTF } from '@gltf-transform/core';
import { type Glb, glbOf, packGlb, tetrahedron, unpackGlb } from '../glb';

/** Changes the GLB of a tetrahedron, whose positions, UVs and indices are accessors 0, 1 and 2. */
export function changedGlb(change: (json: Required<GLTF.IGLTF>, glb: Glb) => void): Buffer {
  const glb = unpackGlb(glbOf(tetrahedron(0.9), 'ball'));
  change(glb.json as Required<GLTF.IGLTF>, glb);
  return packGlb(glb);
}

/** As many times the same. */
const times = <Item>(count: number, make: (at: number) => Item): Item[] =>
  Array.from({ length: count }, (_, at) => make(at));

/** Adds bytes to the file. @returns the view that has them. */
function addView({ json, bin }: Glb, bytes: Uint8Array, glb: Glb): number {
  const byteOffset = 4 * Math.ceil(bin.length / 4);
  glb.bin = new Uint8Array(Buffer.concat([bin, Buffer.alloc(byteOffset - bin.length), bytes]));
  json.buffers![0]!.byteLength = glb.bin.length;
  return json.bufferViews!.push({ buffer: 0, byteOffset, byteLength: bytes.length }) - 1;
}

/** Gives the mesh as many vertices, which are in the file: normalised bytes. */
function enlarge(glb: Glb, count: number): void {
  const view = addView(
    glb,
    new Uint8Array(4 * count).map((_, at) => at * at * 37),
    glb,
  );
  glb.json.bufferViews![view]!.byteStride = 4;
  Object.assign(glb.json.accessors![0]!, {
    bufferView: view,
    byteOffset: 0,
    componentType: 5120,
    normalized: true,
    count,
    min: [-1, -1, -1],
    max: [1, 1, 1],
  });
  Object.assign(glb.json.accessors![1]!, {
    bufferView: view,
    byteOffset: 0,
    componentType: 5121,
    normalized: true,
    count,
  });
  for (const name of ['extensionsUsed', 'extensionsRequired'] as const) glb.json[name] = ['KHR_mesh_quantization'];
}

/** Gives the mesh a material that shows an image. */
function paintWith(glb: Glb, image: Uint8Array, mimeType: string, extension?: string): void {
  const { json } = glb;
  json.images = [{ bufferView: addView(glb, image, glb), mimeType }];
  json.textures = [extension ? { extensions: { [extension]: { source: 0 } } } : { source: 0 }];
  json.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
  json.meshes![0]!.primitives[0]!.material = 0;
  if (extension) json.extensionsUsed = [extension];
}

/** A grey PNG of as many pixels, all black. */
export function pngOf(width: number, height: number, bits = 1): Buffer {
  const crcs = times(256, (n) => times(8, (k) => k).reduce((c) => (c & 1 ? (c >>> 1) ^ 0xedb88320 : c >>> 1), n));
  const chunk = (type: string, data: Buffer) => {
    const body = Buffer.concat([Buffer.from(type, 'latin1'), data]);
    const all = Buffer.alloc(body.length + 8);
    all.writeUInt32BE(data.length);
    body.copy(all, 4);
    let crc = 0xffffffff;
    for (const byte of body) crc = crcs[(crc ^ byte) & 255]! ^ (crc >>> 8);
    all.writeUInt32BE((crc ^ 0xffffffff) >>> 0, body.length + 4);
    return all;
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width);
  head.writeUInt32BE(height, 4);
  head[8] = bits;
  const rows = deflateSync(Buffer.alloc((1 + Math.ceil((width * bits) / 8)) * height), { level: 9 });
  const begin = Buffer.from([0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10]);
  return Buffer.concat([begin, chunk('IHDR', head), chunk('IDAT', rows), chunk('IEND', Buffer.alloc(0))]);
}

/** A JPEG that says to have as many pixels, of which it has the first. */
export function jpegOf(width: number, height: number): Buffer {
  const frame = [0xff, 0xc0, 0, 11, 8, height >> 8, height & 255, width >> 8, width & 255, 1, 1, 0x11, 0];
  const quantisation = [0xff, 0xdb, 0, 67, 0, ...times(64, () => 1)];
  const table = (kind: number) => [0xff, 0xc4, 0, 20, kind, 1, ...times(15, () => 0), 0];
  const scan = [0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0, ...times(2000, () => 0)];
  return Buffer.from([0xff, 0xd8, ...quantisation, ...frame, ...table(0), ...table(0x10), ...scan, 0xff, 0xd9]);
}

/** The beginning of a lossless WebP of as many pixels. */
export function webpOf(width: number, height: number): Buffer {
  const bytes = Buffer.alloc(64);
  bytes.write('RIFF');
  bytes.writeUInt32LE(56, 4);
  bytes.write('WEBPVP8L', 8);
  bytes.writeUInt32LE(44, 16);
  bytes[20] = 0x2f;
  bytes.writeUInt32LE(((width - 1) | ((height - 1) << 14)) >>> 0, 21);
  return bytes;
}

/** The beginning of a KTX2 file of as many pixels, by Basis Universal. */
export function ktx2Of(width: number, height: number): Buffer {
  const bytes = Buffer.alloc(256);
  Buffer.from([0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb, 13, 10, 26, 10]).copy(bytes);
  [0, 1, width, height, 0, 0, 1, 1, 1].forEach((value, at) => bytes.writeUInt32LE(value, 12 + 4 * at));
  bytes.writeBigUInt64LE(128n, 80);
  bytes.writeBigUInt64LE(64n, 88);
  bytes.writeBigUInt64LE(2n ** 30n, 96);
  return bytes;
}

/**
 * A binary FBX with an array of as many bytes, all zero, which are hardly any once they are compressed.
 * @param said  Its length in the file.
 * @param hasLengths  Whether records say how long their properties are.
 */
export function fbxOfZeros(bytes: number, said = bytes / 8, hasLengths = true): Buffer {
  const word = (value: number) => Buffer.from(new Uint32Array([value]).buffer);
  const packed = deflateSync(Buffer.alloc(bytes), { level: 9 });
  const array = Buffer.concat([Buffer.from('d'), word(said), word(1), word(packed.length), packed]);
  const record = (
    name: string,
    at: number,
    properties: readonly Buffer[],
    inner: (at: number) => Buffer = () => none,
  ) => {
    const length = properties.reduce((sum, one) => sum + one.length, 0);
    const begin = at + 13 + name.length + length;
    const body = inner(begin);
    const listed = word(hasLengths ? length : 0);
    const head = [word(begin + body.length), word(properties.length), listed, Buffer.from([name.length])];
    return Buffer.concat([...head, Buffer.from(name), ...properties, body]);
  };
  const none = Buffer.alloc(0);
  const start = Buffer.concat([Buffer.from('Kaydara FBX Binary  \0\x1a\0', 'latin1'), word(7400)]);
  const objects = record('Objects', start.length, [], (at) =>
    Buffer.concat([
      record('Geometry', at, [], (inside) => Buffer.concat([record('Vertices', inside, [array]), Buffer.alloc(13)])),
      Buffer.alloc(13),
    ]),
  );
  return Buffer.concat([start, objects, Buffer.alloc(13 + 160)]);
}

/** By what is costly: the file, and what it is refused with, unless it is shown all the same. */
export const costlyFiles: Record<string, { bytes: () => Buffer; refusal?: RegExp }> = {
  'two million instances drawn by the graphics card, whose places are not in the file': {
    bytes: () =>
      changedGlb((json) => {
        const places = json.accessors.push({ componentType: 5126, type: 'VEC3', count: 2_000_000 }) - 1;
        json.nodes[0]!.extensions = { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION: places } } };
        json.extensionsUsed = ['EXT_mesh_gpu_instancing'];
      }),
    refusal:
      /accessors\[\d\] \(nodes\[0\], EXT_mesh_gpu_instancing\) has 2,000,000 elements that are not in the file; the limit "implied"/,
  },
  'hundreds of thousands of instances drawn by the graphics card': {
    bytes: () =>
      changedGlb((json, glb) => {
        const count = 300_000;
        const bufferView = addView(glb, new Uint8Array(3 * count), glb);
        const places = json.accessors.push({ bufferView, componentType: 5120, type: 'VEC3', count }) - 1;
        json.nodes[0]!.extensions = { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION: places } } };
        json.extensionsUsed = ['EXT_mesh_gpu_instancing'];
        json.meshes[0]!.primitives = times(10, () => json.meshes[0]!.primitives[0]!);
      }),
    refusal: /decodes to [\d,]+ bytes, \d+ times its size; the limit "expansion" is 100/,
  },
  'twenty thousand morph targets that are one': {
    bytes: () =>
      changedGlb((json, glb) => {
        enlarge(glb, 3000);
        json.meshes[0]!.primitives[0]!.targets = times(20_000, () => ({ POSITION: 0 }));
      }),
    refusal: /decodes to [\d,]+ bytes, [\d,]+ times its size; the limit "expansion" is 100/,
  },
  'five thousand attributes that are one': {
    bytes: () =>
      changedGlb((json, glb) => {
        enlarge(glb, 30_000);
        times(5000, (n) => (json.meshes[0]!.primitives[0]!.attributes[`_A${n}`] = 0));
      }),
    refusal: /decodes to [\d,]+ bytes, [\d,]+ times its size; the limit "expansion" is 100/,
  },
  'a thousand figures, each with a thousand bones': {
    bytes: () =>
      changedGlb((json, glb) => {
        const bufferView = addView(glb, new Uint8Array(16), glb);
        const joints = json.accessors.push({ bufferView, componentType: 5121, type: 'VEC4', count: 4 }) - 1;
        Object.assign(json.meshes[0]!.primitives[0]!.attributes, { JOINTS_0: joints, WEIGHTS_0: joints });
        json.nodes = [...times(2000, () => ({})), ...times(900, () => ({ mesh: 0, skin: 0 }))];
        json.skins = [{ joints: times(2000, (n) => n) }];
        json.scenes[0]!.nodes = times(2900, (n) => n);
      }),
    refusal: /decodes to [\d,]+ bytes, [\d,]+ times its size; the limit "expansion" is 100/,
  },
  'thirty thousand empty nodes': {
    bytes: () =>
      changedGlb((json) => {
        json.nodes.push(...times(30_000, () => ({})));
        json.scenes[0]!.nodes = times(30_001, (n) => n);
      }),
    refusal: /nodes\[\d+\] is part 20,001 of the scene; the limit "parts" is 20,000/,
  },
  'more primitives than anybody could draw': {
    bytes: () =>
      changedGlb((json) => {
        const { attributes } = json.meshes[0]!.primitives[0]!;
        for (let n = 0; n < 300; ++n) json.accessors.push({ ...json.accessors[0]! });
        json.meshes[0]!.primitives = times(300, (n) => ({
          attributes: { ...attributes, POSITION: 3 + n },
          indices: 2,
        }));
        json.nodes = times(200, () => ({ mesh: 0 }));
        json.scenes[0]!.nodes = times(200, (n) => n);
      }),
    refusal: /nodes\[\d+\] is part 20,\d+ of the scene; the limit "parts" is 20,000/,
  },
  'thousands of lights': {
    bytes: () =>
      changedGlb((json) => {
        json.extensions = { KHR_lights_punctual: { lights: [{ type: 'point' }] } };
        json.extensionsUsed = ['KHR_lights_punctual'];
        json.nodes.push(...times(8000, () => ({ extensions: { KHR_lights_punctual: { light: 0 } } })));
        json.scenes[0]!.nodes = times(8001, (n) => n);
      }),
  },
  'a name of half a megabyte at hundreds of nodes': {
    bytes: () =>
      changedGlb((json) => {
        json.meshes[0]!.name = 'long '.repeat(100_000);
        json.nodes = times(900, () => ({ mesh: 0 }));
        json.scenes[0]!.nodes = times(900, (n) => n);
      }),
    refusal: /decodes to [\d,]+ bytes, [\d,]+ times its size; the limit "expansion" is 100/,
  },
  'a PNG of 900 million pixels': {
    bytes: () => changedGlb((_, glb) => paintWith(glb, pngOf(30_000, 30_000), 'image/png')),
    refusal: /images\[0\] has 30,000 × 30,000 pixels/,
  },
  'a JPEG of 4 billion pixels': {
    bytes: () => changedGlb((_, glb) => paintWith(glb, jpegOf(65_500, 65_500), 'image/jpeg')),
    refusal: /images\[0\] has 65,500 × 65,500 pixels/,
  },
  'a WebP of 268 million pixels': {
    bytes: () => changedGlb((_, glb) => paintWith(glb, webpOf(16_383, 16_383), 'image/webp', 'EXT_texture_webp')),
    refusal: /images\[0\] has 16,383 × 16,383 pixels/,
  },
  'a KTX2 picture of 4 billion pixels': {
    bytes: () => changedGlb((_, glb) => paintWith(glb, ktx2Of(65_536, 65_536), 'image/ktx2', 'KHR_texture_basisu')),
    refusal: /images\[0\] has 65,536 × 65,536 pixels/,
  },
};
