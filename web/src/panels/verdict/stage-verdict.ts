import { face, onFace } from '../platform/face';
import { element } from '../platform/page';
import type { Shown } from '../state/scene';
import type { Session } from '../state/session';
import { type KnownVerdict, paintableShare, type Remedy, regionOf, verdictWords } from '../state/verdict';
import { bareParts } from '../view/part-names';
import { goTo } from './section-nav';

/** Shows the verdict on the cage on the stage and on the model's card: in Play what stays bare, in Inspect how much is painted. */
export class StageVerdict {
  readonly #session: Session;
  readonly #box = element('stage-verdict', HTMLElement);
  readonly #text = element('stage-verdict-text', HTMLButtonElement);
  readonly #button = element('stage-remedy', HTMLButtonElement);
  readonly #card = element('model-verdict', HTMLElement);
  #verdict: KnownVerdict = '';
  #findings = 0;
  #remedy: Remedy | undefined;

  constructor(session: Session) {
    this.#session = session;
    this.#text.addEventListener('click', () => goTo(element('fit', HTMLElement)));
    this.#button.addEventListener('click', () => this.#remedy?.run());
    session.on('zones', () => this.#write());
    onFace(() => this.#write());
  }

  /**
   * @param findings How many there are.
   * @param remedy   The first that can be done; without a verdict, only if the cage is not being inspected.
   */
  show(verdict: KnownVerdict, findings: number, remedy?: Remedy): void {
    this.#verdict = verdict;
    this.#findings = findings;
    this.#remedy = remedy;
    this.#write();
  }

  #write(): void {
    const verdict = this.#verdict;
    const { shown, classification } = this.#session;
    if (!shown || !classification) return;
    const words = (face() === 'play' ? this.#inWords : this.#inNumbers).bind(this);
    const { stage, card } = words(shown, classification.segmentStats);
    this.#box.hidden = this.#card.hidden = false;
    this.#text.textContent = stage;
    this.#card.textContent = card;
    this.#box.dataset.verdict = this.#card.dataset.verdict = verdict;
    const leaves = !this.#remedy && document.activeElement === this.#button;
    this.#button.hidden = !this.#remedy;
    if (leaves) this.#text.focus();
    this.#button.textContent = this.#remedy?.title ?? '';
  }

  #inWords(shown: Shown, stats: Stats): Words {
    return verdictWords(this.#verdict, {
      region: regionOf(shown, stats),
      bare: bareParts(shown, stats),
      findings: this.#findings,
      isForeign: isForeign(shown),
    });
  }

  #inNumbers(shown: Shown, stats: Stats): Words {
    const region = regionOf(shown, stats);
    const painted = `${Math.round(100 * paintableShare(stats))} % paintable`;
    const of = region && capital(region);
    const share = of ? `${of}: ${painted}` : painted;
    const unknown = this.#remedy ? 'The cage is not checked yet' : 'Checking the cage…';
    const stage = {
      '': isForeign(shown) ? 'The cage is another model’s' : unknown,
      good: of ? `${of} of the model: ${painted}` : painted,
      usable: `${share}, with reservations`,
      unfit: 'The cage does not fit',
    }[this.#verdict];
    const unchecked = this.#remedy ? 'not checked yet' : 'checking…';
    return { stage, card: { '': unchecked, good: share, usable: share, unfit: 'does not fit' }[this.#verdict] };
  }
}

interface Words {
  stage: string;
  card: string;
}
type Stats = Parameters<typeof bareParts>[1] & Parameters<typeof regionOf>[1];

const isForeign = ({ target, cage }: Shown): boolean => cage.sample !== undefined && cage.sample !== target.sample;

const capital = (text: string): string => `${text[0]!.toUpperCase()}${text.slice(1)}`;
