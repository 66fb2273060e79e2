import type { Session } from '../state/session';

/**
 * Caches the page and its samples, so that it works offline from the next visit on.
 * Starts after the first model is shown, so that it does not compete for the network.
 */
export function keepOffline(session: Session): void {
  // Not during development; insecure pages have no service workers.
  if (!import.meta.env.PROD || !('serviceWorker' in navigator)) return;
  const end = session.on('progress', ({ state }) => {
    if (state !== 'ready') return;
    end();
    // It may be refused, as in a private window; the page works all the same.
    navigator.serviceWorker.register(new URL('service-worker.js', document.baseURI)).catch(() => {});
  });
}
