import { type Classification, classify, type Projection, Visibility, Zone } from 'cagecast';
import type { SplitProjection, WorkerProjection } from '../transfers';
import type { Baseline } from '../view-state';

/** What a way to transfer paints, and the vertices to show it on. */
export interface Decision
  extends Pick<Classification, 'zones' | 'cosmeticTriangles'>,
    Pick<WorkerProjection, 'split'> {}

/** What `decide` needs of a projection. */
type Projected = Projection & Pick<SplitProjection, 'split'>;

/** Decides in each of the ways, without the user's choices. @param projections By the two presets, of the same target. */
export function decide(projections: Readonly<Record<'paper' | 'default', Projected>>): Record<Baseline, Decision> {
  const { paper } = projections;
  const only = (...ncz: number[]): Decision => withoutVertices(paper, ncz);
  const by = (preset: 'paper' | 'default'): Decision => ({
    ...classify(projections[preset]),
    split: projections[preset].split,
  });
  return {
    naive: only(),
    occlusion: only(Visibility.Occluded),
    rays: only(Visibility.Occluded, Visibility.Uncovered),
    paper: by('paper'),
    default: by('default'),
  };
}

/** Paints all but some vertices. As the paper has it, a triangle is painted if its three corners are. */
function withoutVertices({ visibility, indices, split }: Projected, ncz: readonly number[]): Decision {
  const zones = visibility.map((found) => (ncz.includes(found) ? found : Zone.Cosmetic));
  const cosmeticTriangles = new Uint8Array(indices.length / 3).map((_, triangle) =>
    Number([0, 1, 2].every((corner) => zones[indices[3 * triangle + corner]!] === Zone.Cosmetic)),
  );
  return { zones, cosmeticTriangles, split };
}
