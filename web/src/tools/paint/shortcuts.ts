const kKeys = [
  ['B', 'Brush'],
  ['E', 'Erase'],
  ['S', 'Sticker'],
  ['F', 'Fill a part'],
  ['I, or Alt and a click', 'Take a colour from the model'],
  ['[ and ]', 'Smaller and larger'],
  ['Delete', 'Remove the chosen sticker'],
  ['Ctrl Z, Ctrl Y', 'Undo, redo'],
  ['T, or Escape', 'Turn the model'],
  ['Arrow keys, + and −', 'Turn and zoom'],
  ['Shift and arrow keys, or the right mouse button', 'Move the view'],
  ['1, 2, 0, Home', 'Front, side, fit, first view'],
  ['Space, held', 'Paint at the cross'],
  ['X', 'Explain'],
  ['N', 'Mark what stays bare'],
  ['L', 'Landmarks of a fit'],
  ['?', 'This list'],
] as const;

let dialog: HTMLDialogElement | undefined;

/** Shows the keys of the page. */
export function showShortcuts(): void {
  dialog ??= makeDialog();
  if (!dialog.open) dialog.showModal();
}

function makeDialog(): HTMLDialogElement {
  const made = document.createElement('dialog');
  made.className = 'shortcuts';
  made.setAttribute('aria-labelledby', 'shortcuts-title');
  const rows = kKeys.map(([keys, what]) => `<div><dt>${what}</dt><dd><kbd>${keys}</kbd></dd></div>`);
  made.innerHTML =
    '<header><h2 id="shortcuts-title">Keys</h2><button type="button" class="icon" aria-label="Close">✕</button></header>' +
    `<p class="hint">Most work while the model has the focus: click it, or use Tab.</p><dl>${rows.join('')}</dl>`;
  made.querySelector('button')!.addEventListener('click', () => made.close());
  // A click beside it.
  made.addEventListener('click', (event) => event.target === made && made.close());
  document.body.append(made);
  return made;
}
