import type { GLTF } from '@gltf-transform/core';
import { identity, type Matrix, multiply } from '../parts/affine.js';
import type { AccessorData } from './accessor.js';
import { localMatrix } from './matrix.js';
import type { UvSetChoice } from './uv-sets.js';

/** A glTF as all that reads scenes sees it: a file, or a document as the file that it would be. */
export interface SceneSource {
  /** Its name, for messages. Default: none. */
  readonly path?: string;
  /** Nodes, meshes, skins, materials and textures. Not to be changed. */
  readonly json: GLTF.IGLTF;
  /** Decoded, in the order of the JSON. */
  readonly accessors: readonly AccessorData[];
  /** Whether people know its elements by names alone, so that messages have no numbers. Default: no. */
  readonly isUnnumbered?: true;
  /** Primitives that are transparent wherever they lie, as `clearPrimitives` finds them. Default: none are known. */
  readonly clear?: ReadonlySet<GLTF.IMeshPrimitive> | undefined;
  /** The UV set that counts where it is a cage, if it was chosen. Default: `chooseUvSet` finds it. */
  readonly cageUvs?: UvSetChoice | undefined;
  /** The file of the image of a texture; `undefined` if it has none. */
  imageOf(texture: number): Promise<ImageBytes | undefined>;
}

/** An image file. */
export interface ImageBytes {
  bytes: Uint8Array;
  mimeType: string;
}

/** The nodes that are children of none. */
export function topNodes(nodes: readonly GLTF.INode[]): number[] {
  const children = new Set(nodes.flatMap((node) => node.children ?? []));
  return [...nodes.keys()].filter((node) => !children.has(node));
}

/** The node above each node that is below one. */
export const parentsOf = (nodes: readonly GLTF.INode[]): Map<number, number> =>
  new Map(nodes.flatMap((node, n) => (node.children ?? []).map((child) => [child, n])));

/** Returns what finds the names of the nodes above a node. */
export function aboveIn({ nodes = [] }: GLTF.IGLTF): (node: number) => string[] {
  const parents = parentsOf(nodes);
  return (node) => {
    const names: string[] = [];
    for (let n = parents.get(node); n !== undefined; n = parents.get(n)) names.push(nodes[n]!.name ?? '');
    return names;
  };
}

/** The nodes of the default scene, else of the first, that are below no other. */
export function roots({ scene, scenes = [], nodes = [] }: GLTF.IGLTF): number[] {
  const chosen = scenes[scene ?? 0];
  // A file without scenes is a library of nodes; all of them are used.
  return chosen ? (chosen.nodes ?? []) : topNodes(nodes);
}

/** The matrix of each node to the scene, including nodes that are in no scene. */
export function worldMatrices({ nodes = [] }: GLTF.IGLTF): Matrix[] {
  const matrices = nodes.map(() => identity);
  // Nodes in a cycle have no root and are never reached.
  const stack = topNodes(nodes).map((node) => ({ node, parent: identity }));
  for (let next = stack.pop(); next; next = stack.pop()) {
    const matrix = multiply(next.parent, localMatrix(nodes[next.node]!));
    matrices[next.node] = matrix;
    for (const node of nodes[next.node]!.children ?? []) stack.push({ node, parent: matrix });
  }
  return matrices;
}
