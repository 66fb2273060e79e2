import { element } from '../platform/page';

/** A paint one can choose: what to call it, and the address of its picture. */
export interface Choice {
  title: string;
  picture: string;
}

/** What is done with a paint, by its place in the row. */
export interface Uses {
  /** It is to lie under everything. */
  onChoose(index: number): void;
  /** It is to be laid over the others. */
  onAdd(index: number): void;
}

/**
 * Offers paints as a row of pictures.
 * @param chosen The place of the one that lies under everything.
 */
export function offerPaints(choices: readonly Choice[], chosen: number, { onChoose, onAdd }: Uses): void {
  const row = element('paints', HTMLElement);
  const offered = JSON.stringify(choices);
  // The same row stays where it is: the keyboard's focus may be in it.
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
  add.title = 'Lay it over the others';
  add.ariaLabel = `Add ${title} as a layer`;
  add.textContent = '+';
  const choice = document.createElement('div');
  choice.append(label, add);
  return choice;
}
