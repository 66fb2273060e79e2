/** Formats that `toGlb` makes a GLB of. */
export type Format = 'fbx' | 'obj' | 'ply' | 'stl' | 'usd';

/** A kind of file that people have, but that is no glTF. */
export interface FileKind {
  /** What it is, with its article: `an FBX file`. */
  name: string;
  /** Which it is of the formats that can be converted. */
  format?: Format;
  /** What to do, if it is none of them. */
  advice?: string;
}

/** A kind, and what knows its files by how they begin, a byte per character. */
interface Known extends FileKind {
  begins: { test(start: string): boolean };
}

/** As many bytes say what a file is. */
const kSniffed = 4096;

const kinds: readonly Known[] = [
  { name: 'an FBX file', begins: /^(Kaydara FBX Binary|; FBX )/, format: 'fbx' },
  { name: 'a USDZ file', begins: /^PK.{28}[^/]*\.usd[ac]?/s, format: 'usd' },
  { name: 'a USD file', begins: /^(PXR-USDC|#usda )/, format: 'usd' },
  { name: 'a PLY file', begins: /^ply\r?\n/, format: 'ply' },
  { name: 'an STL file', begins: /^solid[^\n]*\n\s*facet /, format: 'stl' },
  { name: 'an OBJ file', begins: { test: beginsAsObj }, format: 'obj' },
  {
    name: 'a Blender file',
    begins: /^(BLENDER|\(\xb5\/\xfd)/, // or compressed
    advice: 'open it in Blender and choose File, Export, glTF 2.0',
  },
  {
    name: 'a Collada file',
    begins: /^(\xef\xbb\xbf)?<\?xml.*<COLLADA/s,
    advice: 'import it into Blender and choose File, Export, glTF 2.0',
  },
  {
    name: 'a pointer of Git LFS, not the file that it stands for',
    begins: /^version https:\/\/git-lfs\.github\.com\/spec\//,
    advice: 'get that by git lfs pull',
  },
  {
    name: 'a web page',
    begins: /^(\xef\xbb\xbf)?\s*<(!doctype html|html)/i,
    advice: 'what was meant did not download; get the file itself',
  },
  { name: 'a ZIP archive', begins: /^PK../s, advice: 'unpack it and take the model in it' },
  { name: 'a RAR or 7z archive', begins: /^(Rar!|7z\xbc\xaf)/, advice: 'unpack it and take the model in it' },
  {
    name: 'an image',
    begins: /^(\x89PNG|\xff\xd8\xff|RIFF....WEBP|\xabKTX 20)/s,
    advice: 'a model is needed here; images are textures',
  },
];

/** Whether the first line of an OBJ that is more than a comment or a name is a vertex. */
function beginsAsObj(start: string): boolean {
  for (const line of start.replace(/^\xef\xbb\xbf/, '').split('\n')) {
    const text = line.trim();
    if (text !== '' && !/^(#|(mtllib|o|g|s|usemtl)( |$))/.test(text)) return /^v\s+[+-]?[\d.]/.test(text);
  }
  return false;
}

const binaryStl: FileKind = { name: 'an STL file', format: 'stl' };
/** Bytes of a binary STL: before its triangles, and of each. */
const [stlHead, stlTriangle] = [84, 50];

/**
 * What a file is that people take for a model, but that is no glTF: a model of another format, an archive, a web page. Undefined if it is none of
 * the kinds that are known, or a GLB. Its first 4 KB count, and of an STL its length.
 * @param bytes  All of it.
 */
export function fileKind(bytes: Uint8Array): FileKind | undefined {
  const text = String.fromCharCode(...bytes.subarray(0, kSniffed));
  if (text.startsWith('glTF')) return undefined;
  const found = kinds.find(({ begins }) => begins.test(text));
  if (found) {
    const { begins: _, ...kind } = found;
    return kind;
  }
  if (bytes.byteLength <= stlHead) return undefined;
  // A binary STL is only known by its length.
  const triangles = new DataView(bytes.buffer, bytes.byteOffset).getUint32(80, true);
  return bytes.byteLength === stlHead + stlTriangle * triangles ? binaryStl : undefined;
}

/** The kind of a file other than glTF, and the way out. */
export function adviceOn(bytes: Uint8Array): string | undefined {
  const kind = fileKind(bytes);
  return kind && `is ${kind.name}; ${kind.advice ?? 'toGlb of cagecast/gltf makes a GLB of it'}`;
}
