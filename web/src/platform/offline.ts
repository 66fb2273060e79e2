import type { Session } from '../scene/session';

/**
 * Keeps the page and its samples on the device, so that it opens without a network from the next visit on.
 * Begun once the first model is on show: it must not share the network with it.
 */
export function keepOffline(session: Session): void {
  // A page under development changes all the time; an insecure one has no service workers.
  if (!import.meta.env.PROD || !('serviceWorker' in navigator)) return;
  const end = session.on('progress', ({ state }) => {
    if (state !== 'ready') return;
    end();
    // Where it is refused, as in a private window, the page works all the same.
    navigator.serviceWorker.register(new URL('service-worker.js', document.baseURI)).catch(() => {});
  });
}
