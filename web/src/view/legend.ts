import { make, swatch } from '../platform/make';
import { element } from '../platform/page';
import { kZones } from '../state/zones';
import type { Scale } from './color-maps';
import { cssColor } from './colors';

/** Shows what the colours in the view mean: zones, or a scale; or nothing. */
export function showLegend(legend: { scale: Scale } | 'zones' | undefined): void {
  const box = element('legend', HTMLElement);
  box.hidden = legend === undefined;
  if (!legend) return;
  box.replaceChildren(...(legend === 'zones' ? kZones.map(ofZone) : ofScale(legend.scale)));
}

function ofScale({ title, map, ticks }: Scale): HTMLElement[] {
  const band = make('i', { className: 'band' });
  band.style.background = `linear-gradient(to right, ${map.map(cssColor).join(', ')})`;
  const marks = ticks.map((tick) => make('span', {}, tick));
  return [make('b', {}, title), band, make('span', { className: 'ticks' }, ...marks)];
}

const ofZone = ({ name, color }: (typeof kZones)[number]): HTMLElement =>
  make('span', { className: 'key' }, swatch(color), name);
