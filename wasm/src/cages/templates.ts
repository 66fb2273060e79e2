import { CagecastError, show } from '../core/error.js';
import { readFile } from '../core/read-file.js';
import { readTemplate as withExtras } from '../parts/template-extras.js';
import { type TemplateName, templateNames } from './template-names.js';
import type { Cage } from './types.js';

// Bundlers find the files only in this form.
const files: Record<TemplateName, () => URL> = {
  'human-head': () => new URL('./templates/human-head.glb', import.meta.url),
  'human-body': () => new URL('./templates/human-body.glb', import.meta.url),
  'animal-head': () => new URL('./templates/animal-head.glb', import.meta.url),
  car: () => new URL('./templates/car.glb', import.meta.url),
  'face-mask': () => new URL('./templates/face-mask.glb', import.meta.url),
};

/**
 * Loads a template that comes with the package: a cage with landmarks and named holes, to be fitted to a model of its kind.
 * Left is +x, up +y, front +z; the UVs are mirror images of each other, u becoming 1 - u.
 *
 * Cost: a file of up to 40 KB, loaded each time.
 * @throws {CagecastError} `badArgument` if there is no such template; `unsupported` if its file cannot be loaded.
 *
 * @example
 * import { fitCage, loadTemplate } from 'cagecast/cages';
 *
 * const { cage } = await fitCage(await loadTemplate('human-head'), model);
 */
export async function loadTemplate(name: TemplateName): Promise<Cage> {
  if (!templateNames.includes(name))
    throw new CagecastError(
      'badArgument',
      'loadTemplate',
      `name is ${show(name)}, not one of ${templateNames.map((known) => `"${known}"`).join(', ')}`,
    );
  let url: URL | undefined;
  try {
    url = files[name]();
    return readTemplate(await readFile(url));
  } catch (cause) {
    throw new CagecastError(
      'unsupported',
      'loadTemplate',
      `the file of "${name}"${url ? `, ${url.href},` : ''} cannot be loaded (${String(cause)}); its bytes can be given instead`,
      { cause },
    );
  }
}

interface Json {
  meshes: [
    { extras: unknown; primitives: [{ attributes: { POSITION: number; TEXCOORD_0: number }; indices: number }] },
  ];
  accessors: { bufferView: number; byteOffset?: number; componentType: number; count: number; type: string }[];
  bufferViews: { byteOffset?: number; byteStride?: number }[];
}

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const kFloat = 5126;

/** Reads a GLB with one mesh of floats and 16-bit indices, as those of examples/samples/templates are. */
function readTemplate(bytes: Uint8Array<ArrayBuffer>): Cage {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const textLength = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + textLength))) as Json;
  const binary = 28 + textLength;
  const numbersOf = (accessor: number, size: number): number[] => {
    const { bufferView, byteOffset = 0, componentType, count } = json.accessors[accessor]!;
    const { byteOffset: start = 0, byteStride } = json.bufferViews[bufferView]!;
    const width = componentType === kFloat ? 4 : 2;
    return Array.from({ length: count * size }, (_, i) => {
      const at = binary + start + byteOffset + Math.floor(i / size) * (byteStride ?? size * width) + (i % size) * width;
      return width === 4 ? view.getFloat32(at, true) : view.getUint16(at, true);
    });
  };
  const [{ extras, primitives }] = json.meshes;
  const { attributes, indices } = primitives[0];
  const positions = Float32Array.from(numbersOf(attributes.POSITION, 3));
  const source = { extras, place: 'meshes[0]', matrix: identity, firstVertex: 0, vertexCount: positions.length / 3 };
  const mesh = {
    positions,
    uvs: Float32Array.from(numbersOf(attributes.TEXCOORD_0, 2)),
    indices: Uint32Array.from(numbersOf(indices, 1)),
  };
  return withExtras(mesh, [source], (text) => new Error(text));
}
