import { readLink } from '../export/link';
import { element } from '../platform/page';
import type { Session } from '../scene/session';
import type { Viewer } from './viewer';

const kFade = 300; // milliseconds

/**
 * Fades the poster image, a static picture of the first sample, once the 3D view is drawn. Without WebGL it stays as long as
 * that sample is open.
 */
export function fadePoster(session: Session, viewer: Viewer | undefined): void {
  const poster = element('poster', HTMLImageElement);
  const linked = readLink(location.hash);
  // The link opens another sample.
  if (linked && linked.sample !== poster.dataset.sample) {
    poster.remove();
    return;
  }
  if (!viewer)
    return void session.on('transfer', ({ target }) => (poster.hidden = target.sample?.name !== poster.dataset.sample));
  const end = session.on('progress', async ({ state }) => {
    if (state === 'working') return;
    end();
    if (state === 'ready') await viewer.drawn();
    const animated = !matchMedia('(prefers-reduced-motion: reduce)').matches;
    if (animated)
      await poster.animate({ opacity: 0 }, { duration: kFade, easing: 'ease-in', fill: 'forwards' }).finished;
    poster.remove();
  });
}
