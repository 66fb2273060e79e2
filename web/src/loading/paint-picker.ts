import { element } from '../platform/page';

/** A paint to choose: its title and the URL of its image. */
export interface Choice {
  title: string;
  picture: string;
}

/** Actions on a paint, by its index in the row. */
interface Uses {
  /** Use it as the base layer. */
  onChoose(index: number): void;
  /** Add it as a layer on top. */
  onAdd(index: number): void;
}

/**
 * Shows paints as a row of images.
 * @param chosen The index of the base layer.
 */
export function offerPaints(choices: readonly Choice[], chosen: number, { onChoose, onAdd }: Uses): void {
  const row = element('paints', HTMLElement);
  const offered = JSON.stringify(choices);
  // Keep an unchanged row, as it may have the focus.
  if (row.dataset.offered !== offered) row.replaceChildren(...choices.map(choiceOf));
  row.dataset.offered = offered;
  row.querySelectorAll('input').forEach((input, index) => {
    input.checked = index === chosen;
    input.onchange = () => onChoose(index);
  });
  row.querySelectorAll('button').forEach((button, index) => (button.onclick = () => onAdd(index)));
}

function choiceOf({ title, picture }: Choice): HTMLElement {
  const input = document.createElement('input');
  input.type = 'radio';
  input.name = 'paint';
  const frame = document.createElement('span');
  frame.className = 'picture';
  const image = document.createElement('img');
  image.src = picture;
  image.alt = '';
  frame.append(image);
  const name = document.createElement('span');
  name.className = 'title';
  name.textContent = title;
  const label = document.createElement('label');
  label.append(input, frame, name);
  const add = document.createElement('button');
  add.type = 'button';
  add.name = 'add-paint';
  add.title = 'Add as a layer';
  add.ariaLabel = `Add ${title} as a layer`;
  add.textContent = '+';
  const choice = document.createElement('div');
  choice.append(label, add);
  return choice;
}
