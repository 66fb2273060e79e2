import { element } from '../platform/page';
import type { Session } from '../state/session';
import { type KnownVerdict, paintableShare, type Remedy, regionOf } from '../state/verdict';
import { goTo } from './section-nav';

/** Shows the verdict on the cage on the stage and on the model's card: first, how much of the model can be painted. */
export class StageVerdict {
  readonly #session: Session;
  readonly #box = element('stage-verdict', HTMLElement);
  readonly #text = element('stage-verdict-text', HTMLButtonElement);
  readonly #button = element('stage-remedy', HTMLButtonElement);
  readonly #card = element('model-verdict', HTMLElement);
  #verdict: KnownVerdict = '';
  #remedy: Remedy | undefined;

  constructor(session: Session) {
    this.#session = session;
    this.#text.addEventListener('click', () => goTo(element('fit', HTMLElement)));
    this.#button.addEventListener('click', () => this.#remedy?.run());
    session.on('zones', () => this.#write());
  }

  /** @param remedy The first that can be done; without a verdict, only if the cage is not being inspected. */
  show(verdict: KnownVerdict, remedy?: Remedy): void {
    this.#verdict = verdict;
    this.#remedy = remedy;
    this.#write();
  }

  #write(): void {
    const verdict = this.#verdict;
    const { shown, classification } = this.#session;
    if (!shown || !classification) return;
    const { segmentStats } = classification;
    const region = regionOf(shown, segmentStats);
    const painted = `${Math.round(100 * paintableShare(segmentStats))} % paintable`;
    const of = region && `${region[0]!.toUpperCase()}${region.slice(1)}`;
    const share = of ? `${of}: ${painted}` : painted;
    const foreign = shown.cage.sample && shown.cage.sample !== shown.target.sample;
    const unknown = this.#remedy ? 'The cage is not checked yet' : 'Checking the cage…';
    const texts: Record<KnownVerdict, string> = {
      '': foreign ? 'The cage is another model’s' : unknown,
      good: of ? `${of} of the model: ${painted}` : painted,
      usable: `${share}, with reservations`,
      unfit: 'The cage does not fit',
    };
    this.#box.hidden = this.#card.hidden = false;
    this.#text.textContent = texts[verdict];
    const unchecked = this.#remedy ? 'not checked yet' : 'checking…';
    this.#card.textContent = verdict === 'unfit' ? 'does not fit' : verdict === '' ? unchecked : share;
    this.#box.dataset.verdict = this.#card.dataset.verdict = verdict;
    const leaves = !this.#remedy && document.activeElement === this.#button;
    this.#button.hidden = !this.#remedy;
    if (leaves) this.#text.focus();
    this.#button.textContent = this.#remedy?.title ?? '';
  }
}
