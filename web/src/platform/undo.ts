import type { History } from '#three';
import { announce, element, showError } from './page';

/** Connects the undo and redo buttons, and their keys anywhere on the page. */
export function setUpUndo(history: History): void {
  const [undo, redo] = [element('undo', HTMLButtonElement), element('redo', HTMLButtonElement)];
  const run = (step: 'undo' | 'redo'): void => {
    try {
      const command = history[step]();
      if (command) announce(`${step === 'undo' ? 'Undone' : 'Redone'}: ${command.name}.`);
    } catch (error) {
      showError((error as Error).message);
    }
  };
  undo.addEventListener('click', () => run('undo'));
  redo.addEventListener('click', () => run('redo'));
  addEventListener('keydown', (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    // Text fields have their own undo.
    if (event.target instanceof HTMLInputElement && event.target.type === 'text') return;
    const key = event.key.toLowerCase();
    const step = key === 'z' ? (event.shiftKey ? 'redo' : 'undo') : key === 'y' ? 'redo' : undefined;
    if (!step) return;
    event.preventDefault();
    run(step);
  });

  const show = (): void => {
    const focused = document.activeElement;
    for (const [button, word, command] of [
      [undo, 'Undo', history.last],
      [redo, 'Redo', history.next],
    ] as const) {
      button.disabled = command === undefined;
      button.title = command ? `${word}: ${command.name}` : word;
    }
    // A disabled button loses the focus: move it to the other one.
    if (focused === undo && undo.disabled) redo.focus({ preventScroll: true });
    if (focused === redo && redo.disabled) undo.focus({ preventScroll: true });
  };
  history.on('change', show);
  show();
}
