import type { BufferGeometry, Object3D } from 'three';
import type { Cage, CageModel, Template } from '../../cages/types.js';
import { type VrmExtensions, vrmBones } from '../../parts/joints.js';
import { vrmExpressions } from '../../parts/morph-names.js';
import { readTemplate } from '../../parts/template-extras.js';
import { cageModelWith, readJoints } from '../../scene/cage-model.js';
import { wrong } from '../errors.js';
import { baseColorsOf } from './base-colors.js';
import { asItWas, extract, extrasOf, morphedParts, type Part } from './extract-scene.js';
import { isSkinned } from './flags.js';
import { geometryOf, isLoadedGltf, type Loaded, type LoadedCage, type LoadedGltf, objectOf } from './models.js';
import { skinOf } from './places.js';

/**
 * What `cagecast/cages` needs of a model: its triangles, a part for each mesh or material group, the joints of its skeletons, in the
 * bind pose, the place of its face by its morph targets, and the colours of its parts, by which a painted face is found.
 * Textures whose pixels cannot be read are left out: compressed ones, and images of another origin that does not allow it.
 * Cost: some milliseconds for each texture, each in a task of its own; nothing for a texture that was read before.
 * @throws {CagecastError} `badArgument` that names the mesh.
 */
export async function cageModel(model: Loaded): Promise<CageModel> {
  return { ...shapeOf(model), ...(await baseColorsOf(objectOf(model))) };
}

/** Of the model for cages, all but its colours. */
function shapeOf(model: Loaded): CageModel {
  const object = objectOf(model);
  return asItWas(object, undefined, () => {
    const { mesh, parts, names } = extract(object, 'model');
    const [bones, expressions] = isLoadedGltf(model) ? [bonesOf(model), expressionsOf(model)] : [new Map()];
    return cageModelWith(mesh, names, skeletonOf(parts, bones), morphedParts(parts, mesh.positions, expressions));
  });
}

/** The names of the expressions that use the morph targets of a mesh. */
function expressionsOf(loaded: LoadedGltf): (mesh: Part['mesh'], target: number) => string[] {
  const expressions = vrmExpressions(extensionsOf(loaded));
  const placeOf = (object: Object3D | null | undefined) => loaded.parser?.associations?.get(object as object);
  return (mesh, t) => expressions(placeOf(mesh)?.nodes ?? placeOf(mesh?.parent)?.nodes, placeOf(mesh)?.meshes, t);
}

/**
 * A loaded cage as a template: its mesh, and the landmarks in its `userData`, where GLTFLoader puts the `extras` of a node or mesh.
 * @throws {CagecastError} `badArgument`, `missingUvs`
 */
export function cageTemplate(model: LoadedCage): Template {
  const { mesh, parts } = extract(model, 'template');
  if (mesh.uvs === undefined)
    throw wrong('template has a mesh without the attribute uv', 'cageTemplate', 'missingUvs', { argument: 'template' });
  const sources = parts.flatMap(({ name, mesh: of, geometry, matrix, firstVertex, vertexCount }) =>
    extrasOf({ mesh: of, geometry }).map((extras) => ({
      extras,
      place: `"${name}"`,
      matrix: (of?.parent && extras === of.parent.userData ? of.parent.matrixWorld : matrix).elements,
      firstVertex,
      vertexCount,
    })),
  );
  const { positions, indices, uvs } = mesh;
  return readTemplate({ positions, indices, uvs }, sources, (text) => wrong(text, 'cageTemplate'));
}

/**
 * The geometry of a cage, with normals, to be shown. Landmarks, holes and kind are in its `userData`, which GLTFExporter
 * does not write: `cageGlb` of `cagecast/cages` writes a file with them.
 */
export function cageGeometry(cage: Pick<Cage, 'positions' | 'uvs' | 'indices'> & Partial<Cage>): BufferGeometry {
  const geometry = geometryOf(cage);
  geometry.computeVertexNormals();
  return geometry;
}

function extensionsOf({ userData, parser }: LoadedGltf): VrmExtensions | undefined {
  // GLTFLoader keeps extensions that it does not know here.
  const kept = userData?.['gltfExtensions'] as VrmExtensions | undefined;
  return kept?.VRM || kept?.VRMC_vrm ? kept : parser?.json?.extensions;
}

function bonesOf(loaded: LoadedGltf): Map<Object3D, string> {
  const bones = vrmBones(extensionsOf(loaded));
  const found = new Map<Object3D, string>();
  for (const [object, place] of loaded.parser?.associations ?? []) {
    const bone = place?.nodes === undefined ? undefined : bones.get(place.nodes);
    if (bone !== undefined && (object as Object3D).isObject3D) found.set(object as Object3D, bone);
  }
  return found;
}

function skeletonOf(parts: readonly Part[], bones: Map<Object3D, string>) {
  const held = parts.flatMap(({ mesh, matrix, vertexCount }) => {
    const skin = mesh && isSkinned(mesh) ? skinOf(mesh) : undefined;
    return mesh ? [{ node: mesh as Object3D, matrix: matrix.elements, vertexCount, skin }] : [];
  });
  return readJoints(held, bones.keys(), {
    nameOf: (bone) => bones.get(bone) ?? bone.name,
    matrixOf: ({ matrixWorld }) => matrixWorld.elements,
    parentOf: ({ parent }) => parent,
  });
}
