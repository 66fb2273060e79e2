import { face, onFace } from '../platform/face';
import { make } from '../platform/make';
import { element } from '../platform/page';
import type { PaintKind } from './drawn/names';
import { pictureOf } from './samples';

/** A paint to choose: its title and the URL of its image. */
export interface Choice {
  title: string;
  picture: string;
  /** Unknown of what samples have with them. */
  kind?: PaintKind;
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

function choiceOf({ title, picture, kind = 'body' }: Choice): HTMLElement {
  const input = make('input', { type: 'radio', name: 'paint' });
  const frame = make('span', { className: 'picture' }, make('img', { src: pictureOf(picture), alt: '' }));
  const label = make('label', {}, input, frame, make('span', { className: 'title' }, title));
  const ariaLabel = `Add ${title} as a layer`;
  const add = make('button', { type: 'button', name: 'add-paint', title: 'Add as a layer', ariaLabel }, '+');
  const tile = make('div', {}, label, add);
  tile.dataset.kind = kind;
  return tile;
}

/**
 * In Play the paints are listed by kind. On a phone they are a strip that is always there, on a desktop the panel is a shelf of them, and
 * the model's section a menu behind its name; elsewhere all are sections of the panel.
 */
export function setUpShelf(): void {
  const paints = element('paints', HTMLElement).closest('fieldset')!;
  const [section, next] = [paints.parentElement!, paints.nextSibling];
  const [phone, desk] = ['(width < 40em) and (height >= 480px)', '(width >= 56.25em) and (height > 520px)'].map(
    (size) => matchMedia(size),
  ) as [MediaQueryList, MediaQueryList];
  const strip = element('paint-strip', HTMLElement);
  const place = (): void => {
    const isPlay = face() === 'play';
    if (isPlay && phone.matches) {
      if (paints.parentElement !== strip) strip.append(paints);
    } else if (paints.parentElement !== section) section.insertBefore(paints, next);
    element('model', HTMLElement).popover = isPlay && desk.matches ? 'auto' : null;
  };
  addEventListener('resize', place);
  onFace(place);
  const kinds = element('paint-kinds', HTMLElement);
  kinds.addEventListener('change', ({ target }) => {
    element('paints', HTMLElement).dataset.kind = (target as HTMLInputElement).value;
  });
}
