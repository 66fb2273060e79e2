import type { Mesh } from 'cagecast';
import { moveApart } from '#three';
import type { ExtractedMesh, Model } from './model';

/** What a transfer takes of a cage and a target: of parts that have cages of their own, each with its own. */
export function arraysOf(cage: Model, target: Model): { cage: Mesh; target: Mesh; mend?: Mend } {
  const apart = moveApart(rangesOf(cage.mesh), rangesOf(target.mesh));
  const [outer, inner] = [apart?.cage ?? cage.mesh, apart?.target ?? target.mesh];
  return {
    cage: { positions: outer.positions, indices: outer.indices, uvs: outer.uvs, otherUvSets: outer.otherUvSets },
    target: {
      positions: inner.positions,
      indices: inner.indices,
      groups: inner.groups,
      names: inner.names,
      poses: inner.poses,
    },
    ...(apart && { mend: apart.mend }),
  };
}

type Mend = NonNullable<ReturnType<typeof moveApart>>['mend'];

const rangesOf = (mesh: ExtractedMesh) => ({ mesh: mesh as Mesh, parts: mesh.primitives });
