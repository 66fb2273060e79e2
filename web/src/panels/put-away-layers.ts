import { element, showError } from '../platform/page';
import type { PutAwayLayers } from '../state/put-away-layers';

/** Offers to bring layers back that were put away. */
export function offerPutAway(away: PutAwayLayers): void {
  const offer = element('put-away', HTMLElement);
  away.on('change', () => {
    const { length } = away.layers;
    offer.hidden = length === 0;
    const count = length === 1 ? 'One layer of an earlier cage' : `${length} layers of earlier cages`;
    offer.querySelector('p')!.textContent = `${count} put away.`;
  });
  element('bring-back', HTMLButtonElement).addEventListener('click', () => {
    try {
      away.bringBack();
    } catch (error) {
      showError((error as Error).message);
    }
  });
}
