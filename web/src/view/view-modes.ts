import type { Classification } from 'cagecast';
import type { Session, Shown } from '../scene/session';
import { type Tint, tintDistance, tintSegments, tintStretch } from './color-maps';
import { type Legend, showLegend } from './legend';
import type { Mode } from './view';
import type { Viewer } from './viewer';

const kTints: { [Name in Mode]?: (shown: Shown, classification: Classification) => Tint } = {
  segments: tintSegments,
  distance: tintDistance,
  stretch: tintStretch,
};

const kZoneKeys: Legend = { keys: ['cosmetic', 'occluded', 'uncovered', 'culled'] };

/** Colours the model for the modes of the picture that show something other than paint, and says what the colours mean. */
export function showViewModes(session: Session, viewer: Viewer): void {
  /** What the colours on show were made for: they are not made again while the view alone changes. */
  let made: { mode: Mode; classification: Classification } | undefined;

  const update = (): void => {
    const { shown, classification, view } = session;
    const { mode } = view;
    if (!shown || !classification || (made?.mode === mode && made.classification === classification)) return;
    made = { mode, classification };
    if (mode === 'checker') viewer.setChecker(session.checker.texture);
    const tint = kTints[mode]?.(shown, classification);
    if (tint) viewer.setTint(tint.colors);
    showLegend(mode === 'zones' ? kZoneKeys : tint?.scale && { scale: tint.scale });
  };
  session.on('zones', update);
  session.on('view', update);
}
