/** A kind of file that people have, but that the page does not read. */
interface Format {
  /** What it is, with its article. */
  name: string;
  /** How such a file begins. */
  begins: RegExp;
  /** What to do. */
  advice: string;
}

/** As many bytes say what a file is. */
export const kSniffed = 4096;

const kBlender = (kind: string): string =>
  `convert it with Blender (File, Import, ${kind}; then File, Export, glTF 2.0) and open the GLB`;

const kFormats: Format[] = [
  { name: 'an FBX file', begins: /^(Kaydara FBX Binary|; FBX )/, advice: kBlender('FBX') },
  {
    name: 'a Blender file',
    begins: /^(BLENDER|\(\xb5\/\xfd)/, // or compressed
    advice: 'open it in Blender and choose File, Export, glTF 2.0',
  },
  { name: 'a USDZ file', begins: /^PK.{28}[^/]*\.usd[ac]?/s, advice: kBlender('Universal Scene Description') },
  { name: 'a USD file', begins: /^(PXR-USDC|#usda )/, advice: kBlender('Universal Scene Description') },
  { name: 'a ZIP archive', begins: /^PK../s, advice: 'unpack it and drop the folder, or the GLB or VRM in it' },
  { name: 'a RAR or 7z archive', begins: /^(Rar!|7z\xbc\xaf)/, advice: 'unpack it and drop the folder' },
  { name: 'a Collada file', begins: /^(\xef\xbb\xbf)?<\?xml.*<COLLADA/s, advice: kBlender('Collada') },
  { name: 'a PLY file', begins: /^ply\r?\n/, advice: kBlender('Stanford PLY') },
  { name: 'an STL file', begins: /^solid .*\n\s*facet /, advice: kBlender('STL') },
  {
    name: 'an OBJ file',
    begins: /^(\s*(#[^\n]*|(mtllib|o|g|s|usemtl) [^\n]*))*\s*v\s+-?[\d.]+/,
    advice: kBlender('Wavefront'),
  },
  { name: 'an image', begins: /^(\x89PNG|\xff\xd8\xff|RIFF....WEBP)/s, advice: 'choose it as the paint' },
];

/**
 * Says what a file is that is no glTF, and how to convert it.
 * @param head The first bytes of the file.
 * @returns Undefined if it is none of the known kinds.
 */
export function adviceOn(head: Uint8Array): string | undefined {
  const text = String.fromCharCode(...head);
  const found = kFormats.find(({ begins }) => begins.test(text));
  return found && `this is ${found.name}, which the page cannot open: ${found.advice}`;
}
