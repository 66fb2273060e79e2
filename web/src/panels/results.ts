import type { Classification, Timings } from 'cagecast';
import { make } from '../platform/make';
import { announce, element } from '../platform/page';
import { namesLeftOut } from '../state/left-out';
import type { Shown } from '../state/scene';
import type { Session } from '../state/session';
import { countZones, kZones } from '../state/zones';

/** The steps, as they are shown. */
const kSteps = [
  'weld',
  'build',
  'project',
  'occluded',
  'covered',
  'segments',
  'recheck',
  'motion',
  'holes',
  'seams',
  'classify',
] as const;
/** A first run that took longer by this factor is mentioned. */
const kMuchLonger = 1.5;
const kBeyondPaper: readonly string[] = ['recheck', 'motion', 'holes', 'seams'];

/** Shows the number of vertices per zone, and the timings. */
export function showResults(session: Session): void {
  const first = element('time-first', HTMLElement);
  for (const { name, color } of kZones)
    for (const mark of document.querySelectorAll<HTMLElement>(`[data-zone=${name}]`)) mark.style.background = color;
  let latest = 0;
  session.on('transfer', () => (first.hidden = true));
  session.on('zones', ({ classification, spent }) => {
    showCounts(classification, namesLeftOut(session.shown!));
    latest = showTimings(session.shown!, spent);
  });
  session.on('retimed', ({ spent }) => {
    const before = latest;
    latest = showTimings(session.shown!, spent);
    first.hidden = before < kMuchLonger * latest;
    first.textContent = `${round(before)} ms the first time, while the browser was still compiling.`;
  });
}

/** Shows the number of vertices per zone. */
function showCounts({ zones, segmentStats }: Classification, leftOut: readonly string[]): void {
  const counts = countZones(zones);
  element('count-total', HTMLElement).textContent = zones.length.toLocaleString('en');
  kZones.forEach(({ name }, number) => {
    element(`count-${name}`, HTMLElement).textContent = String(counts[number]);
    const share = zones.length > 0 ? counts[number]! / zones.length : 0;
    document.querySelector<HTMLElement>(`#bar [data-zone=${name}]`)!.style.flexGrow = String(share);
  });
  const culled = segmentStats.filter((segment) => segment.culled).length;
  announce(
    `Done: ${counts[0]} of ${zones.length} vertices are cosmetic, ${counts[1]} are occluded, ${counts[2]} uncovered, ` +
      `${counts[3]} culled; ${culled} of ${segmentStats.length} parts are culled.` +
      (leftOut.length > 0 ? ` Left out: ${leftOut.join(', ')}.` : ''),
  );
}

/**
 * Shows the timings of the steps that the preset takes.
 * @returns The total, in milliseconds.
 */
function showTimings({ projection: { timings: projected, preset } }: Shown, spent: number): number {
  const timings: Timings = { ...projected, classify: spent, total: projected.total + spent };
  element('time-total', HTMLElement).textContent = round(timings.total);
  const steps = kSteps.filter((step) => preset !== 'paper' || !kBeyondPaper.includes(step));
  const longest = Math.max(...steps.map((step) => timings[step]), Number.MIN_VALUE);
  element('timings', HTMLElement).replaceChildren(
    ...steps.map((step) => {
      const row = make('div', {}, make('dt', {}, step), make('dd', {}, round(timings[step])));
      row.style.setProperty('--share', String(timings[step] / longest));
      return row;
    }),
  );
  return timings.total;
}

function round(milliseconds: number): string {
  return milliseconds.toFixed(milliseconds < 0.1 ? 3 : milliseconds < 10 ? 2 : 1);
}
