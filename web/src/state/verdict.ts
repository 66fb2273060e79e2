import type { Inspection } from 'cagecast/inspect';

/** Whether the cage fits; empty until it was inspected. */
export type KnownVerdict = Inspection['verdict'] | '';

/** The share of the visible surface that can be painted, 0..1. */
export function paintableShare(
  parts: readonly { exposedArea: number; coveredArea: number; culled: boolean }[],
): number {
  let [visible, paintable] = [0, 0];
  for (const { exposedArea, coveredArea, culled } of parts) {
    visible += exposedArea;
    if (!culled) paintable += coveredArea;
  }
  return visible > 0 ? Math.min(1, paintable / visible) : 0;
}
