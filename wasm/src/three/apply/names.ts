import type { BufferGeometry, Material, MeshPhysicalMaterial, Object3D, Mesh as ThreeMesh } from 'three';
import { nameOfGlass } from '../../parts/drawn.js';
import { isMesh } from './flags.js';

/** A part of a scene. */
interface Named {
  name: string;
  mesh: ThreeMesh | undefined;
  geometry: BufferGeometry;
}

/** The materials of a mesh. Three.js draws nothing where a list of them has a gap. */
export const materialsOf = ({ material }: ThreeMesh): Material[] =>
  ([material].flat() as (Material | undefined)[]).filter((one) => one !== undefined);

/** All that a mesh is called. */
export const namesOf = (mesh: ThreeMesh, root: Object3D): string[] => [
  ...ownNamesOf(mesh, root),
  ...namesIn(materialsOf(mesh)),
];

/** The names of each group, in the order of its numbers; see-through ones are called glass besides. */
export const groupNames = (parts: readonly Named[], root: object): string[][] =>
  parts.flatMap(({ name, mesh, geometry }) => {
    const own = mesh ? ownNamesOf(mesh, root) : namesIn([geometry]);
    return materialOfGroups({ mesh, geometry }).map((material) => {
      const { transparent, opacity, transmission } = (material ?? {}) as Partial<MeshPhysicalMaterial>;
      const glass = nameOfGlass(transparent ? 'BLEND' : 'OPAQUE', opacity, transmission);
      return [...new Set([name, ...own, ...namesIn([material]), ...glass])];
    });
  });

/** The material of each group of a part, as `extract` numbers groups: in the order of their first triangles. */
export function materialOfGroups({ mesh, geometry }: Pick<Named, 'mesh' | 'geometry'>): (Material | undefined)[] {
  if (!Array.isArray(mesh?.material)) return [mesh?.material];
  const order = [...new Set(geometry.groups.map(({ materialIndex = 0 }) => materialIndex))];
  return (order.length > 0 ? order : [0]).map((index) => (mesh.material as Material[])[index]);
}

/** What a mesh is called without its materials. */
function ownNamesOf(mesh: ThreeMesh, root: object): string[] {
  const holder = holderOf(mesh, root);
  // Of a glTF, `userData` has the name as it is in the file.
  const own = [mesh, holder].flatMap((one) => [one?.name, one?.userData['name']]);
  return [...own, mesh.geometry.name].filter((name) => name);
}

const namesIn = (named: readonly ({ name: string } | undefined)[]): string[] => named.flatMap((one) => one?.name || []);

/** The object that holds the meshes of one glTF mesh, if it has several. */
function holderOf(mesh: ThreeMesh, root: object): Object3D | undefined {
  const holder = mesh.parent;
  const isHolder = holder && holder !== root && holder.children.length > 1 && holder.children.every(isMesh);
  return isHolder ? holder : undefined;
}
