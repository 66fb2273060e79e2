import { Visibility, Zone } from 'cagecast';
import { face, onFace } from '../platform/face';
import { element } from '../platform/page';
import type { Choice } from '../state/choices';
import type { Shown } from '../state/scene';
import type { Session } from '../state/session';
import { plainNameOf } from '../state/verdict/part-names';
import type { Spot } from '../view/pick';
import { marksOf } from '../view/segments';
import type { Viewer } from '../view/viewer';

const kMargin = 8; // pixels from the edges of the stage

/**
 * A click on a part, or Enter for the one at the centre, opens what is to be said of it and can be chosen for it: always in Play, in
 * Inspect in the views of parts and zones.
 */
export class PartMenu {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #stage = element('stage', HTMLElement);
  readonly #box = element('part-menu', HTMLElement);
  readonly #text = element('part-menu-text', HTMLElement);
  #segment: number | undefined;
  #spot: Spot | undefined;

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
    canvas.addEventListener('dblclick', () => this.#close()); // its first click has opened it
    element('part-menu-close', HTMLButtonElement).addEventListener('click', () => this.#close());
    for (const input of this.#box.querySelectorAll('input'))
      input.addEventListener('change', () => {
        if (this.#segment !== undefined) session.lock([this.#segment], input.value as Choice);
      });
    session.on('transfer', () => this.#close());
    session.on('zones', () => this.#write());
    session.on('view', () => this.#isOffered || this.#close());
    onFace(() => this.#close());
  }

  get #isOffered(): boolean {
    const { mode } = this.#session.view;
    return face() === 'play' || mode === 'segments' || mode === 'zones';
  }

  #open(spot: Spot | undefined, x: number, y: number): void {
    const { shown } = this.#session;
    if (!spot || !shown || !this.#isOffered) {
      this.#close();
      return;
    }
    this.#segment = shown.projection.segments[shown.target.mesh.indices[3 * spot.triangle]!]!;
    this.#spot = spot;
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
    const plain = face() === 'play';
    const primitive = shown.target.mesh.primitives[shown.projection.segmentStats[this.#segment]!.group]!;
    const title = element('part-menu-title', HTMLElement);
    title.textContent = plain ? plainNameOf(primitive) : primitive.name;
    title.translate = plain; // else it is the file's own
    const lock = locks[this.#segment] ?? 'auto';
    if (plain) void this.#say();
    else this.#text.textContent = paintedPoints(shown, classification.zones, this.#segment, lock);
    for (const input of this.#box.querySelectorAll('input')) input.checked = input.value === lock;
  }

  /** Says why the spot is painted or not. */
  async #say(): Promise<void> {
    const spot = this.#spot!;
    const [{ explain }, { BoundaryLoops }] = await Promise.all([
      import('../explain/explanation'),
      import('../explain/boundary-loops'),
    ]);
    const { shown, classification, rules, locks, bare } = this.#session;
    if (spot !== this.#spot || !shown || !classification) return;
    const loops = new BoundaryLoops(shown.cage.mesh);
    const facts = { shown, classification, rules, locks, bare, loops };
    const { verdict, because } = explain(facts, spot.triangle, spot.weights);
    this.#text.textContent = `${verdict.replace(/:.*/, '')}: ${because}.`;
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
