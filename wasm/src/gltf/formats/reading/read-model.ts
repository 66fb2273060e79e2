import type { BufferGeometry, Material, Object3D } from 'three';
import { Group, Mesh, MeshStandardMaterial } from 'three';
import { FBXLoader } from 'three/addons/loaders/FBXLoader.js';
import { MTLLoader } from 'three/addons/loaders/MTLLoader.js';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { STLLoader } from 'three/addons/loaders/STLLoader.js';
import { USDLoader } from 'three/addons/loaders/USDLoader.js';
import { exceeds } from '../../checks/read-limits.js';
import type { Format } from '../../kinds.js';
import { checkLibraries, checkMaterials, librariesOf } from '../checks/obj.js';
import { type FormatLimits, mostBytes } from '../limits.js';
import { nameUvSets } from './fbx.js';
import { guardLoaders, mendUsd } from './guards.js';
import { kNotFound, withFiles } from './images.js';
import { plainMaterials } from './mtl.js';
import { withConvexFaces } from './obj.js';
import { readPly } from './ply.js';
import { sceneGlb } from './scene-glb.js';

/** What the readers of the formats call. */
interface Beside {
  read(name: string): Promise<Uint8Array | undefined>;
  onMissing(name: string, reason: string): void;
  limits: FormatLimits;
}

/** Makes a GLB of a model, in a thread of its own. @returns nothing if it has no triangle. */
export async function readModel(
  format: Format,
  bytes: Uint8Array,
  { read, onMissing, limits }: Beside,
): Promise<Uint8Array<ArrayBuffer> | undefined> {
  guardLoaders(limits);
  mendUsd();
  let readBytes = bytes.length;
  const counted: Beside['read'] = async (name) => {
    const found = await read(name);
    readBytes += found?.length ?? 0;
    return found;
  };
  const scene = await readers[format](bytes, { read: counted, onMissing, limits });
  const check = (size: number) => {
    const most = mostBytes(readBytes, limits);
    if (size > most)
      throw exceeds(`becomes a GLB of more than ${most.toLocaleString('en')} bytes`, 'expansion', limits);
  };
  return sceneGlb(scene, check, limits);
}

const bufferOf = (bytes: Uint8Array): ArrayBuffer => Uint8Array.from(bytes).buffer;
const textOf = (bytes: Uint8Array): string => new TextDecoder().decode(bytes);

/** What reads each format. */
const readers: Record<Format, (bytes: Uint8Array, beside: Beside) => Promise<Object3D>> = {
  async fbx(bytes, { read, onMissing, limits }) {
    const scene = await withFiles(read, async () => new FBXLoader().parse(bufferOf(bytes), ''), onMissing);
    nameUvSets(scene, bytes, limits);
    const centimetres = Number(scene.userData['unitScaleFactor']);
    if (centimetres > 0 && Number.isFinite(centimetres)) scene.scale.multiplyScalar(centimetres / 100);
    return scene;
  },
  async obj(bytes, { read, onMissing, limits }) {
    const text = textOf(bytes);
    const names = librariesOf(text);
    const found = await Promise.all(names.map(read));
    for (const [i, library] of found.entries()) if (!library) onMissing(names[i]!, kNotFound);
    const libraries = found.filter((library) => library !== undefined);
    checkLibraries(libraries, bytes.length, limits);
    const materials = libraries.map(textOf).join('\n');
    checkMaterials(materials, limits);
    return withFiles(
      read,
      async () => {
        const creator = new MTLLoader().parse(plainMaterials(materials), '');
        creator.preload();
        showAll(Object.values(creator.materials));
        return new OBJLoader().setMaterials(creator).parse(withConvexFaces(text));
      },
      onMissing,
    );
  },
  async ply(bytes) {
    const geometry = readPly(bytes);
    return geometry ? meshOf(geometry) : new Group(); // of points
  },
  // Its normals are those of the triangles, which glTF has without them.
  stl: async (bytes) => meshOf(new STLLoader().parse(bufferOf(bytes)).deleteAttribute('normal')),
  usd: async (bytes, { read, onMissing }) =>
    withFiles(
      read,
      () => new Promise<Group>((resolve, reject) => new USDLoader().parse(bufferOf(bytes), '', resolve, reject)),
      onMissing,
    ),
};

/** Some programs write an opacity of 0 for all that is opaque. */
function showAll(materials: readonly Material[]): void {
  if (materials.every(({ opacity }) => opacity === 0))
    for (const material of materials) Object.assign(material, { opacity: 1, transparent: false });
}

function meshOf(geometry: BufferGeometry): Object3D {
  const material = new MeshStandardMaterial({ roughness: 0.9, vertexColors: geometry.hasAttribute('color') });
  return new Group().add(new Mesh(geometry, material));
}
