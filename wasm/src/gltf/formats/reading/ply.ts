import { type BufferGeometry, Color, Float32BufferAttribute, SRGBColorSpace, Vector3 } from 'three';
import { PLYLoader } from 'three/addons/loaders/PLYLoader.js';
import { InputError } from '../../../scene/input-error.js';
import { endOfHeader, sizes } from '../checks/ply.js';
import { triangulated } from './polygon.js';

/** A number of an element, or a list of them with its count before it. */
interface Property {
  name: string;
  type: string;
  countType: string | undefined;
}

interface Element {
  name: string;
  count: number;
  properties: Property[];
}

/** How a binary file is read, by the types of its numbers. */
const kReaders = {
  char: 'getInt8',
  int8: 'getInt8',
  uchar: 'getUint8',
  uint8: 'getUint8',
  short: 'getInt16',
  int16: 'getInt16',
  ushort: 'getUint16',
  uint16: 'getUint16',
  int: 'getInt32',
  int32: 'getInt32',
  uint: 'getUint32',
  uint32: 'getUint32',
  float: 'getFloat32',
  float32: 'getFloat32',
  double: 'getFloat64',
  float64: 'getFloat64',
} as const;

/** The faces of a PLY as triangles. */
interface Triangles {
  indices: number[];
  /** 2 for each corner; empty if not every face has them. */
  uvs: number[];
  /** 3 for each corner, in linear light; empty if the faces have none. */
  colors: number[];
}

/**
 * Reads a PLY. Vertices are read by three's loader, faces here: the loader loses those of more than four corners.
 * @returns nothing if it has no faces.
 */
export function readPly(bytes: Uint8Array): BufferGeometry | undefined {
  const header = headerOf(bytes);
  const withoutFaces = Uint8Array.from(bytes);
  const at = header.search(/element\s+face\s/);
  if (at >= 0) withoutFaces[header.indexOf('face', at)] = 'F'.charCodeAt(0); // No name that the loader knows.
  const geometry = new PLYLoader().parse(withoutFaces.buffer);
  const position = geometry.getAttribute('position');
  const placeOf = (vertex: number): Vector3 =>
    vertex < position.count ? new Vector3().fromBufferAttribute(position, vertex) : new Vector3();
  const { indices, uvs, colors } = trianglesOf(header, bytes, placeOf);
  if (indices.length === 0) return undefined;
  geometry.setIndex(indices);
  if (uvs.length === 0 && colors.length === 0) return geometry;
  const byCorner = geometry.toNonIndexed();
  if (uvs.length > 0) byCorner.setAttribute('uv', new Float32BufferAttribute(uvs, 2));
  if (colors.length > 0) byCorner.setAttribute('color', new Float32BufferAttribute(colors, 3));
  return byCorner;
}

/** The header, a character for each byte, with the end of its last line. */
function headerOf(bytes: Uint8Array): string {
  const end = endOfHeader(bytes);
  const latin1 = new TextDecoder('latin1');
  return (
    latin1.decode(bytes.subarray(0, end)) +
    (/^[ \t]*(\r\n|\n|\r)?/.exec(latin1.decode(bytes.subarray(end, end + 8)))?.[0] ?? '')
  );
}

function trianglesOf(header: string, bytes: Uint8Array, placeOf: (vertex: number) => Vector3): Triangles {
  const out: Triangles = { indices: [], uvs: [], colors: [] };
  const next = numbersOf(header, bytes);
  let [haveUvs, haveColors] = [true, true];
  for (const { name, count, properties } of elementsOf(header))
    for (let i = 0; i < count; ++i) {
      const values = new Map<string, number[]>();
      for (const { name: property, type, countType } of properties) {
        const numbers: number[] = [];
        const length = countType === undefined ? 1 : (next(countType) ?? 0);
        for (let k = 0; k < length; ++k) {
          const value = next(type);
          if (value === undefined) throw new InputError(`ends within ${name} ${i + 1} of ${count}`);
          numbers.push(value);
        }
        values.set(property, numbers);
      }
      if (name !== 'face') continue;
      const corners = values.get('vertex_indices') ?? values.get('vertex_index') ?? [];
      const uvs = values.get('texcoord');
      const [red, green, blue] = ['red', 'green', 'blue'].map((channel) => values.get(channel)?.[0]);
      const type = properties.find((property) => property.name === 'red')?.type ?? '';
      haveUvs &&= uvs?.length === 2 * corners.length;
      haveColors &&= red !== undefined && green !== undefined && blue !== undefined;
      const scale = /float|double/.test(type) ? 1 : 1 / (2 ** (8 * (sizes[type] ?? 1)) - 1);
      for (const corner of triangulated(corners.map(placeOf))) {
        out.indices.push(corners[corner]!);
        if (haveUvs) out.uvs.push(uvs![2 * corner]!, uvs![2 * corner + 1]!);
        if (haveColors)
          out.colors.push(...new Color().setRGB(red! * scale, green! * scale, blue! * scale, SRGBColorSpace));
      }
    }
  return { indices: out.indices, uvs: haveUvs ? out.uvs : [], colors: haveColors ? out.colors : [] };
}

function elementsOf(header: string): Element[] {
  const out: Element[] = [];
  for (const line of header.split(/[\r\n]+/)) {
    const [word, ...words] = line.trim().split(/\s+/);
    if (word === 'element')
      out.push({ name: words[0] ?? '', count: Number.parseInt(words[1] ?? '', 10) || 0, properties: [] });
    if (word !== 'property') continue;
    const [countType, type = '', name = ''] = words[0] === 'list' ? words.slice(1) : [undefined, ...words];
    out.at(-1)?.properties.push({ name, type, countType });
  }
  return out;
}

/** Reads the numbers after a header one by one: nothing at the end of the file. */
function numbersOf(header: string, bytes: Uint8Array): (type: string) => number | undefined {
  if (/format\s+ascii/.test(header)) {
    const words = new TextDecoder('latin1').decode(bytes.subarray(header.length)).matchAll(/\S+/g);
    return () => {
      const { done, value } = words.next();
      return done ? undefined : Number.parseFloat(value[0]);
    };
  }
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const isLittle = /format\s+binary_little/.test(header);
  let at = header.length;
  return (type) => {
    const size = sizes[type] ?? 1;
    at += size;
    return at > view.byteLength
      ? undefined
      : view[kReaders[type as keyof typeof kReaders] ?? 'getUint8'](at - size, isLittle);
  };
}
