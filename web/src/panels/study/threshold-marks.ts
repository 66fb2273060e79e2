import { classify } from 'cagecast';
import { make } from '../../platform/make';
import { element } from '../../platform/page';
import { Pace } from '../../state/pace';
import type { Session } from '../../state/session';
import { nameOfPart } from '../part-menu';

const kSeekDelay = 500; // milliseconds without a change
const kSteps = 100; // of the slider
const kMaxPoints = 300_000;
const kMaxNamed = 4;

/** Marks on the slider of the threshold where a part would be painted or not from. */
export class ThresholdMarks {
  readonly #session: Session;
  #waiting: ReturnType<typeof setTimeout> | undefined;
  /** Of the marks that are shown or sought: all but the threshold decides them. */
  #basis: readonly unknown[] = [];

  constructor(session: Session) {
    this.#session = session;
    session.on('zones', () => this.#follow());
  }

  #follow(): void {
    const { shown, rules, locks } = this.#session;
    const basis = [shown!.projection, rules.preset, JSON.stringify(locks)];
    if (basis.every((value, i) => value === this.#basis[i])) return;
    this.#basis = basis;
    clearTimeout(this.#waiting);
    this.#write(new Map());
    if (shown!.projection.visibility.length <= kMaxPoints)
      this.#waiting = setTimeout(() => void this.#seek(basis), kSeekDelay);
  }

  async #seek(basis: readonly unknown[]): Promise<void> {
    const { shown, choices } = this.#session;
    const flips = new Map<number, Set<string>>();
    const pace = new Pace();
    let before: boolean[] | undefined;
    for (let step = 0; step <= kSteps; step++) {
      const { segmentStats } = classify(shown!.projection, { threshold: step / kSteps, ...choices });
      const culled = segmentStats.map((segment) => segment.culled);
      culled.forEach((isCulled, segment) => {
        if (!before || isCulled === before[segment] || segmentStats[segment]!.area === 0) return;
        flips.set(step, (flips.get(step) ?? new Set()).add(nameOfPart(shown!, segment)));
      });
      before = culled;
      await pace.rest();
      if (basis !== this.#basis) return;
    }
    this.#write(flips);
  }

  #write(flips: ReadonlyMap<number, ReadonlySet<string>>): void {
    const marks = [...flips.keys()].map((step) => make('option', { value: String(step / kSteps) }));
    element('threshold-marks', HTMLElement).replaceChildren(...marks);
    const listed = [...flips]
      .slice(0, kMaxNamed)
      .map(([step, names]) => `${[...names].join(', ')} at ${step / kSteps}`);
    const more = flips.size > kMaxNamed ? `, and ${flips.size - kMaxNamed} more` : '';
    element('threshold-flips', HTMLElement).textContent =
      flips.size > 0 ? `Parts that change: ${listed.join('; ')}${more}.` : '';
  }
}
