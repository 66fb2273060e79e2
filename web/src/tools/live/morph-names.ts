import type { Mesh } from 'three';

/** Morph weights by name; others are 0. Morphs of the same name in several meshes share a weight. */
export type Weights = ReadonlyMap<string, number>;

/** The names of a mesh's morphs, in order; “Morph 1” and so on for those without a name. */
export function morphNames({ morphTargetDictionary, morphTargetInfluences = [] }: Mesh): string[] {
  const names = new Map(Object.entries(morphTargetDictionary ?? {}).map(([name, place]) => [place, name]));
  // The loader names morphs without a name by their index.
  return morphTargetInfluences.map((_, place) =>
    /^\d*$/.test(names.get(place) ?? '') ? `Morph ${place + 1}` : names.get(place)!,
  );
}
