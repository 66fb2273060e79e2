import type { BufferGeometry, Object3D } from 'three';
import { Group, Mesh, MeshStandardMaterial } from 'three';
import { show } from '../core/error.js';
import { defaultLimits, exceeds, type ReadLimits } from '../gltf/checks/read-limits.js';
import { type Format, fileKind } from '../gltf/kinds.js';
import { CagecastError } from '../index.js';
import { checkFbx } from './check-fbx.js';
import { kNotFound, withFiles } from './images.js';
import { sceneGlb } from './scene-glb.js';

/** Reads a file beside a model. */
export interface Companions {
  /**
   * The bytes of a file that the model names: the materials of an OBJ (MTL), images. Undefined if it is not there: then its
   * material has no image. Default: there are none.
   * @param name  As it stands in the model, with slashes.
   */
  read?: ((name: string) => Promise<Uint8Array | undefined>) | undefined;
  /**
   * Called for each file that the model names, but that the GLB goes without: it was not found, or is an image that glTF does not have.
   * Default: nothing is said.
   * @param reason  For people: "it was not found".
   */
  onMissing?: ((name: string, reason: string) => void) | undefined;
  /** Limits other than the default ones: `expansion` for an FBX, `parts` for an OBJ. */
  limits?: Partial<Pick<ReadLimits, 'expansion' | 'parts'>> | undefined;
}

/** What the readers of the formats call. */
interface Beside {
  read: NonNullable<Companions['read']>;
  onMissing: NonNullable<Companions['onMissing']>;
  limits: ReadLimits;
}

/**
 * Makes a GLB of a model in another format: FBX 7 or newer, OBJ with its MTL, PLY, STL, USDZ or USD, as three.js reads it.
 *
 * Kept: triangles, normals, UVs, vertex colours, skins, morph targets, names, the places of nodes, colours and images of materials, whose
 * PNG, JPEG and WebP bytes stay as they are. Lost: animations, cameras, lights, lines and points, images of other types, and what glTF's own
 * materials do not have. Units and axes stay as the loader gives them; where a format has no up axis, y is up. Vertices that are alike
 * become one.
 *
 * Needs three.js; only the loader of the given format is imported. Cost: that of the loader, and linear in the vertices.
 * @param bytes  The whole file. Its content says which format it is.
 * @throws {CagecastError} `badArgument` that says what the file is, or why it cannot be read.
 *
 * @example
 * import { toGlb } from 'cagecast/formats';
 *
 * const glb = await toGlb(await readFile('head.obj'), { read: (name) => readFile(`models/${name}`).catch(() => undefined) });
 */
export async function toGlb(
  bytes: Uint8Array,
  { read = async () => undefined, onMissing = () => {}, limits }: Companions = {},
): Promise<Uint8Array> {
  const wrong = (text: string, cause?: unknown) =>
    new CagecastError('badArgument', 'toGlb', text, { argument: 'bytes', cause });
  if (!(bytes instanceof Uint8Array)) throw wrong(`bytes is ${show(bytes)}, not a Uint8Array`);
  const kind = fileKind(bytes);
  if (kind?.format === undefined)
    throw wrong(kind ? `is ${kind.name}; ${kind.advice}` : 'is neither FBX, OBJ, PLY, STL nor USDZ');
  let glb: Uint8Array | undefined;
  const told = new Set<string>();
  const tellOnce: typeof onMissing = (name, reason) => {
    if (!told.has(name)) onMissing(name, reason);
    told.add(name);
  };
  try {
    glb = await sceneGlb(
      await readers[kind.format](bytes, { read, onMissing: tellOnce, limits: { ...defaultLimits, ...limits } }),
    );
  } catch (error) {
    throw wrong(`is ${kind.name}, but cannot be read (${(error as Error).message.split('\n', 1)[0]})`, error);
  }
  if (!glb) throw wrong(`is ${kind.name} without any triangle`);
  return glb;
}

const bufferOf = (bytes: Uint8Array): ArrayBuffer => Uint8Array.from(bytes).buffer;
const textOf = (bytes: Uint8Array): string => new TextDecoder().decode(bytes);

/** What reads each format. */
const readers: Record<Format, (bytes: Uint8Array, beside: Beside) => Promise<Object3D>> = {
  async fbx(bytes, { read, onMissing, limits }) {
    await checkFbx(bytes, limits);
    const { FBXLoader } = await import('three/addons/loaders/FBXLoader.js');
    return withFiles(read, async () => new FBXLoader().parse(bufferOf(bytes), ''), onMissing);
  },
  async obj(bytes, { read, onMissing, limits }) {
    const [{ OBJLoader }, { MTLLoader }] = await Promise.all([
      import('three/addons/loaders/OBJLoader.js'),
      import('three/addons/loaders/MTLLoader.js'),
    ]);
    const text = textOf(bytes);
    const groups = text.match(/^\s*(?:g|o|usemtl)\s/gm)?.length ?? 0;
    if (groups > limits.parts) throw exceeds(`has ${groups.toLocaleString('en')} groups`, 'parts', limits);
    const libraries = [...text.matchAll(/^\s*mtllib\s+(.+?)\s*$/gm)].map(([, name]) => name!);
    const names = libraries.map((name) => name.replaceAll('\\', '/'));
    const found = await Promise.all(names.map(read));
    for (const [i, library] of found.entries()) if (!library) onMissing(names[i]!, kNotFound);
    const materials = found.flatMap((library) => (library ? [textOf(library)] : [])).join('\n');
    return withFiles(
      read,
      async () => {
        const creator = new MTLLoader().parse(materials, '');
        creator.preload();
        return new OBJLoader().setMaterials(creator).parse(text);
      },
      onMissing,
    );
  },
  async ply(bytes) {
    const { PLYLoader } = await import('three/addons/loaders/PLYLoader.js');
    const geometry = new PLYLoader().parse(bufferOf(bytes));
    return geometry.index ? meshOf(geometry) : new Group(); // of points
  },
  async stl(bytes) {
    const { STLLoader } = await import('three/addons/loaders/STLLoader.js');
    // Its normals are those of the triangles, which glTF has without them.
    return meshOf(new STLLoader().parse(bufferOf(bytes)).deleteAttribute('normal'));
  },
  async usd(bytes, { read, onMissing }) {
    const { USDLoader } = await import('three/addons/loaders/USDLoader.js');
    return withFiles(
      read,
      () => new Promise<Group>((resolve, reject) => new USDLoader().parse(bufferOf(bytes), '', resolve, reject)),
      onMissing,
    );
  },
};

function meshOf(geometry: BufferGeometry): Object3D {
  const material = new MeshStandardMaterial({ roughness: 0.9, vertexColors: geometry.hasAttribute('color') });
  return new Group().add(new Mesh(geometry, material));
}
