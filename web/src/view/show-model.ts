import type { Session } from '../state/session';
import type { Viewer } from './viewer';

/** Updates the viewer on events of the session. */
export function showModel(session: Session, viewer: Viewer): void {
  session.on('transfer', ({ target, cage, projection }) => {
    viewer.setTarget(target, projection);
    viewer.stage.setCage(cage);
  });
  let isLeaving = false;
  // What is marked on the model goes when another one is awaited, and comes back if that fails.
  session.on('progress', () => {
    if (session.isLeaving !== isLeaving) viewer.redraw();
    isLeaving = session.isLeaving;
  });
  session.on('frame', (projection) => {
    viewer.stage.setProjection(projection);
    viewer.stage.followCage();
  });
  session.on('zones', ({ classification }) => viewer.stage.classify(classification));
  session.on('view', (view) => viewer.setView(view));

  const reduced = matchMedia('(prefers-reduced-motion: reduce)');
  session.on('progress', ({ state }) => viewer.controls.hold(state === 'working'));
  viewer.controls.sway(!reduced.matches);
  reduced.addEventListener('change', () => reduced.matches && viewer.controls.sway(false));
}
