import { face, onFace } from '../platform/face';
import { make } from '../platform/make';
import { element } from '../platform/page';
import { pictureOf } from './samples';

/** A paint to choose: its title and the URL of its image. */
export interface Choice {
  title: string;
  picture: string;
}

/** Actions on a paint, by its index in the row. */
interface Uses {
  /** Use it in place of the chosen one. */
  onChoose(index: number): void;
  /** Add it as a layer on top. */
  onAdd(index: number): void;
}

/**
 * Shows paints as a row of images.
 * @param chosen The index of the one that a choice replaces.
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
  const input = make('input', { type: 'radio', name: 'paint' });
  const frame = make('span', { className: 'picture' }, make('img', { src: pictureOf(picture), alt: '' }));
  const label = make('label', {}, input, frame, make('span', { className: 'title' }, title));
  const ariaLabel = `Add ${title} as a layer`;
  const add = make('button', { type: 'button', name: 'add-paint', title: 'Add as a layer', ariaLabel }, '+');
  return make('div', {}, label, add);
}

/** In Play on a phone the paints are a strip that is always there; elsewhere they are in their section of the panel. */
export function setUpPaintStrip(): void {
  const paints = element('paints', HTMLElement).closest('fieldset')!;
  const [section, next] = [paints.parentElement!, paints.nextSibling];
  const phone = matchMedia('(width < 40em) and (height >= 480px)');
  const place = (): void => {
    const isStrip = phone.matches && face() === 'play';
    if (isStrip) element('paint-strip', HTMLElement).append(paints);
    else if (paints.parentElement !== section) section.insertBefore(paints, next);
  };
  phone.addEventListener('change', place);
  onFace(place);
}
