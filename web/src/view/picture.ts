import type { Session } from '../scene/session';
import type { Viewer } from './viewer';

/** Lets the picture follow the session. */
export function showPicture(session: Session, viewer: Viewer): void {
  session.on('transfer', ({ target, cage, projection }) => {
    viewer.setTarget(target, projection);
    viewer.setCage(cage);
  });
  session.on('frame', (projection) => viewer.move(projection));
  session.on('zones', ({ classification }) => viewer.classify(classification));
  session.on('view', (view) => viewer.setView(view));

  const still = matchMedia('(prefers-reduced-motion: reduce)');
  viewer.turn(!still.matches);
  still.addEventListener('change', () => still.matches && viewer.turn(false));
}
