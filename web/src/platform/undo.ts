import type { History } from './history';
import { announce, element, showError } from './page';

/** Lets what was done be undone and done again: by its buttons, and by the keys for it anywhere on the page. */
export function setUpUndo(history: History): void {
  const [undo, redo] = [element('undo', HTMLButtonElement), element('redo', HTMLButtonElement)];
  const run = (step: 'undo' | 'redo'): void => {
    try {
      const deed = history[step]();
      if (deed) announce(`${deed.name} ${step === 'undo' ? 'undone' : 'done again'}.`);
    } catch (error) {
      showError((error as Error).message);
    }
  };
  undo.addEventListener('click', () => run('undo'));
  redo.addEventListener('click', () => run('redo'));
  addEventListener('keydown', (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    // A field of text has an undoing of its own.
    if (event.target instanceof HTMLInputElement && event.target.type === 'text') return;
    const key = event.key.toLowerCase();
    const step = key === 'z' ? (event.shiftKey ? 'redo' : 'undo') : key === 'y' ? 'redo' : undefined;
    if (!step) return;
    event.preventDefault();
    run(step);
  });

  const show = (): void => {
    const focused = document.activeElement;
    for (const [button, word, deed] of [
      [undo, 'Undo', history.last],
      [redo, 'Redo', history.next],
    ] as const) {
      button.disabled = deed === undefined;
      button.title = deed ? `${word}: ${deed.name}` : word;
    }
    // The keyboard goes from what is at its end to what takes that back, not to nothing.
    if (focused === undo && undo.disabled) redo.focus({ preventScroll: true });
    if (focused === redo && redo.disabled) undo.focus({ preventScroll: true });
  };
  history.on('change', show);
  show();
}
