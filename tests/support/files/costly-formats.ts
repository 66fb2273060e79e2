// Files of other formats of less than two megabytes that made loaders take gigabytes, minutes, or what is not theirs.
import { deflateRawSync } from 'node:zlib';
import { fbxNode } from '../models';
import { fbxOfZeros } from './costly';

/** A file, those beside it by name, and what it is refused with, unless it is read all the same. */
export interface CostlyFormat {
  name: string;
  bytes: () => Uint8Array;
  beside?: (name: string) => Uint8Array | undefined;
  refusal?: RegExp;
}

const bufferOf = (text: string): Buffer => Buffer.from(text, 'latin1');

interface Entry {
  name: string;
  bytes: Uint8Array;
  isDeflated?: boolean;
  /** Another entry whose bytes it shares. */
  like?: number;
}

/** A ZIP. */
export function zipOf(entries: readonly Entry[]): Buffer {
  const parts: Buffer[] = [];
  const begins: number[] = [];
  const listed: Buffer[] = [];
  let at = 0;
  for (const [i, { name, bytes, isDeflated = false, like }] of entries.entries()) {
    const content = isDeflated ? deflateRawSync(bytes, { level: 9 }) : Buffer.from(bytes);
    const head = Buffer.alloc(46);
    head.writeUInt32LE(0x02014b50, 0);
    head.writeUInt16LE(isDeflated ? 8 : 0, 10);
    head.writeUInt32LE(content.length, 20);
    head.writeUInt32LE(bytes.length, 24);
    head.writeUInt16LE(name.length, 28);
    head.writeUInt32LE(begins[like ?? i] ?? at, 42);
    listed.push(head, bufferOf(name));
    if (like !== undefined) continue;
    begins[i] = at;
    const local = Buffer.alloc(30);
    local.writeUInt32LE(0x04034b50, 0);
    head.copy(local, 4, 6, 30);
    const file = Buffer.concat([local, bufferOf(name), content]);
    parts.push(file);
    at += file.length;
  }
  const end = Buffer.alloc(22);
  end.writeUInt32LE(0x06054b50, 0);
  end.writeUInt16LE(entries.length, 8);
  end.writeUInt16LE(entries.length, 10);
  end.writeUInt32LE(Buffer.concat(listed).length, 12);
  end.writeUInt32LE(at, 16);
  return Buffer.concat([...parts, ...listed, end]);
}

const kPoints = 'point3f[] points = [(0,0,0), (1,0,0), (0,1,0)]';
const kFace = 'int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,2]';
export const usdaOf = (...lines: string[]): string => `#usda 1.0\n${lines.join('\n')}\n`;
const meshOf = (...lines: string[]): string => `def Mesh "mesh" {\n${lines.join('\n')}\n}`;
/** A layer that shows others. */
const layerOf = (...names: string[]): Buffer =>
  bufferOf(
    usdaOf(
      ...names.map((name, i) => `def Xform "x${i}" (\nprepend references = @./${name}@\n)\n{\n}`),
      meshOf(kPoints, kFace),
    ),
  );

/** A USDC with one section. */
function usdcOf(section: string, ...numbers: number[]): Buffer {
  const bytes = Buffer.alloc(400);
  bytes.write('PXR-USDC');
  bytes[9] = 8; // version 0.8
  bytes.writeBigUInt64LE(100n, 16);
  bytes.writeBigUInt64LE(1n, 100);
  bytes.write(section, 108);
  bytes.writeBigUInt64LE(200n, 124);
  bytes.writeBigUInt64LE(100n, 132);
  numbers.forEach((value, i) => bytes.writeBigUInt64LE(BigInt(value), 200 + 8 * i));
  return bytes;
}

/** An FBX of text with one polygon. */
function fbxPolygon(corners: number): Buffer {
  const list = (name: string, values: readonly (number | string)[]) =>
    fbxNode(`${name}: *${values.length}`, `a: ${values.join(',')}`);
  // A comb, whose teeth make it slow to triangulate.
  const half = corners / 2;
  const points = Array.from({ length: corners }, (_, i) =>
    i < half ? [i, 9 * (i % 2)] : [corners - i, 30 - 9 * (i % 2)],
  );
  const order = points.map((_, i) => (i === corners - 1 ? -corners : i));
  return bufferOf(
    [
      '; FBX 7.4.0 project file',
      fbxNode('FBXHeaderExtension: ', 'FBXVersion: 7400'),
      fbxNode(
        'Objects: ',
        fbxNode(
          'Geometry: 10, "Geometry::a", "Mesh"',
          list(
            'Vertices',
            points.flatMap(([x, y]) => [x!, y!, 0]),
          ),
          list('PolygonVertexIndex', order),
        ),
        fbxNode('Model: 20, "Model::a", "Mesh"', 'Version: 232'),
      ),
      fbxNode('Connections: ', 'C: "OO",20,0', 'C: "OO",10,20'),
      '',
    ].join('\n'),
  );
}

const fbxText = (rest: string): Buffer =>
  bufferOf(`; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXVersion: 7400\n}\n${rest}\n`);

const plyOf = (format: string, elements: string): Buffer =>
  bufferOf(`ply\nformat ${format} 1.0\n${elements}\nend_header\n`);
const kVertex = 'property float x\nproperty float y\nproperty float z';
const kTriangle = 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n';

/** Names that lead from an object to what all objects have. */
export const kInherited = ['__proto__', 'constructor', 'toString', 'hasOwnProperty', 'valueOf'];

/** Files of each format. Every name in them is one of those. */
export const inheritedNames: Record<string, (name: string) => Uint8Array> = {
  'proto.obj': (name) => bufferOf(`mtllib ${name}\no ${name}\nusemtl ${name}\n${kTriangle}`),
  'proto.ply': (name) =>
    bufferOf(
      `ply\nformat ascii 1.0\nelement ${name} 1\nproperty float ${name}\nelement vertex 3\n${kVertex}\nproperty float ${name}\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n1\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n`,
    ),
  'proto.stl': (name) =>
    bufferOf(
      `solid ${name}\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid ${name}\n`,
    ),
  'proto.usda': (name) =>
    bufferOf(
      usdaOf(
        `/ ${name} {`,
        'polluted = 5',
        '/ prototype {',
        'polluted = 5',
        '}',
        '}',
        `def "${name}" {`,
        'polluted = 5',
        '}',
        meshOf(kPoints, kFace),
      ),
    ),
  'root.usda': (name) => bufferOf(`#usda 1.0\n${name} {\nprototype {\npolluted = 5\n}\npolluted = 5\n}\n`),
  'proto.fbx': (name) =>
    fbxText(
      `Objects:  {\n\t${name}:  {\n\t\t${name}: 5\n\t\tpolluted: 5\n\t\tprototype:  {\n\t\t\tpolluted: 5\n\t\t}\n\t}\n}\n${name}:  {\n\tpolluted: 5\n}`,
    ),
};

export const costlyFormats: Record<string, CostlyFormat> = {
  'comments before nothing': { name: 'a.obj', bytes: () => bufferOf(`${'#'.repeat(40)}\n!`), refusal: /is neither/ },
  'groups without a space': {
    name: 'a.obj',
    bytes: () => bufferOf(`${kTriangle}${'gA\n'.repeat(100_000)}`),
    refusal: /has 100,000 groups; the limit "parts" is 20,000/,
  },
  'objects after tabs': {
    name: 'a.obj',
    bytes: () => bufferOf(`${kTriangle}${'\t\vo\t1\nf 1 2 3\n'.repeat(30_000)}`),
    refusal: /has 30,000 groups; the limit "parts"/,
  },
  'one library a thousand times': {
    name: 'a.obj',
    bytes: () =>
      bufferOf(
        `${kTriangle}${Array.from({ length: 6000 }, (_, i) => `mtllib ${'./'.repeat(i % 50)}a.mtl\n`).join('')}`,
      ),
    beside: (name) => (name === 'a.mtl' ? Buffer.alloc(936_000, 10) : undefined),
  },
  'a library in thousands of places': {
    name: 'a.obj',
    bytes: () => bufferOf(`${kTriangle}${Array.from({ length: 6000 }, (_, i) => `mtllib ${i}.mtl\n`).join('')}`),
    beside: () => Buffer.alloc(1000, 10),
    refusal: /it names more than 1,000 files beside it; the limit "files" is 1,000/,
  },
  'libraries of gigabytes': {
    name: 'a.obj',
    bytes: () => bufferOf(`${kTriangle}${Array.from({ length: 50 }, (_, i) => `mtllib ${i}.mtl\n`).join('')}`),
    beside: () => Buffer.alloc(1e6, 10),
    refusal: /its libraries have more than 33,554,432 bytes; the limit "expansion"/,
  },
  'a hundred thousand materials': {
    name: 'a.obj',
    bytes: () => bufferOf(`mtllib a.mtl\n${kTriangle}`),
    beside: () => bufferOf(Array.from({ length: 100_000 }, (_, i) => `newmtl ${i}\nmap_Kd a.png\n`).join('')),
    refusal: /has 100,000 materials; the limit "parts" is 20,000/,
  },
  'a name of a megabyte': { name: 'a.obj', bytes: () => bufferOf(`${kTriangle}o ${'x'.repeat(1e6)}\nf 1 2 3\n`) },
  'a line of spaces': {
    name: 'a.obj',
    bytes: () => bufferOf(`${kTriangle}mtllib a${' '.repeat(1e6)}b\n${'\n'.repeat(1e5)}`),
  },
  'elements without properties': {
    name: 'a.ply',
    bytes: () => plyOf('ascii', 'element nothing 1000000000000000'),
    refusal: /its header has 1,000,000,000,000,000 elements "nothing" without a property/,
  },
  'more elements than bytes': {
    name: 'a.ply',
    bytes: () => plyOf('binary_little_endian', `element vertex 2000000000\n${kVertex}`),
    refusal: /has 2,000,000,000 elements "vertex", more than its \d+ bytes hold/,
  },
  'lists without an item type': {
    name: 'a.ply',
    bytes: () => plyOf('binary_little_endian', 'element face 1000000000\nproperty list'),
    refusal: /has 1,000,000,000 elements "face", more than/,
  },
  'facets that do not end': {
    name: 'a.stl',
    bytes: () => bufferOf(`solid a\nfacet normal 0 0 1\n${'facet '.repeat(150_000)}\nendsolid a\n`),
    refusal: /one of its facets does not end/,
  },
  'solids that do not end': {
    name: 'a.stl',
    bytes: () => bufferOf('solid a\nfacet normal\n'.repeat(60_000)),
    refusal: /one of its facets does not end/,
  },
  'solids without anything that do not end': {
    name: 'a.stl',
    bytes: () => bufferOf(`solid a\nfacet endfacet\n${'solid '.repeat(150_000)}`),
    refusal: /one of its solids does not end/,
  },
  'polygons of more corners than there are': {
    name: 'a.usda',
    bytes: () =>
      bufferOf(usdaOf(meshOf(kPoints, 'int[] faceVertexCounts = [2000000000]', 'int[] faceVertexIndices = [0,1,2]'))),
    refusal: /faceVertexCounts are 2000000000 together, but there are 3 faceVertexIndices/,
  },
  'polygons of fewer corners than none': {
    name: 'a.usda',
    bytes: () =>
      bufferOf(
        usdaOf(
          meshOf(kPoints, 'int[] faceVertexCounts = [-2000000000, 2000000003]', 'int[] faceVertexIndices = [0,1,2]'),
        ),
      ),
    refusal: /faceVertexCounts\[0\] is -2000000000/,
  },
  'more joints for a vertex than there are': {
    name: 'a.usda',
    bytes: () =>
      bufferOf(
        usdaOf(
          meshOf(
            kPoints,
            kFace,
            'int[] primvars:skel:jointIndices = [0,0,0] (',
            'elementSize = 1000000000',
            ')',
            'float[] primvars:skel:jointWeights = [1,1,1] (',
            'elementSize = 1000000000',
            ')',
          ),
        ),
      ),
  },
  'layers that each show the next one twice': {
    name: 'a.usdz',
    bytes: () =>
      zipOf(
        Array.from({ length: 16 }, (_, i) => ({ name: `${i}.usda`, bytes: layerOf(`${i + 1}.usda`, `${i + 1}.usda`) })),
      ),
    refusal: /its layers refer 1001 times to one of them; the limit "instances" is 1,000|limit "seconds"/,
  },
  'a layer that shows itself': {
    name: 'a.usdz',
    bytes: () =>
      zipOf([
        { name: '0.usda', bytes: layerOf('1.usda') },
        { name: '1.usda', bytes: layerOf('0.usda', '1.usda') },
      ]),
    refusal: /one of its layers refers to itself/,
  },
  'a deflated layer': {
    name: 'a.usdz',
    bytes: () => zipOf([{ name: '0.usda', bytes: Buffer.alloc(100e6, 10), isDeflated: true }]),
    refusal: /file 1 in it is compressed; in a USDZ, files are stored as they are/,
  },
  'deflated images': {
    name: 'a.usdz',
    bytes: () =>
      zipOf([
        { name: '0.usda', bytes: layerOf() },
        ...Array.from({ length: 8 }, (_, i) => ({ name: `${i}.png`, bytes: Buffer.alloc(50e6), isDeflated: true })),
      ]),
    refusal: /file 2 in it is compressed/,
  },
  'files that share their bytes': {
    name: 'a.usdz',
    bytes: () =>
      zipOf([
        { name: '0.usda', bytes: layerOf() },
        { name: 'a.png', bytes: Buffer.alloc(500_000) },
        ...Array.from({ length: 10_000 }, (_, i) => ({ name: `${i}.png`, bytes: Buffer.alloc(500_000), like: 1 })),
      ]),
    refusal: /the files in it have more bytes than its \d+ together/,
  },
  'tokens of terabytes': {
    name: 'a.usdc',
    bytes: () => usdcOf('TOKENS', 1, 2 ** 33, 10, 0),
    refusal: /its section (TOKENS|PATHS) says to have more than its 100 bytes hold/,
  },
  'more tokens than bytes': {
    name: 'a.usdc',
    bytes: () => usdcOf('TOKENS', 2 ** 50, 8, 8, 0),
    refusal: /its section (TOKENS|PATHS) says to have more than its 100 bytes hold/,
  },
  'more paths than bytes': {
    name: 'a.usdc',
    bytes: () => usdcOf('PATHS', 2 ** 31, 2 ** 31, 8),
    refusal: /its section (TOKENS|PATHS) says to have more than its 100 bytes hold/,
  },
  'prims in prims': {
    name: 'a.usda',
    bytes: () => bufferOf(usdaOf(`${'def "a" {\n'.repeat(50_000)}${meshOf(kPoints, kFace)}${'\n}'.repeat(50_000)}`)),
    refusal: /its prims are nested more than 1000 deep; the limit "nesting"/,
  },
  'a line that is matched over and over': {
    name: 'a.usda',
    bytes: () => bufferOf(usdaOf(`def${' '.repeat(300_000)}a""b {`, '}')),
    refusal: /its loader takes more than [\d.]+ seconds; the limit "seconds"/,
  },
  'an array of zeros whose record says to be empty': {
    name: 'a.fbx',
    bytes: () => fbxOfZeros(2e8, undefined, false),
    refusal: /its arrays decompress to more than 33,554,432 bytes; the limit "expansion"/,
  },
  'a polygon of thirty thousand corners': {
    name: 'a.fbx',
    bytes: () => fbxPolygon(30_000),
    refusal: /has a polygon of 30,000 corners; the limit "corners" is 2,000/,
  },
  'records in records': {
    name: 'a.fbx',
    bytes: () => fbxText(Array.from({ length: 2000 }, (_, i) => `${'\t'.repeat(i % 200)}a:  {`).join('\n')),
    refusal: /its records are nested more than 1000 deep; the limit "nesting" is 1,000/,
  },
  'an array that becomes text with each line': {
    name: 'a.fbx',
    bytes: () => fbxText(`Objects:  {\n\ta: *3 {\n\t\ta: 1,2\n${',1\n'.repeat(1)}${'1,1\n'.repeat(200_000)}\t}\n}`),
    refusal: /the limit "(seconds|memory)"/,
  },
};
