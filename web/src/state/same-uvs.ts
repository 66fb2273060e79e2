import type { Model } from './model';

type Uvs = { mesh: Pick<Model['mesh'], 'uvs'> };

/** Whether a paint for one cage fits the other: the same UVs, wherever they are; holes may differ. */
export function haveSameUvs({ mesh: one }: Uvs, { mesh: other }: Uvs): boolean {
  if (one === other) return true;
  if (!one.uvs || one.uvs.length !== other.uvs?.length) return false;
  return one.uvs.every((value, i) => value === other.uvs![i]);
}
