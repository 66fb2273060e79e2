import { element, showError } from '../platform/page';
import type { PutAwayLayers } from '../state/put-away-layers';

/**
 * Offers to bring layers back that were put away, and to carry the paint of the cage before over to this one.
 * @param carryOver  Undefined without WebGL.
 */
export function offerPutAway(away: PutAwayLayers, carryOver: (() => Promise<void>) | undefined): void {
  const offer = element('put-away', HTMLElement);
  const back = element('bring-back', HTMLButtonElement);
  const carry = element('carry-over', HTMLButtonElement);
  away.on('change', () => {
    const { length } = away.offered;
    carry.hidden = !carryOver || !away.earlier;
    back.hidden = length === 0;
    offer.hidden = carry.hidden && back.hidden;
    const count = length === 1 ? 'One layer of an earlier cage' : `${length} layers of earlier cages`;
    offer.querySelector('p')!.textContent = length === 0 ? 'The paint is for the cage before.' : `${count} put away.`;
  });
  const tries = (act: () => void | Promise<void>) => async () => {
    try {
      await act();
    } catch (error) {
      showError((error as Error).message);
    }
  };
  back.addEventListener(
    'click',
    tries(() => away.bringBack()),
  );
  if (carryOver) carry.addEventListener('click', tries(carryOver));
}
