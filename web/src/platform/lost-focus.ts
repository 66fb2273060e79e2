import { element } from './page';

/**
 * Gives the focus to the stage when what had it is hidden, disabled or removed: with the focus on nothing, keys do nothing, and a
 * screen reader starts over. Code that knows a better place gives it the focus itself, at once.
 */
export function catchLostFocus(): void {
  const stage = element('view', HTMLCanvasElement);
  const isGone = (one: Element): boolean => !one.checkVisibility() || one.matches(':disabled');
  let focused: Element | undefined;
  document.addEventListener('focusin', ({ target }) => (focused = target as Element));
  document.addEventListener('focusout', ({ target }) =>
    // When it is removed, this comes before.
    queueMicrotask(() => target === focused && !isGone(focused!) && (focused = undefined)),
  );
  new MutationObserver(() => {
    const { activeElement } = document;
    const isFree = activeElement === document.body || activeElement === focused;
    if (focused && isFree && isGone(focused)) stage.focus({ preventScroll: true });
  }).observe(document.body, { subtree: true, childList: true, attributeFilter: ['hidden', 'disabled'] });
}
