import { type Document, type Node, NodeIO, type Primitive } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import draco from 'draco3dgltf';
import { MeshoptDecoder } from 'meshoptimizer';
import { identity, type Matrix, multiply } from '../wasm/src/gltf/matrix.js';
import * as gltf from '../wasm/src/gltf/pieces.js';
import type { SceneMesh } from './scene-file.js';

/** A joint of a skeleton in the scene's space, in the pose of the file. */
export interface Joint {
  /** As in the file; in a VRM file, the name of the humanoid bone that it is mapped to. */
  name: string;
  position: [number, number, number];
  /** Its place in the list; −1 for a root. */
  parent: number;
}

/** What a glTF file shows. */
export interface GlbModel {
  /** All triangles of its scene, a group for each primitive, skins posed; with UVs if every primitive has a set. */
  mesh: SceneMesh;
  /** Names of the groups, as the adapters have them for cages: "node/mesh/material", equal ones once. */
  parts: string[];
  joints: Joint[];
}

/** Reads a glTF file as the adapters do. */
export async function readGlb(path: string): Promise<GlbModel> {
  const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
  await MeshoptDecoder.ready;
  io.registerDependencies({ 'meshopt.decoder': MeshoptDecoder, 'draco3d.decoder': await draco.createDecoderModule() });
  const file = await io.readAsJSON(path);
  const document = await io.readJSON(file);
  const pieces = piecesOf(document);
  const mesh = gltf.joinPieces(pieces) as SceneMesh;
  const sets = pieces.map(({ set }) => set);
  if (sets.every((set) => set !== undefined)) mesh.uvs = Float32Array.from(sets.flatMap((set) => [...set]));
  return { mesh, parts: pieces.map(({ name }) => name), joints: jointsOf(document, bonesOf(file.json)) };
}

function piecesOf(document: Document): (gltf.Piece & { set: Float32Array | undefined })[] {
  const pieces: (gltf.Piece & { set: Float32Array | undefined })[] = [];
  const scene = document.getRoot().getDefaultScene() ?? document.getRoot().listScenes()[0]!;
  scene.traverse((node) => {
    const primitives = node.getMesh()?.listPrimitives() ?? [];
    for (const primitive of primitives) {
      const position = primitive.getAttribute('POSITION');
      if (position === null || !gltf.hasTriangles(primitive.getMode())) continue;
      const names = [node.getName(), node.getMesh()!.getName(), primitive.getMaterial()?.getName()];
      const name = [...new Set(names.filter(Boolean))].join('/');
      const stored = gltf.decodePositions(name, position);
      const posed = pose(node, primitive, stored);
      const localIndices = gltf.decodeTriangles(
        name,
        primitive.getIndices()?.getArray() ?? null,
        primitive.getMode(),
        stored.length / 3,
      );
      const uv = primitive.getAttribute('TEXCOORD_0');
      const last = pieces.at(-1);
      pieces.push({
        name,
        aliases: [],
        matrix: posed === undefined ? node.getWorldMatrix() : identity,
        firstVertex: last ? last.firstVertex + last.vertexCount : 0,
        vertexCount: stored.length / 3,
        firstTriangle: last ? last.firstTriangle + last.triangleCount : 0,
        triangleCount: localIndices.length / 3,
        localPositions: posed ?? stored,
        localIndices,
        set: uv === null ? undefined : gltf.decodeFloats(uv),
      });
    }
  });
  return pieces;
}

/** The positions that a node's skin gives a primitive, in the scene's space; `undefined` without a skin. */
function pose(node: Node, primitive: Primitive, positions: Float32Array): Float32Array | undefined {
  const skin = node.getSkin();
  const [held, weights] = [primitive.getAttribute('JOINTS_0'), primitive.getAttribute('WEIGHTS_0')];
  if (skin === null || held === null || weights === null) return undefined;
  const inverses = skin.getInverseBindMatrices();
  const matrices = skin.listJoints().map((joint, j): Matrix => {
    const world = joint.getWorldMatrix();
    return inverses === null ? world : multiply(world, inverses.getElement(j, []));
  });
  const out = new Float32Array(positions.length);
  const [joints, shares]: [number[], number[]] = [[], []];
  for (let v = 0; v < positions.length / 3; ++v) {
    held.getElement(v, joints);
    weights.getElement(v, shares);
    const [x, y, z] = positions.subarray(3 * v, 3 * v + 3) as unknown as [number, number, number];
    const sum = shares.reduce((total, share) => total + share, 0);
    for (let k = 0; k < 3; ++k) {
      const at = joints.reduce((total, joint, i) => {
        const m = matrices[joint]!;
        return total + shares[i]! * (m[k]! * x + m[4 + k]! * y + m[8 + k]! * z + m[12 + k]!);
      }, 0);
      out[3 * v + k] = at / sum;
    }
  }
  return out;
}

/** The joints of all skins, each once. */
function jointsOf(document: Document, bones: ReadonlyMap<number, string>): Joint[] {
  const nodes = document.getRoot().listNodes();
  const joints = [
    ...new Set(
      document
        .getRoot()
        .listSkins()
        .flatMap((skin) => skin.listJoints()),
    ),
  ];
  return joints.map((joint): Joint => {
    let parent = joint.getParentNode();
    while (parent !== null && !joints.includes(parent)) parent = parent.getParentNode();
    return {
      name: bones.get(nodes.indexOf(joint)) ?? joint.getName(),
      position: [...joint.getWorldTranslation()],
      parent: parent === null ? -1 : joints.indexOf(parent),
    };
  });
}

/** The humanoid bones that a VRM file, 0 or 1, maps its nodes to. */
function bonesOf({ extensions }: { extensions?: Record<string, unknown> }): Map<number, string> {
  type Vrm0 = { humanoid?: { humanBones?: { bone: string; node: number }[] } };
  type Vrm1 = { humanoid?: { humanBones?: Record<string, { node: number }> } };
  const old = (extensions?.['VRM'] as Vrm0 | undefined)?.humanoid?.humanBones ?? [];
  const now = Object.entries((extensions?.['VRMC_vrm'] as Vrm1 | undefined)?.humanoid?.humanBones ?? {});
  return new Map([
    ...old.map(({ bone, node }): [number, string] => [node, bone]),
    ...now.map(([bone, { node }]): [number, string] => [node, bone]),
  ]);
}
