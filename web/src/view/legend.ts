import { element } from '../platform/page';
import type { Scale } from './color-maps';
import { cssColor } from './colors';

/** The meaning of the colours in the view: zones, or a scale. */
export type Legend = { scale: Scale } | { keys: string[] };

/** Shows a legend, or hides it. */
export function showLegend(legend: Legend | undefined): void {
  const box = element('legend', HTMLElement);
  box.hidden = legend === undefined;
  if (!legend) return;
  box.replaceChildren(...('scale' in legend ? ofScale(legend.scale) : legend.keys.map(ofKey)));
}

function ofScale({ title, map, ticks }: Scale): HTMLElement[] {
  const band = made('i', 'band');
  band.style.background = `linear-gradient(to right, ${map.map(cssColor).join(', ')})`;
  const marks = made('span', 'ticks');
  marks.append(...ticks.map((tick) => made('span', '', tick)));
  return [made('b', '', title), band, marks];
}

function ofKey(zone: string): HTMLElement {
  const key = made('span', 'key');
  const swatch = made('i', 'swatch');
  swatch.dataset.zone = zone;
  key.append(swatch, zone);
  return key;
}

function made(tag: string, className: string, text = ''): HTMLElement {
  const element = document.createElement(tag);
  element.className = className;
  element.textContent = text;
  return element;
}
