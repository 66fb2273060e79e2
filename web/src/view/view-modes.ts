import type { Classification } from 'cagecast';
import type { Shown } from '../state/scene';
import type { Session } from '../state/session';
import type { Mode } from '../state/view-state';
import { type Coloring, colorByDistance, colorBySegment, colorByStretch } from './color-maps';
import { showLegend } from './legend';
import type { Stage } from './stage';

const kColorings: { [Name in Mode]?: (shown: Shown, classification: Classification) => Coloring } = {
  segments: colorBySegment,
  steps: colorBySegment,
  distance: colorByDistance,
  stretch: colorByStretch,
};

const kZonesStep = 2; // of `steps`

/** Colours the model in the view modes without paint, and shows the legend. */
export function showViewModes(session: Session, stage: Stage): void {
  /** What the current colours were computed for; a change of the view alone does not recompute them. */
  let made: { mode: Mode; classification: Classification; isOfZones: boolean } | undefined;

  const update = (): void => {
    const { shown, classification, view } = session;
    const { mode } = view;
    if (!shown || !classification) return;
    const isOfZones = mode === 'zones' || (mode === 'steps' && Math.round(view.step) === kZonesStep);
    if (made?.mode === mode && made.classification === classification && made.isOfZones === isOfZones) return;
    made = { mode, classification, isOfZones };
    if (mode === 'checker') stage.setChecker(session.checker.texture);
    const coloring = kColorings[mode]?.(shown, classification);
    if (coloring) stage.setColors(coloring.colors);
    showLegend(isOfZones ? 'zones' : coloring?.scale && { scale: coloring.scale });
  };
  session.on('zones', update);
  session.on('view', update);
}
