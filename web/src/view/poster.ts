import { readLink } from '../export/link';
import { element } from '../platform/page';
import type { Session } from '../scene/session';
import type { Viewer } from './viewer';

const kFade = 300; // milliseconds

/**
 * Lets the picture of the first sample, which comes with the page's first bytes, give way to the one in 3D as soon as that is
 * drawn. Without a viewer it stays, as long as it shows what is open.
 */
export function fadeStill(session: Session, viewer: Viewer | undefined): void {
  const still = element('still', HTMLImageElement);
  const linked = readLink(location.hash);
  // The page's address asks for another sample.
  if (linked && linked.sample !== still.dataset.sample) return still.remove();
  if (!viewer)
    return void session.on('transfer', ({ target }) => (still.hidden = target.sample?.name !== still.dataset.sample));
  const end = session.on('progress', async ({ state }) => {
    if (state === 'working') return;
    end();
    if (state === 'ready') await viewer.drawn();
    const gentle = !matchMedia('(prefers-reduced-motion: reduce)').matches;
    if (gentle) await still.animate({ opacity: 0 }, { duration: kFade, easing: 'ease-in', fill: 'forwards' }).finished;
    still.remove();
  });
}
