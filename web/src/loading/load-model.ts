import { Group, type Light, LoadingManager, Mesh, type Object3D, type WebGLRenderer } from 'three';
import { type GLTF, GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { giveBackTriangles } from '#three';
import { disposeAfterFrame } from '../platform/programs';
import { noteCarried } from '../state/made-cages';
import type { Loader, Model } from '../state/model';
import { reasonOf } from '../state/wording';
import { bringNear } from './bring-near';
import { meshesOf } from './extract-mesh';
import { companionOf } from './file-paths';
import { readGltfHead } from './gltf-file';

/**
 * Reads a GLB or glTF model, Draco, meshopt, KTX2 and quantised data included; a model of another format as the GLB that is made of it.
 * @param given      The model.
 * @param renderer   Undefined without WebGL.
 * @param companions Files a model may refer to (a .bin, an .mtl, images), found by name.
 * @param isOwn      Whether it is a GLB of the page's own, which is trusted.
 * @param signal     Ends the reading of a model of another format.
 * @throws Error with a message that begins with the file's name.
 */
export async function loadModel(
  given: File,
  renderer: WebGLRenderer | undefined,
  companions: readonly File[] = [],
  isOwn = false,
  signal?: AbortSignal,
): Promise<Model> {
  const urls = new Map<string, string>();
  const begun = performance.now();
  try {
    // The page begins without what judges the files of others.
    const judge = isOwn ? undefined : await import('./given-file');
    const { file, bytes } = judge
      ? await judge.readAsGltf(given, companions, signal)
      : { file: given, bytes: await given.arrayBuffer() };
    const head = readGltfHead(bytes);
    if (judge && head.binary) {
      const [cage, paint] = ['cage', 'paint'].map((key) => judge.embeddedIn(bytes, head.json, key));
      if (cage ?? paint) noteCarried(file, { cage, paint });
    }
    const used = [...new Set(head.uris.map((uri) => findCompanion(uri, companions, file)))];
    await judge?.checkCost(bytes, used);
    for (const uri of head.uris) urls.set(uri, URL.createObjectURL(findCompanion(uri, companions, file)));

    const manager = new LoadingManager().setURLModifier((url) => urls.get(decodeURIComponent(url)) ?? url);
    const loader = new GLTFLoader(manager);
    const release = await addDecoders(loader, manager, head.extensions, renderer);
    try {
      const loaded = await loader.parseAsync(bytes, '');
      const scene = await sceneOf(loaded);
      bringNear(scene);
      const { associations, json } = loaded.parser;
      const meshes = meshesOf(scene, (mesh) => nameOf(mesh, loaded));
      const read = async (uri: string) => (await fetch(manager.resolveURL(uri))).arrayBuffer();
      const damage = await judge?.damageOf(loaded, read);
      return {
        name: file.name,
        files: [file, ...used],
        scene,
        loaded: { scene, userData: loaded.userData, parser: { associations, json: { extensions: json.extensions } } },
        animations: loaded.animations,
        ...meshes,
        spent: performance.now() - begun,
        ...(damage && { damage: `${file.name}: ${damage}` }),
      };
    } finally {
      release();
    }
  } catch (error) {
    throw new Error(`${given.name}: ${messageOf(error)}`, { cause: error });
  } finally {
    for (const url of urls.values()) URL.revokeObjectURL(url);
  }
}

/** Frees the GPU memory of a model. */
export function disposeModel({ cageMesh }: Model): void {
  for (const primitive of cageMesh.primitives) {
    primitive.mesh.geometry.dispose();
    const materials = [primitive.mesh.material].flat();
    for (const material of materials)
      for (const value of Object.values(material)) if (value?.isTexture) value.dispose();
    disposeAfterFrame(materials);
  }
}

/** The page's own loader. @param renderer Undefined without WebGL. */
export const loaderFor = (renderer: WebGLRenderer | undefined): Loader => ({
  load: (file, companions, signal) => loadModel(file, renderer, companions, false, signal),
  loadOwn: (file) => loadModel(file, renderer, [], true),
  dispose: disposeModel,
});

/** The default scene, or all nodes of a file without scenes; with exactly the file's node matrices. */
async function sceneOf({ scene, parser }: GLTF): Promise<Object3D> {
  const nodes: Object3D[] = scene ? [] : await parser.getDependencies('node');
  const root = scene ?? new Group().add(...nodes.filter((node) => !node.parent));
  root.traverse((object) => {
    // The stage has lights of its own; thousands of others would keep shaders from being compiled.
    if ((object as Partial<Light>).isLight) object.layers.disableAll();
    // An extension that the loader does not know.
    if (object.userData['gltfExtensions']?.KHR_node_visibility?.visible === false) object.visible = false;
    const matrix: number[] | undefined = parser.json.nodes?.[parser.associations.get(object)?.nodes ?? -1]?.matrix;
    if (!matrix) return;
    // The loader decomposes matrices, which rounds them and loses shear.
    object.matrixAutoUpdate = false;
    object.matrix.fromArray(matrix);
  });
  giveBackTriangles(root);
  // Ignore overlays that an earlier transfer added; `cagecast transfer` marks them.
  const overlays: Object3D[] = [];
  root.traverse((object) => {
    // The loader gives a mesh one material.
    if (object instanceof Mesh && [object.geometry, object.material].some(({ userData }) => userData.cagecastOverlay))
      overlays.push(object);
  });
  for (const overlay of overlays) overlay.removeFromParent();
  return root;
}

/** The name of a mesh as the command line reports it: its node's, and its material's if the node has several primitives. */
function nameOf(mesh: Mesh, { parser }: GLTF): string | undefined {
  const { nodes = [], meshes = [], materials = [] } = parser.json;
  const place = parser.associations.get(mesh);
  const primitives: { material?: number }[] = meshes[place?.meshes ?? -1]?.primitives ?? [];
  // The loader merges a node with its mesh, unless that has several primitives.
  const node = nodes[place?.nodes ?? (mesh.parent && parser.associations.get(mesh.parent)?.nodes) ?? -1];
  const name: string | undefined = node?.name ?? meshes[place?.meshes ?? -1]?.name;
  const material: string | undefined = materials[primitives[place?.primitives ?? -1]?.material ?? -1]?.name;
  return name !== undefined && material !== undefined && material !== name && primitives.length > 1
    ? `${name}/${material}`
    : name;
}

function findCompanion(uri: string, companions: readonly File[], model: File): File {
  const found = companionOf(uri, companions, model);
  if (found) return found;
  const name = uri.split(/[\\/]/).at(-1)!;
  const other = companions.find((file) => file.name.toLowerCase() === name.toLowerCase());
  if (other) throw new Error(`the model needs the file ${uri}; there is ${other.name}, whose name has other capitals`);
  throw new Error(`the model needs the file ${uri}; choose or drop both together`);
}

/** Adds the decoders that the file needs, fetched on demand. @returns A function that frees them. */
async function addDecoders(
  loader: GLTFLoader,
  manager: LoadingManager,
  extensions: string[],
  renderer: WebGLRenderer | undefined,
): Promise<() => void> {
  const held: { dispose(): void }[] = [];
  if (extensions.includes('EXT_meshopt_compression') || extensions.includes('KHR_meshopt_compression')) {
    const { MeshoptDecoder } = await import('meshoptimizer/decoder'); // as in the worker that exports: one file
    loader.setMeshoptDecoder(MeshoptDecoder);
  }
  if (extensions.includes('KHR_texture_basisu')) {
    const { makeKtx2Loader } = await import('./ktx2');
    const ktx2 = makeKtx2Loader(manager, renderer);
    loader.setKTX2Loader(ktx2);
    held.push(ktx2);
  }
  if (extensions.includes('KHR_draco_mesh_compression')) {
    const { makeDracoLoader } = await import('./draco');
    const draco = makeDracoLoader(manager);
    loader.setDRACOLoader(draco);
    held.push(draco);
  }
  return () => held.forEach((decoder) => decoder.dispose());
}

function messageOf(error: unknown): string {
  // The loader fails like this when it reads past the end of a buffer.
  if (error instanceof RangeError || error instanceof TypeError)
    return 'the file is damaged: it refers to data it does not contain';
  if (error instanceof Error) return reasonOf(error).replace(/^THREE\.\w+: /, '');
  // Decoders reject with a message or an event.
  return (error as { error?: string })?.error ?? 'the file cannot be decoded';
}
