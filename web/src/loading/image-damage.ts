import type { GLTF } from 'three/addons/loaders/GLTFLoader.js';

/** How to recognise an image format, and truncated files. */
interface Kind {
  title: string;
  name: RegExp;
  begins: string;
  /** Whether the end of the file is there. */
  isWhole(bytes: Uint8Array): boolean;
}

/** Image formats in glTF, by media type. */
const kKinds: Record<string, Kind> = {
  'image/png': {
    title: 'PNG',
    name: /\.png$/i,
    begins: '\x89PNG\r\n\x1a\n',
    isWhole: (bytes) => textOf(bytes.subarray(-8, -4)) === 'IEND',
  },
  'image/jpeg': {
    title: 'JPEG',
    name: /\.jpe?g$/i,
    begins: '\xff\xd8\xff',
    isWhole: (bytes) => textOf(bytes.subarray(-2)) === '\xff\xd9',
  },
  'image/webp': {
    title: 'WebP',
    name: /\.webp$/i,
    begins: 'RIFF',
    isWhole: (bytes) => bytes.length >= 8 && viewOf(bytes).getUint32(4, true) + 8 <= bytes.length,
  },
  'image/ktx2': { title: 'KTX2', name: /\.ktx2$/i, begins: '\xabKTX 20\xbb\r\n\x1a\n', isWhole: isWholeKtx2 },
};

interface ImageJson {
  name?: string;
  uri?: string;
  mimeType?: string;
  bufferView?: number;
}

/**
 * Finds images of a model that could not be decoded; the loader shows white in their place.
 * @param read Reads a file that the model refers to.
 * @returns A message about the first of them and their number, without the model's name; undefined if all are intact.
 */
export async function damageOf(
  { parser }: GLTF,
  read: (uri: string) => Promise<ArrayBuffer>,
): Promise<string | undefined> {
  const {
    textures = [],
    images = [],
  }: { textures?: { source?: number; extensions?: Record<string, { source?: number }> }[]; images?: ImageJson[] } =
    parser.json;
  const loaded = await parser.getDependencies('texture');
  const damaged = new Set<number>();
  textures.forEach(({ source, extensions = {} }, index) => {
    const image = Object.values(extensions).find((extension) => extension.source !== undefined)?.source ?? source;
    if (loaded[index] === null && image !== undefined) damaged.add(image);
  });
  const [first] = damaged;
  if (first === undefined) return undefined;
  const { name, uri, bufferView, mimeType }: ImageJson = images[first] ?? {};
  const bytes = bufferView !== undefined ? await parser.getDependency('bufferView', bufferView) : await read(uri ?? '');
  const file = uri?.startsWith('data:') ? undefined : uri;
  const title = name || file ? `image “${name || file}”` : `image ${first}`;
  const others = damaged.size > 1 ? ` (nor can ${damaged.size - 1} more)` : '';
  return `${title} cannot be shown${others}: ${faultOf(new Uint8Array(bytes), kindOf(mimeType, uri))}. White is shown in its place.`;
}

function kindOf(mimeType: string | undefined, uri = ''): Kind | undefined {
  return (
    kKinds[mimeType ?? /^data:([^;,]*)/.exec(uri)?.[1] ?? ''] ??
    Object.values(kKinds).find(({ name }) => name.test(uri))
  );
}

function faultOf(bytes: Uint8Array, kind: Kind | undefined): string {
  if (bytes.length === 0) return 'it is empty';
  if (!kind) return 'the browser does not support its format';
  if (!textOf(bytes.subarray(0, 12)).startsWith(kind.begins)) return `it is not a ${kind.title} file`;
  return kind.isWhole(bytes)
    ? `the ${kind.title} file is damaged`
    : `the ${kind.title} file is cut short after ${bytes.length} bytes`;
}

function isWholeKtx2(bytes: Uint8Array): boolean {
  const [view, levels] = [viewOf(bytes), 80];
  if (bytes.length < levels) return false;
  const count = Math.max(1, view.getUint32(40, true));
  for (let level = 0; level < count; level++) {
    const at = levels + 24 * level;
    if (at + 16 > bytes.length || view.getBigUint64(at, true) + view.getBigUint64(at + 8, true) > bytes.length)
      return false;
  }
  return true;
}

const viewOf = ({ buffer, byteOffset, byteLength }: Uint8Array): DataView =>
  new DataView(buffer, byteOffset, byteLength);

/** Bytes as a string of the same character codes. */
const textOf = (bytes: Uint8Array): string => String.fromCharCode(...bytes);
