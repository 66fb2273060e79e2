import { Visibility, Zone } from 'cagecast';
import { element } from '../platform/page';
import type { Choice } from '../state/choices';
import type { Shown } from '../state/scene';
import type { Session } from '../state/session';
import type { Spot } from '../view/pick';
import { marksOf } from '../view/segments';
import type { Viewer } from '../view/viewer';

const kMargin = 8; // pixels from the edges of the stage

/** In the views of parts and zones: a click on a part, or Enter for the one at the centre, opens what can be chosen for it. */
export class PartMenu {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #stage = element('stage', HTMLElement);
  readonly #box = element('part-menu', HTMLElement);
  #segment: number | undefined;

  constructor(session: Session, viewer: Viewer) {
    this.#session = session;
    this.#viewer = viewer;
    viewer.pointing.idle = { tap: (spot, { clientX, clientY }) => this.#open(spot, clientX, clientY) };
    const canvas = element('view', HTMLCanvasElement);
    canvas.addEventListener('keydown', ({ key }) => {
      const { x, y } = viewer.screen.center;
      if (key === 'Enter' && !viewer.pointing.tool) this.#open(viewer.screen.pick(x, y), x, y);
    });
    this.#box.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.stopPropagation();
      this.#close();
    });
    element('part-menu-close', HTMLButtonElement).addEventListener('click', () => this.#close());
    for (const input of this.#box.querySelectorAll('input'))
      input.addEventListener('change', () => {
        if (this.#segment !== undefined) session.lock([this.#segment], input.value as Choice);
      });
    session.on('transfer', () => this.#close());
    session.on('zones', () => this.#write());
    session.on('view', ({ mode }) => mode === 'segments' || mode === 'zones' || this.#close());
  }

  #open(spot: Spot | undefined, x: number, y: number): void {
    const { shown, view } = this.#session;
    if (!spot || !shown || (view.mode !== 'segments' && view.mode !== 'zones')) {
      this.#close();
      return;
    }
    this.#segment = shown.projection.segments[shown.target.mesh.indices[3 * spot.triangle]!]!;
    this.#viewer.stage.highlight('parts', marksOf(shown, [this.#segment]));
    this.#box.hidden = false;
    this.#write();
    const stage = this.#stage.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = this.#box;
    const within = (at: number, size: number, all: number): string =>
      `${Math.max(kMargin, Math.min(at, all - size - kMargin))}px`;
    this.#box.style.left = within(x - stage.left + 12, width, stage.width);
    this.#box.style.top = within(y - stage.top - height / 2, height, stage.height);
    this.#box.querySelector<HTMLInputElement>('input:checked')!.focus({ preventScroll: true });
  }

  #close(): void {
    if (this.#box.hidden) return;
    this.#box.hidden = true;
    this.#segment = undefined;
    this.#viewer.stage.highlight('parts', undefined);
  }

  #write(): void {
    const { shown, classification, locks } = this.#session;
    if (this.#segment === undefined || !shown || !classification) return;
    element('part-menu-title', HTMLElement).textContent = nameOfPart(shown, this.#segment);
    const lock = locks[this.#segment] ?? 'auto';
    element('part-menu-text', HTMLElement).textContent = paintedPoints(
      shown,
      classification.zones,
      this.#segment,
      lock,
    );
    for (const input of this.#box.querySelectorAll('input')) input.checked = input.value === lock;
  }
}

/** The name of the mesh that a part belongs to. */
export function nameOfPart({ target, projection }: Shown, segment: number): string {
  return target.mesh.primitives[projection.segmentStats[segment]!.group]!.name;
}

/** How many points of a part are painted, why the others are not, and what would paint these. */
export function paintedPoints({ projection }: Shown, zones: Uint8Array, segment: number, lock: Choice): string {
  const counts = [0, 0, 0, 0, 0];
  projection.segments.forEach((other, vertex) => {
    const isBeyond = zones[vertex] === Zone.Uncovered && projection.visibility[vertex] === Visibility.Beyond;
    if (other === segment) counts[isBeyond ? 4 : zones[vertex]!]!++;
  });
  const [painted = 0, hidden = 0, uncovered = 0, culled = 0, beyond = 0] = counts;
  const all = painted + hidden + uncovered + culled + beyond;
  const reasons = [
    hidden > 0 ? `${hidden} hidden by the model itself` : '',
    uncovered > 0 ? `${uncovered} under a hole of the cage` : '',
    beyond > 0 ? `${beyond} beyond the border of the cage` : '',
    culled > 0 ? `${culled} because the whole part is not painted` : '',
  ].filter(Boolean);
  const bare = reasons.length > 0 ? ` The rest stays bare: ${reasons.join(', ')}.` : '';
  const stretched = uncovered > 0 ? ', stretched where the cage has a hole' : '';
  const anyway = bare && lock === 'keep' ? ` “Paint anyway” paints it too${stretched}.` : '';
  return `${painted.toLocaleString('en')} of ${all.toLocaleString('en')} points are painted.${bare}${anyway}`;
}
