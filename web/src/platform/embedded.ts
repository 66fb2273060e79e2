/** A file within a GLB: bytes that only its own kind of program looks for. */
export interface Embedded {
  name: string;
  type: string;
  bytes: Uint8Array<ArrayBuffer>;
}

interface Json {
  extras?: Record<string, unknown>;
  buffers?: { byteLength: number }[];
  bufferViews?: { buffer: number; byteOffset?: number; byteLength: number }[];
}

const kHead = 12; // bytes of a GLB
const kChunkHead = 8;
const kKey = 'cagecast'; // in the extras of a file
const [kJson, kBin] = [0x4e4f534a, 0x004e4942];

const padded = (length: number): number => Math.ceil(length / 4) * 4;

/** The JSON and the binary chunk of a sound GLB. */
function chunksOf(glb: Uint8Array<ArrayBuffer>): { json: Json; bin: Uint8Array<ArrayBuffer> } {
  const view = new DataView(glb.buffer, glb.byteOffset, glb.byteLength);
  const length = view.getUint32(kHead, true);
  const json: Json = JSON.parse(
    new TextDecoder().decode(glb.subarray(kHead + kChunkHead, kHead + kChunkHead + length)),
  );
  return { json, bin: glb.subarray(Math.min(glb.length, kHead + length + 2 * kChunkHead)) };
}

const isAt = (bin: Uint8Array, offset: number, bytes: Uint8Array): boolean =>
  bytes.every((byte, i) => bin[offset + i] === byte);

/**
 * Puts files into a GLB, by their keys. No program shows them, as its scene stays the same. Bytes of its own, such as a texture's, are
 * not stored again.
 */
export function embed(
  glb: Uint8Array<ArrayBuffer>,
  files: Readonly<Record<string, Embedded>>,
): Uint8Array<ArrayBuffer> {
  const { json, bin } = chunksOf(glb);
  const views = (json.bufferViews ??= []);
  const added: Uint8Array[] = [];
  let end = padded(bin.length);
  const entries = Object.entries(files).map(([key, { name, type, bytes }]) => {
    let view = views.findIndex(
      ({ byteOffset = 0, byteLength }) => byteLength === bytes.length && isAt(bin, byteOffset, bytes),
    );
    if (view < 0) {
      view = views.push({ buffer: 0, byteOffset: end, byteLength: bytes.length }) - 1;
      added.push(bytes);
      end += padded(bytes.length);
    }
    return [key, { name, type, bufferView: view }];
  });
  json.extras = { ...json.extras, [kKey]: Object.fromEntries(entries) };
  json.buffers = [{ ...json.buffers?.[0], byteLength: end }];
  const text = new TextEncoder().encode(JSON.stringify(json));
  const size = kHead + kChunkHead + padded(text.length) + kChunkHead + end;
  const made = new Uint8Array(size);
  const view = new DataView(made.buffer);
  const put = (at: number, ...numbers: number[]): void =>
    numbers.forEach((n, i) => view.setUint32(at + 4 * i, n, true));
  put(0, 0x46546c67, 2, size, padded(text.length), kJson);
  made.fill(0x20, kHead + kChunkHead, kHead + kChunkHead + padded(text.length)); // the JSON ends with spaces
  made.set(text, kHead + kChunkHead);
  let at = kHead + kChunkHead + padded(text.length);
  put(at, end, kBin);
  at += kChunkHead;
  made.set(bin, at);
  at += padded(bin.length);
  for (const bytes of added) {
    made.set(bytes, at);
    at += padded(bytes.length);
  }
  return made;
}

/** How the bytes of files begin, by their types. */
const kMagic: Readonly<Record<string, readonly number[]>> = {
  'model/gltf-binary': [0x67, 0x6c, 0x54, 0x46],
  'image/png': [0x89, 0x50, 0x4e, 0x47],
};

/** The file of a key in a GLB; undefined if it has none, or another program has made something else of it. */
export function embeddedIn(glb: ArrayBuffer, json: object, key: string): File | undefined {
  const { extras, bufferViews } = json as Json;
  const { name, type, bufferView } = Object(Object(extras?.[kKey])[key]);
  const view = bufferViews?.[bufferView];
  const magic = kMagic[String(type)];
  if (view?.buffer !== 0 || !magic || typeof name !== 'string') return undefined;
  const { bin } = chunksOf(new Uint8Array(glb));
  const { byteOffset = 0, byteLength } = view;
  if (!(byteOffset >= 0 && byteLength > 0 && byteOffset + byteLength <= bin.length)) return undefined;
  const bytes = bin.slice(byteOffset, byteOffset + byteLength);
  return isAt(bytes, 0, Uint8Array.from(magic)) ? new File([bytes], name, { type }) : undefined;
}
