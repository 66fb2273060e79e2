import { element } from '../platform/page';
import type { Session } from '../state/session';

const kKey = 'cagecast-guide';

/** Offers the guide at a first visit, once a model is shown; a button of the page shows it again. */
export function offerGuide(session: Session): void {
  const open = async (at?: number): Promise<void> => {
    const { Guide } = await import('./guide');
    document.querySelector('.guide')?.remove();
    const guide = new Guide(session, () => remember());
    if (at !== undefined) guide.show(at);
  };
  element('show-guide', HTMLButtonElement).addEventListener('click', () => open(0));
  if (wasSeen()) return;
  const end = session.on('progress', ({ state }) => {
    if (state !== 'ready') return;
    end();
    open().catch(() => {}); // the page works without it
  });
}

/** Browsers may forbid to store anything. */
function wasSeen(): boolean {
  try {
    return localStorage.getItem(kKey) !== null;
  } catch {
    return true;
  }
}

function remember(): void {
  try {
    localStorage.setItem(kKey, 'seen');
  } catch {
    // It is offered again.
  }
}
