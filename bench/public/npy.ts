// Arrays as files of NumPy, version 1.0: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html

const kTypes = {
  '|b1': Uint8Array,
  '|u1': Uint8Array,
  '|i1': Int8Array,
  '<u2': Uint16Array,
  '<i2': Int16Array,
  '<u4': Uint32Array,
  '<i4': Int32Array,
  '<u8': BigUint64Array,
  '<i8': BigInt64Array,
  '<f4': Float32Array,
  '<f8': Float64Array,
} as const;
type Values = InstanceType<(typeof kTypes)[keyof typeof kTypes]>;

/** An array of a file. */
export interface Npy {
  /** As NumPy writes it: `<f4`. */
  type: string;
  shape: number[];
  /** Undefined if the type is not one of numbers or booleans, little-endian. */
  values?: Values;
}

/** The bytes of a file. @param columns  How many values a row has; without, the array has one dimension. */
export function npyOf(values: ArrayBufferView & ArrayLike<unknown>, columns?: number): Buffer {
  const type = Object.entries(kTypes).find(([name, Type]) => name !== '|b1' && values instanceof Type)![0];
  const shape = columns === undefined ? `${values.length},` : `${values.length / columns}, ${columns}`;
  const text = `{'descr': '${type}', 'fortran_order': False, 'shape': (${shape}), }`;
  const header = `${text.padEnd(64 * Math.ceil((text.length + 11) / 64) - 11)}\n`;
  const start = Buffer.from('\x93NUMPY\x01\0\0\0', 'latin1');
  start.writeUInt16LE(header.length, 8);
  return Buffer.concat([start, Buffer.from(header), Buffer.from(values.buffer, values.byteOffset, values.byteLength)]);
}

/** Reads a file. @throws {Error} if it is none. */
export function readNpy(bytes: Buffer): Npy {
  const wide = bytes[6]! > 1; // later versions have a longer header
  const start = wide ? 12 : 10;
  const isNpy = bytes.length > start && bytes.toString('latin1', 0, 6) === '\x93NUMPY';
  const end = isNpy ? start + (wide ? bytes.readUInt32LE(8) : bytes.readUInt16LE(8)) : 0;
  const header = bytes.toString('latin1', start, end);
  const [, type, sizes] = /'descr': '([^']+)'.*'shape': \(([^)]*)\)/.exec(header) ?? [];
  if (type === undefined) throw new Error('is no file of NumPy');
  const shape = sizes!
    .split(',')
    .filter((size) => size.trim())
    .map(Number);
  const Type = kTypes[type as keyof typeof kTypes];
  const count = shape.reduce((product, size) => product * size, 1);
  if (Type === undefined) return { type, shape };
  const data = bytes.buffer.slice(bytes.byteOffset + end, bytes.byteOffset + end + count * Type.BYTES_PER_ELEMENT);
  if (data.byteLength < count * Type.BYTES_PER_ELEMENT) throw new Error('ends too early');
  return { type, shape, values: new Type(data as ArrayBuffer) };
}
