import type { Edits, Layer, LayerStack } from 'cagecast/three/layers';
import { element, showError } from '../platform/page';
import type { Model } from './load-model';
import { haveSameUvs } from './same-uvs';
import type { Session } from './session';

/** Layers that were painted for another cage. */
export interface PutAway {
  readonly layers: readonly Layer[];
  /** Offers others. */
  show(layers: readonly Layer[]): void;
}

/** Puts the layers away that were painted for another cage, and offers them again. They stay where a cage has the same UVs. */
export function putAwayLayers(session: Session, stack: LayerStack, edits: Edits): PutAway {
  const offer = element('put-away', HTMLElement);
  let last: Model | undefined;
  let away: readonly Layer[] = [];
  const show = (layers: readonly Layer[]): void => {
    away = layers;
    offer.hidden = layers.length === 0;
    const count = layers.length === 1 ? 'One layer' : `${layers.length} layers`;
    offer.querySelector('p')!.textContent = `${count} of the last cage put away.`;
  };
  session.on('transfer', ({ cage }) => {
    const before = last;
    last = cage;
    if (!before || haveSameUvs(before, cage)) return;
    const old = stack.layers.filter(({ id }) => id !== stack.base?.id);
    if (old.length > 0)
      edits.do('putting layers away', () => {
        for (const { id } of old) stack.remove(id);
      });
    show(old);
  });
  // Undoing brings them back too.
  stack.on('change', (layers) => {
    if (away.some(({ id }) => layers.some((layer) => layer.id === id))) show([]);
  });
  element('bring-back', HTMLButtonElement).addEventListener('click', () => {
    try {
      edits.do('bringing layers back', () => stack.change([], away));
    } catch (error) {
      showError((error as Error).message);
    }
  });
  return {
    get layers() {
      return away;
    },
    show,
  };
}
