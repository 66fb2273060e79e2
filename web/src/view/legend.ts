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
  const band = made('i', 'band');
  band.style.background = `linear-gradient(to right, ${map.map(cssColor).join(', ')})`;
  const marks = made('span', 'ticks');
  marks.append(...ticks.map((tick) => made('span', '', tick)));
  return [made('b', '', title), band, marks];
}

function ofZone({ name, color }: (typeof kZones)[number]): HTMLElement {
  const key = made('span', 'key');
  const swatch = made('i', 'swatch');
  swatch.style.background = color;
  key.append(swatch, name);
  return key;
}

function made(tag: string, className: string, text = ''): HTMLElement {
  const element = document.createElement(tag);
  element.className = className;
  element.textContent = text;
  return element;
}
