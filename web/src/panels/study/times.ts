import type { Timings } from 'cagecast';
import { make } from '../../platform/make';
import { element } from '../../platform/page';
import type { Shown } from '../../state/scene';
import type { Session } from '../../state/session';
import type { Study } from '../../state/study/study';
import { kTimedRuns, type Timed } from '../../state/study/timed';

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
const kBeyondPaper: readonly string[] = ['recheck', 'motion', 'holes', 'seams'];

/** Shows how long the transfer takes, and apart from that how long its files took to read. */
export function showTimes(session: Session, study: Study): void {
  const note = element('time-note', HTMLElement);
  const again = element('time-again', HTMLButtonElement);
  let timed: Timed | undefined;
  session.on('zones', ({ spent }) => {
    if (timed) return;
    const { projection } = session.shown!;
    const { timings } = projection;
    showSteps({ ...timings, classify: spent, total: timings.total + spent }, projection);
    note.textContent = 'One transfer, while the page had other things to do.';
  });
  study.on('timed', (found) => {
    timed = found;
    if (!found) return;
    showSteps(found.median, session.shown!.projection);
    note.textContent = `The median of ${kTimedRuns} transfers in this browser, on this machine with ${navigator.hardwareConcurrency} processor cores, in one thread. The fastest took ${round(found.fastest)} ms, the slowest ${round(found.slowest)} ms: what else the machine does makes the difference.`;
  });
  session.on('transfer', ({ target, cage }) => {
    const rows = [
      ['model', target],
      ['cage', cage],
    ] as const;
    element('loads', HTMLElement).replaceChildren(
      ...rows.map(([what, { spent }]) => rowOf(what, spent ? round(spent) : '–')),
    );
  });
  again.addEventListener('click', async () => {
    again.disabled = true;
    await study.time().catch(() => {}); // another model came
    again.disabled = false;
  });
}

const rowOf = (name: string, value: string): HTMLElement =>
  make('tr', {}, make('th', { scope: 'row' }, name), make('td', {}, value));

/** Shows the steps that the preset takes. */
function showSteps(timings: Timings, { preset }: Shown['projection']): void {
  element('time-total', HTMLElement).textContent = round(timings.total);
  const steps = kSteps.filter((step) => preset !== 'paper' || !kBeyondPaper.includes(step));
  const longest = Math.max(...steps.map((step) => timings[step]), Number.MIN_VALUE);
  element('timings', HTMLElement).replaceChildren(
    ...steps.map((step) => {
      const row = rowOf(step, round(timings[step]));
      row.style.setProperty('--share', String(timings[step] / longest));
      return row;
    }),
  );
}

function round(milliseconds: number): string {
  return milliseconds.toFixed(milliseconds < 0.1 ? 3 : milliseconds < 10 ? 2 : 1);
}
