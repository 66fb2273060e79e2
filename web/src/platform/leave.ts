import type { History } from '#three';

const kSaving = ['export-glb', 'save-texture', 'save-project'];

/** Warns before the page is left while there is work that was not saved. @param isKept Whether this browser keeps all of it. */
export function warnBeforeLeaving(history: History, isKept: () => boolean): void {
  let saved = history.last;
  // By the page's own buttons: whatever they save has the work in it.
  addEventListener('click', ({ target }) => {
    if (target instanceof Element && kSaving.some((id) => target.closest(`#${id}`))) saved = history.last;
  });
  addEventListener('beforeunload', (event) => {
    if (history.last !== saved && history.last !== undefined && !isKept()) event.preventDefault();
  });
}
