import type { Classification } from 'cagecast';
import { announce, element } from '../platform/page';
import { namesLeftOut } from '../state/left-out';
import type { Session } from '../state/session';
import { countZones, kZones } from '../state/zones';

/** Shows the number of vertices per zone. */
export function showResults(session: Session): void {
  for (const { name, color } of kZones)
    for (const mark of document.querySelectorAll<HTMLElement>(`[data-zone=${name}]`)) mark.style.background = color;
  session.on('zones', ({ classification }) => showCounts(classification, namesLeftOut(session.shown!)));
}

function showCounts({ zones, segmentStats }: Classification, leftOut: readonly string[]): void {
  const counts = countZones(zones);
  element('count-total', HTMLElement).textContent = zones.length.toLocaleString('en');
  kZones.forEach(({ name }, number) => {
    element(`count-${name}`, HTMLElement).textContent = String(counts[number]);
    const share = zones.length > 0 ? counts[number]! / zones.length : 0;
    element(`share-${name}`, HTMLElement).textContent = `${(100 * share).toFixed(1)} %`;
    document.querySelector<HTMLElement>(`#bar [data-zone=${name}]`)!.style.flexGrow = String(share);
  });
  element('count-ncz', HTMLElement).textContent = (zones.length - counts[0]!).toLocaleString('en');
  const culled = segmentStats.filter((segment) => segment.culled).length;
  announce(
    `Done: ${counts[0]} of ${zones.length} vertices are cosmetic, ${counts[1]} are occluded, ${counts[2]} uncovered, ` +
      `${counts[3]} culled; ${culled} of ${segmentStats.length} parts are culled.` +
      (leftOut.length > 0 ? ` Left out: ${leftOut.join(', ')}.` : ''),
  );
}
