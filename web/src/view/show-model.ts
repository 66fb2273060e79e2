import type { Session } from '../scene/session';
import type { Viewer } from './viewer';

/** Updates the viewer on events of the session. */
export function showModel(session: Session, viewer: Viewer): void {
  session.on('transfer', ({ target, cage, projection }) => {
    viewer.setTarget(target, projection);
    viewer.setCage(cage);
  });
  session.on('frame', (projection) => {
    viewer.move(projection);
    viewer.followCage();
  });
  session.on('zones', ({ classification }) => viewer.classify(classification));
  session.on('view', (view) => viewer.setView(view));

  const reduced = matchMedia('(prefers-reduced-motion: reduce)');
  viewer.sway(!reduced.matches);
  reduced.addEventListener('change', () => reduced.matches && viewer.sway(false));
}
