import { onFace } from '../platform/face';
import { element } from '../platform/page';

/** In Play on a phone the paints are a strip that is always there; elsewhere they are in their section of the panel. */
export function setUpPaintStrip(): void {
  const paints = element('paints', HTMLElement).closest('fieldset')!;
  const [section, next] = [paints.parentElement!, paints.nextSibling];
  const phone = matchMedia('(width < 40em) and (height >= 480px)');
  const place = (): void => {
    const isStrip = phone.matches && document.documentElement.dataset.face === 'play';
    if (isStrip) element('paint-strip', HTMLElement).append(paints);
    else if (paints.parentElement !== section) section.insertBefore(paints, next);
  };
  phone.addEventListener('change', place);
  onFace(place);
}
