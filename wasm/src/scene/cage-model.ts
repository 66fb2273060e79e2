import type { Mesh } from '../api/mesh.js';
import type { CageModel, Template } from '../cages/types.js';
import { type Matrix, multiply } from '../parts/affine.js';
import { groupsNamed, nameOfGlass, transmissionExtension } from '../parts/drawn.js';
import { faceHints } from '../parts/face-hints.js';
import {
  type HeldPart,
  jointPlace,
  type ReadJoint,
  readSkeleton,
  type VrmExtensions,
  vrmBones,
} from '../parts/joints.js';
import { fromOrigin } from '../parts/origin.js';
import type { MorphedPart } from '../parts/poses.js';
import type { Skin } from '../parts/skin.js';
import { bareNames, readTemplate } from '../parts/template-extras.js';
import { baseColorsOf } from './base-colors.js';
import { type Extracted, morphedParts, type Part, skinOf } from './extract.js';
import { InputError, withName } from './input-error.js';
import { type ImageCodec, Materials } from './materials.js';
import { parentsOf, type SceneSource, worldMatrices } from './source.js';

/** A part, how joints hold it, and where it is. */
interface SkinnedPart<Node> extends HeldPart<Node> {
  matrix: Matrix;
  skin: Skin<Node> | undefined;
}

/** The nodes of a skeleton. */
interface SkeletonNodes<Node> {
  nameOf(node: Node): string;
  /** The matrix to the space of the arrays. */
  matrixOf(node: Node): Matrix;
  parentOf(node: Node): Node | null | undefined;
}

/**
 * The joints of a model, in the bind pose, and which holds each vertex of its parts.
 * @param bones  Joints that are known by other names than those of skins.
 */
export function readJoints<Node>(
  parts: readonly SkinnedPart<Node>[],
  bones: Iterable<Node>,
  { nameOf, matrixOf, parentOf }: SkeletonNodes<Node>,
): ReturnType<typeof readSkeleton> {
  const atNode = (node: Node) => matrixOf(node).slice(12, 15) as ReadJoint<Node>['position'];
  const jointOf = (node: Node, position = atNode(node)) => ({ node, name: nameOf(node), position });
  const joints = parts.flatMap(({ skin, matrix }) =>
    (skin?.joints ?? []).map((node, j) => {
      const inverse = skin!.inverseOf(j);
      return jointOf(node, inverse && jointPlace(matrix, multiply(inverse, skin!.bind)));
    }),
  );
  return readSkeleton([...joints, ...[...bones].map((node) => jointOf(node))], parts, parentOf);
}

/** A model as `cagecast/cages` needs it, without its colours. @param morphs  Its parts, and what moves them. */
export const cageModelWith = (
  { positions, indices, groups, poses }: Mesh & { indices: Uint32Array },
  names: string[][],
  joints: ReturnType<typeof readSkeleton>,
  morphs: readonly MorphedPart[],
): CageModel => ({
  positions,
  indices,
  groups,
  names,
  ...(poses && { poses }),
  ...joints,
  hints: faceHints(morphs),
});

/**
 * What `cagecast/cages` needs of a glTF: its mesh, the names of its parts, its joints, where its face is, and what its parts look like.
 * @param decode  Default: colours are not looked at.
 */
export async function cageModelOf(
  source: SceneSource,
  extracted: Extracted,
  decode: ImageCodec['decode'] | undefined,
): Promise<CageModel> {
  const { mesh, parts } = extracted;
  const morphs = morphedParts(source, parts, mesh.positions);
  const shape = cageModelWith(mesh, partNamesOf(source, parts), skeletonOf(source, extracted), morphs);
  return { ...shape, ...(decode && (await baseColorsOf(new Materials(source, parts), decode))) };
}

/** The names of each part; see-through ones are called glass besides. */
export const partNamesOf = (
  { json: { meshes = [], materials = [] } }: SceneSource,
  parts: readonly Part[],
): string[][] =>
  parts.map(({ aliases, name, mesh, primitive }) => {
    const material = materials[meshes[mesh]!.primitives[primitive]!.material ?? -1];
    const alpha = material?.pbrMetallicRoughness?.baseColorFactor?.[3];
    const transmission = material?.extensions?.[transmissionExtension] as { transmissionFactor?: number } | undefined;
    const names = aliases.length > 0 ? aliases : [name];
    return [...names, ...nameOfGlass(material?.alphaMode, alpha, transmission?.transmissionFactor)];
  });

/** The extras of the meshes and nodes of parts. */
export const extrasIn = (source: SceneSource, parts: readonly Part[]): unknown[] =>
  extrasOf(source, parts).map(({ extras }) => extras);

/** The same, with their places. */
const extrasOf = ({ json: { meshes, nodes }, isUnnumbered }: SceneSource, parts: readonly Part[]) =>
  parts.flatMap((part) => {
    const [mesh, node] = isUnnumbered
      ? [`mesh of "${part.name}"`, `"${part.name}"`]
      : [`meshes[${part.mesh}]`, `nodes[${part.node}]`];
    return [
      { ...part, extras: meshes![part.mesh]!.extras, place: mesh },
      { ...part, extras: nodes![part.node]!.extras, place: node },
    ];
  });

/** A glTF with UVs as a template: its mesh, and what the extras of its nodes and meshes say. @throws {InputError} that names the file. */
export function templateOf(source: SceneSource, { mesh, parts }: Pick<Extracted, 'mesh' | 'parts'>): Template {
  const { positions, indices, uvs } = mesh;
  const fail = (text: string) => withName(new InputError(text), source.path) as InputError;
  return readTemplate({ positions, indices, uvs: uvs! }, extrasOf(source, parts), fail);
}

/** The parts of a target that a cage was made without, by the names in the extras of the cage. */
export const partsWithout = (source: SceneSource, parts: readonly Part[], extras: readonly unknown[]): number[] =>
  groupsNamed(bareNames(extras), partNamesOf(source, parts));

/** The joints of a glTF, and which holds each vertex of parts, in their order. */
export function skeletonOf(source: SceneSource, { parts, origin }: Pick<Extracted, 'parts' | 'origin'>) {
  const { nodes = [], extensions } = source.json;
  const parents = parentsOf(nodes);
  const bones = vrmBones(extensions as VrmExtensions | undefined);
  const matrices = worldMatrices(source.json);
  return readJoints(
    parts.map((part) => ({ ...part, skin: skinOf(source, part) })),
    [...bones.keys()].filter((node) => node >= 0 && node < nodes.length),
    {
      nameOf: (node) => bones.get(node) ?? nodes[node]!.name ?? `nodes[${node}]`,
      matrixOf: (node) => fromOrigin(matrices[node]!, origin),
      parentOf: (node) => parents.get(node),
    },
  );
}
