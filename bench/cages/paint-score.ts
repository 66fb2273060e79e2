import { transfer } from 'cagecast';
import type { FigureTruth } from './figures.js';
import type { StoredCage, StoredModel } from './files.js';
import { type Shape, vertexAreas } from './shape.js';

/** What a transfer leaves bare and paints, as shares of area; see `Score`. */
export interface PaintScore {
  suppressed: number;
  kept: number;
}

/** Scores a transfer with the preset `default`. `init` the package before. */
export function paintScore(
  cage: Pick<StoredCage, 'positions' | 'indices' | 'uvs'>,
  model: StoredModel,
  truth: FigureTruth,
): PaintScore {
  const { zones } = transfer(meshOf(cage), meshOf(model));
  const areas = vertexAreas(model);
  const sums = { ncz: 0, bare: 0, skin: 0, painted: 0 };
  areas.forEach((area, v) => {
    if (truth.ignore[v] === 1) return;
    if (truth.ncz[v] === 1) {
      sums.ncz += area;
      if (zones[v] !== 0) sums.bare += area;
    } else if (truth.offCage[v] !== 1) {
      sums.skin += area;
      if (zones[v] === 0) sums.painted += area;
    }
  });
  return {
    suppressed: sums.ncz > 0 ? sums.bare / sums.ncz : 1,
    kept: sums.skin > 0 ? sums.painted / sums.skin : 1,
  };
}

/** As the package takes it. */
export const meshOf = ({ positions, indices, uvs, groups }: Arrays) => ({
  positions: Float32Array.from(positions),
  indices: Uint32Array.from(indices),
  ...(uvs && { uvs: Float32Array.from(uvs) }),
  ...(groups && { groups: Uint32Array.from(groups) }),
});
type Arrays = Shape & { uvs?: ArrayLike<number>; groups?: ArrayLike<number> };
