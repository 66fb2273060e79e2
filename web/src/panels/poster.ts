import { flags } from '../platform/shelf';
import type { Session } from '../state/session';
import type { Viewer } from '../view/viewer';

const kFade = 300; // milliseconds

const find = (): HTMLImageElement | null => document.querySelector('#poster');

/** Removes the poster image, a static picture of the first sample, if a link or the work that is kept opens something else. */
export function removeOtherPoster(): void {
  const poster = find();
  const linked = new URLSearchParams(location.hash.slice(1));
  const works = flags.get('work') && flags.get('start') !== 'over';
  const sample = linked.get('sample');
  if (sample ? sample !== poster?.dataset.sample : works || linked.has('look')) poster?.remove();
}

/** Fades the poster image once the 3D view is drawn. Without WebGL it stays as long as the first sample is open. */
export function fadePoster(session: Session, viewer: Viewer | undefined): void {
  const poster = find();
  if (!poster) return;
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
