import type { Inspection } from 'cagecast';
import { face, onFace } from '../../platform/face';
import { element } from '../../platform/page';
import type { CageMaker } from '../../state/cage-maker';
import type { Shown } from '../../state/scene';
import type { Session } from '../../state/session';
import { bareParts } from '../../state/verdict/part-names';
import {
  type KnownVerdict,
  paintableShare,
  type Remedy,
  regionOf,
  topicOf,
  verdictWords,
  worthSaying,
} from '../../state/verdict/verdict';
import type { Viewer } from '../../view/viewer';
import { goTo } from '../section-nav';

/**
 * Shows the verdict on the cage on the stage: in Play what stays bare, with a list of spots behind it; in
 * Inspect how much is painted, with a remedy.
 */
export class StageVerdict {
  readonly #session: Session;
  readonly #box = element('stage-verdict', HTMLElement);
  readonly #text = element('stage-verdict-text', HTMLButtonElement);
  readonly #button = element('stage-remedy', HTMLButtonElement);
  #verdict: KnownVerdict = '';
  #inspection: Inspection | undefined;
  #remedy: Remedy | undefined;

  /** @param inspect Inspects the cage. */
  constructor(session: Session, viewer: Viewer | undefined, maker: CageMaker, inspect: () => void) {
    this.#session = session;
    this.#text.addEventListener('click', async () => {
      if (face() === 'inspect') return goTo(element('fit', HTMLElement));
      const { showSpots } = await import('./spot-list');
      showSpots(this.#text, { session, maker, inspection: this.#inspection, inspect }, viewer);
    });
    this.#button.addEventListener('click', () => this.#remedy?.run());
    session.on('zones', () => this.#write());
    onFace(() => this.#write());
  }

  /**
   * @param remedy     The first that can be done; without a verdict, only if the cage is not being inspected.
   * @param inspection What the verdict is about, if there is one.
   */
  show(verdict: KnownVerdict, remedy?: Remedy, inspection?: Inspection): void {
    this.#verdict = verdict;
    this.#inspection = inspection;
    this.#remedy = remedy;
    this.#write();
  }

  #write(): void {
    const verdict = this.#verdict;
    const { shown, classification } = this.#session;
    if (!shown || !classification) return;
    const words = (face() === 'play' ? this.#inWords : this.#inNumbers).bind(this);
    this.#box.hidden = false;
    this.#text.textContent = words(shown, classification.segmentStats);
    this.#box.dataset.verdict = verdict;
    const isHidden = !this.#remedy || face() === 'play';
    const leaves = isHidden && document.activeElement === this.#button;
    this.#button.hidden = isHidden;
    if (leaves) this.#text.focus();
    this.#button.textContent = this.#remedy?.title ?? '';
  }

  #inWords(shown: Shown, stats: Stats): string {
    return verdictWords(this.#verdict, {
      region: regionOf(shown, stats),
      bare: bareParts(shown, stats),
      findings: new Set(worthSaying(this.#inspection?.findings ?? []).map(topicOf)).size,
      isForeign: isForeign(shown),
    });
  }

  #inNumbers(shown: Shown, stats: Stats): string {
    const region = regionOf(shown, stats);
    const painted = `${Math.round(100 * paintableShare(stats))} % paintable`;
    const of = region && capital(region);
    const share = of ? `${of}: ${painted}` : painted;
    const unknown = this.#remedy ? 'The cage is not checked yet' : 'Checking the cage…';
    return {
      '': isForeign(shown) ? 'The cage is another model’s' : unknown,
      good: of ? `${of} of the model: ${painted}` : painted,
      usable: `${share}, with reservations`,
      unfit: 'The cage does not fit',
    }[this.#verdict];
  }
}

type Stats = Parameters<typeof bareParts>[1] & Parameters<typeof regionOf>[1];

const isForeign = ({ target, cage }: Shown): boolean => cage.sample !== undefined && cage.sample !== target.sample;

const capital = (text: string): string => `${text[0]!.toUpperCase()}${text.slice(1)}`;
