/** What the page reads from a glTF file before it loads it. */
interface GltfHead {
  /** Whether it is a GLB. */
  binary: boolean;
  json: object;
  /** Names of the extensions it uses. */
  extensions: string[];
  /** URIs of the files it refers to; empty for a self-contained GLB. */
  uris: string[];
}

const kMagic = 0x46546c67; // "glTF"
const kJsonChunk = 0x4e4f534a; // "JSON"
const kHeaderBytes = 12;
const kChunkHeaderBytes = 8;

/**
 * Checks that `bytes` are a complete GLB or glTF 2.0 file and reads its head.
 * @param bytes The whole file.
 * @throws Error with a message for people, without the file's name.
 */
export function readGltfHead(bytes: ArrayBuffer): GltfHead {
  if (bytes.byteLength === 0) throw new Error('the file is empty');
  const view = new DataView(bytes);
  const binary = bytes.byteLength >= 4 && view.getUint32(0, true) === kMagic;
  const text = binary ? jsonChunk(view) : new Uint8Array(bytes);
  const json = parse(text, binary);

  const version = json.asset?.version;
  if (version === undefined) throw new Error('this is JSON, but not a glTF model (it has no asset.version)');
  if (!String(version).startsWith('2.')) throw new Error(`glTF ${version} is not supported, only glTF 2.0`);
  const sources = [...(json.buffers ?? []), ...(json.images ?? [])];
  return {
    binary,
    json,
    extensions: json.extensionsUsed ?? [],
    uris: sources.flatMap(({ uri }) => (uri && !uri.startsWith('data:') ? [decodeURIComponent(uri)] : [])),
  };
}

interface GltfJson {
  asset?: { version?: string };
  extensionsUsed?: string[];
  buffers?: { uri?: string }[];
  images?: { uri?: string }[];
}

function jsonChunk(view: DataView): Uint8Array {
  if (view.byteLength < kHeaderBytes + kChunkHeaderBytes)
    throw new Error(`the GLB ends after ${view.byteLength} bytes, within its header`);
  const version = view.getUint32(4, true);
  if (version !== 2) throw new Error(`GLB version ${version} is not supported, only version 2`);
  const declared = view.getUint32(8, true);
  if (declared > view.byteLength)
    throw new Error(`the GLB is cut short: it has ${view.byteLength} of its ${declared} bytes`);
  const length = view.getUint32(kHeaderBytes, true);
  const start = kHeaderBytes + kChunkHeaderBytes;
  if (view.getUint32(kHeaderBytes + 4, true) !== kJsonChunk || length > view.byteLength - start) {
    throw new Error('the GLB is damaged: its first chunk is not JSON of the length it declares');
  }
  return new Uint8Array(view.buffer, start, length);
}

function parse(text: Uint8Array, binary: boolean): GltfJson {
  try {
    const json: unknown = JSON.parse(new TextDecoder().decode(text));
    if (typeof json === 'object' && json !== null) return json;
  } catch {
    // Reported below.
  }
  throw new Error(
    binary
      ? 'the GLB is damaged: its JSON cannot be read'
      : 'this is no model that can be opened: GLB, glTF, VRM, FBX 7 or newer, OBJ, PLY, STL or USD; paints are PNG, JPEG or WebP',
  );
}
