import type { CageModel, Template } from '../cages/types.js';
import { nameOfGlass, transmissionExtension } from '../parts/drawn.js';
import { faceHints } from '../parts/face-hints.js';
import { jointPlace, type ReadJoint, readSkeleton, type VrmExtensions, vrmBones } from '../parts/joints.js';
import { fromOrigin } from '../parts/origin.js';
import { readTemplate } from '../parts/template-extras.js';
import { type Extracted, morphedParts, type Part, parentsOf, skinOf, worldMatrices } from './extract-file.js';
import { InputError } from './input-error.js';
import type { GltfFile } from './open-gltf.js';

/** What `cagecast/cages` needs of a file: its mesh, the names of its parts, its joints, and where its face is. */
export function cageModelOf(file: GltfFile, { mesh, parts, origin }: Extracted): CageModel {
  const { positions, indices, groups } = mesh;
  return {
    positions,
    indices,
    groups,
    names: partNamesOf(file, parts),
    ...skeletonOf(file, { parts, origin }),
    hints: faceHints(morphedParts(file, parts, positions)),
  };
}

/** The names of each part. */
export const partNamesOf = ({ json: { meshes = [], materials = [] } }: GltfFile, parts: readonly Part[]): string[][] =>
  parts.map(({ aliases, name, mesh, primitive }) => {
    const material = materials[meshes[mesh]!.primitives[primitive]!.material ?? -1];
    const alpha = material?.pbrMetallicRoughness?.baseColorFactor?.[3];
    const transmission = material?.extensions?.[transmissionExtension] as { transmissionFactor?: number } | undefined;
    const names = aliases.length > 0 ? aliases : [name];
    return [...names, ...nameOfGlass(material?.alphaMode, alpha, transmission?.transmissionFactor)];
  });

/** A file as a template: its mesh, and what the extras of its nodes and meshes say. @throws {InputError} that names the file. */
export function templateOf({ json, path }: GltfFile, { mesh, parts }: Extracted): Template {
  const sources = parts.flatMap((part) => [
    { ...part, extras: json.meshes![part.mesh]!.extras, place: `meshes[${part.mesh}]` },
    { ...part, extras: json.nodes![part.node]!.extras, place: `nodes[${part.node}]` },
  ]);
  const { positions, indices, uvs } = mesh;
  return readTemplate({ positions, indices, uvs: uvs! }, sources, (text) => new InputError(text).in(path));
}

/** The joints of a file, and which holds each vertex of parts, in their order. */
export function skeletonOf(file: GltfFile, { parts, origin }: Pick<Extracted, 'parts' | 'origin'>) {
  const { nodes = [], extensions } = file.json;
  const parents = parentsOf(nodes);
  const bones = vrmBones(extensions as VrmExtensions | undefined);
  const matrices = worldMatrices(file.json);
  const nameOf = (node: number) => bones.get(node) ?? nodes[node]!.name ?? `nodes[${node}]`;
  const atNode = (node: number): ReadJoint<number> => ({
    node,
    name: nameOf(node),
    position: fromOrigin(matrices[node]!, origin).slice(12, 15) as [number, number, number],
  });
  const joints = parts.flatMap((part) => {
    const skin = nodes[part.node]!.skin;
    if (skin === undefined) return [];
    const { joints: held = [], inverseBindMatrices } = file.json.skins![skin]!;
    const inverses = file.accessors[inverseBindMatrices ?? -1]?.getArray();
    return held.map((node, j) => {
      const position = inverses ? jointPlace(part.matrix, inverses.subarray(16 * j)) : undefined;
      return position ? { node, name: nameOf(node), position } : atNode(node);
    });
  });
  const others = [...bones.keys()].filter((node) => node >= 0 && node < nodes.length).map(atNode);
  const held = parts.map((part) => ({ ...part, skin: skinOf(file, part) }));
  return readSkeleton([...joints, ...others], held, (node) => parents.get(node));
}
