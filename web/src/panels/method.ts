import { element } from '../platform/page';
import type { Session } from '../state/session';
import type { Viewer } from '../view/viewer';

/** Loads the film strip when its card is opened, or a link or a project shows it. */
export function setUpMethod(session: Session, viewer: Viewer): void {
  const card = element('method', HTMLDetailsElement);
  let isLoaded = false;
  const load = async (): Promise<void> => {
    if (isLoaded) return;
    isLoaded = true;
    try {
      const { FilmStrip } = await import('../explain/film-strip');
      new FilmStrip(session, viewer);
    } catch (error) {
      isLoaded = false;
      session.fail(error);
    }
  };
  card.addEventListener('toggle', () => card.open && void load());
  session.on('view', ({ mode }) => mode === 'film' && void load());
}
