import type { GLTF } from '@gltf-transform/core';
import type { Part } from '../../scene/extract.js';

/**
 * Gives every node of the transfer a mesh of its own. Other nodes, such as those of other scenes, share an unchanged copy. The first
 * node with a mesh keeps the original. What a file says of a mesh by its number is repeated for the copies.
 * @returns the mesh of each node.
 */
export function separateMeshes(json: GLTF.IGLTF, parts: readonly Part[]): Map<number, number> {
  const copy = (mesh: number): number => {
    const number = json.meshes!.push(structuredClone(json.meshes![mesh]!)) - 1;
    repeatAnimations(json, mesh, number);
    repeatVrm(json, mesh, number);
    return number;
  };
  const meshOfNode = new Map<number, number>();
  const taken = new Set<number>();
  for (const { node, mesh } of parts) {
    if (meshOfNode.has(node)) continue;
    meshOfNode.set(node, taken.has(mesh) ? copy(mesh) : mesh);
    taken.add(mesh);
  }
  const untouched = new Map<number, number>();
  json.nodes?.forEach((node, n) => {
    const own = meshOfNode.get(n);
    if (own !== undefined) node.mesh = own;
    else if (node.mesh !== undefined && taken.has(node.mesh)) {
      if (!untouched.has(node.mesh)) untouched.set(node.mesh, copy(node.mesh));
      node.mesh = untouched.get(node.mesh)!;
    }
  });
  return meshOfNode;
}

/** Channels of KHR_animation_pointer. */
function repeatAnimations(json: GLTF.IGLTF, mesh: number, copy: number): void {
  for (const { channels } of json.animations ?? []) {
    for (const channel of [...(channels ?? [])]) {
      const pointerOf = ({ target }: GLTF.IAnimationChannel) =>
        target?.extensions?.['KHR_animation_pointer'] as { pointer?: unknown } | undefined;
      const pointer = pointerOf(channel)?.pointer;
      const place = `/meshes/${mesh}/`;
      if (typeof pointer !== 'string' || !pointer.startsWith(place)) continue;
      const twin = structuredClone(channel);
      pointerOf(twin)!.pointer = `/meshes/${copy}/${pointer.slice(place.length)}`;
      channels.push(twin);
    }
  }
}

/** What expressions of VRM 0 move, and who sees what in first person. VRM 1 names nodes, not meshes. */
function repeatVrm(json: GLTF.IGLTF, mesh: number, copy: number): void {
  const { VRM } = (json.extensions ?? {}) as { VRM?: Record<string, unknown> };
  const { blendShapeMaster, firstPerson } = (VRM ?? {}) as Record<string, Record<string, unknown> | undefined>;
  const lists = [
    ...listIn(blendShapeMaster?.['blendShapeGroups']).map((group) => (group as { binds?: unknown } | null)?.binds),
    firstPerson?.['meshAnnotations'],
  ];
  for (const list of lists) {
    const own = listIn(list).filter((one) => (one as { mesh?: unknown } | null)?.mesh === mesh);
    listIn(list).push(...own.map((one) => ({ ...(one as object), mesh: copy })));
  }
}

/** A value that is a list, else an empty one. */
const listIn = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);
