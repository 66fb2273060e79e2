import type { Finding, Inspection, Lock } from 'cagecast';
import { verdictOf } from '#inspect';
import { TransferClient } from '../../loading/transfer-client';
import { make } from '../../platform/make';
import { element } from '../../platform/page';
import type { CageMaker } from '../../state/cage-maker';
import { namesLeftOut, withoutParts } from '../../state/left-out';
import { landmarksOf } from '../../state/model';
import type { Session } from '../../state/session';
import { Superseded } from '../../state/transfers';
import {
  type KnownVerdict,
  kMaxInspected,
  paintableShare,
  type Remedy,
  regionOf,
  remedyFor,
  takeBacks,
} from '../../state/verdict/verdict';
import { forPeople, reasonOf } from '../../state/wording';
import { marksOf } from '../../view/segments';
import type { Viewer } from '../../view/viewer';
import { StageVerdict } from './stage-verdict';

const kInspectDelay = 800; // milliseconds without a change before the cage is inspected
const kSoon = 'The cage will be inspected in a moment.';
const kVerdicts: Record<Inspection['verdict'], string> = {
  good: 'The cage fits this model.',
  usable: 'The cage is usable, with reservations.',
  unfit: 'The cage does not fit this model.',
};

/**
 * Shows whether the cage fits the target, and what to do if not: the findings of `cagecast inspect`, computed in a worker of
 * its own. A finding highlights its parts, and can lock them as it proposes.
 */
export class FitPanel {
  readonly #session: Session;
  readonly #viewer: Viewer | undefined;
  readonly #verdict = element('fit-verdict', HTMLElement);
  readonly #findings = element('fit-findings', HTMLElement);
  readonly #leftOut = element('fit-left-out', HTMLElement);
  readonly #button = element('fit-inspect', HTMLButtonElement);
  readonly #maker: CageMaker;
  readonly #stageVerdict: StageVerdict;
  #client: TransferClient | undefined;
  #waiting: ReturnType<typeof setTimeout> | undefined;
  /** What is not said while the page mends it by itself. */
  #unsaid: Inspection | undefined;

  constructor(session: Session, viewer: Viewer | undefined, maker: CageMaker) {
    this.#session = session;
    this.#maker = maker;
    this.#stageVerdict = new StageVerdict(session, viewer, maker, () => void this.#inspect());
    this.#viewer = viewer;
    session.on('transfer', () => {
      this.#forget();
      this.#offerBack();
      this.#show('', [make('p', {}, kSoon)]);
    });
    session.on('zones', () => this.#onChange());
    session.on('progress', ({ state }) => {
      if (state !== 'working' && this.#unsaid) this.#write(this.#unsaid);
    });
    this.#button.addEventListener('click', () => void this.#inspect());
  }

  /** The findings are outdated. */
  #onChange(): void {
    const { target, cage } = this.#session.shown!;
    const triangles = (target.mesh.indices.length + cage.mesh.indices.length) / 3;
    this.#forget();
    if (triangles <= kMaxInspected) this.#waiting = setTimeout(() => void this.#inspect(), kInspectDelay);
    else this.#show('', [make('p', {}, 'This model is large; inspecting it takes a while.')], this.#next);
    this.#button.hidden = triangles <= kMaxInspected;
  }

  /** Ends the inspection in progress: it is not of what is shown. */
  #forget(): void {
    clearTimeout(this.#waiting);
    this.#unsaid = undefined;
    this.#client?.cancel();
  }

  /** What to do about a cage that is not inspected by itself. */
  get #next(): Remedy {
    return this.#maker.isOthers ? this.#making : { title: 'Check it', run: () => void this.#inspect() };
  }

  get #making(): Remedy {
    return { title: 'Make a cage', run: () => this.#maker.make() };
  }

  async #inspect(): Promise<void> {
    const {
      shown,
      rules: { preset, threshold, weldTolerance },
      choices: { parts, locks },
    } = this.#session;
    if (!shown) return;
    this.#button.hidden = true;
    this.#show('', [make('p', {}, 'The cage is being inspected.')]);
    this.#client ??= new TransferClient();
    try {
      const { target, cage, projection } = shown;
      const landmarks = landmarksOf(cage);
      const options = { preset, threshold, weldTolerance, parts, locks, landmarks };
      const inspection = await this.#client.ask('inspect', cage, withoutParts(target, projection), options);
      this.#session.reportInspection(inspection);
      if (this.#session.isMakingCage) this.#unsaid = inspection;
      else this.#write(inspection);
    } catch (error) {
      if (error instanceof Superseded) return;
      this.#show('', [make('p', {}, `The cage could not be inspected: ${reasonOf(error)}`)], this.#next);
    }
  }

  #write(inspection: Inspection): void {
    this.#unsaid = undefined;
    const { verdict, findings, segments } = inspection;
    const list = make('ul', {}, ...findings.map((finding) => this.#item(finding, inspection)));
    const share = `${Math.round(100 * paintableShare(segments))} % of`;
    const region = regionOf(this.#session.shown!, segments);
    const painted = region
      ? `The cage covers ${region} of the model only: ${share} its visible surface can be painted.`
      : `${share} the visible surface can be painted.`;
    const remedies = findings.flatMap((finding) => remedyFor(finding, inspection, this.#session, this.#maker) ?? []);
    const { isFresh, isMade, isOthers } = this.#maker;
    const reasons = findings.filter((finding) => verdictOf([finding]) === 'unfit');
    // Where keeping a part is enough, another cage would be judged by the same rules.
    const [kept] = (!isOthers && reasons.every(({ locks }) => locks) && reasons[0]?.places) || [];
    if (kept) remedies.push({ title: `Keep “${kept.part}”`, run: () => this.#session.lock([kept.segment], 'keep') });
    const making = verdict === 'unfit' && !(isFresh && isMade) && !kept ? [this.#making] : [];
    // The cage of another model is not meant for this one.
    if (isOthers) remedies.unshift(...making);
    const content: HTMLElement[] = [
      make('p', {}, `${painted} ${kVerdicts[verdict]}`),
      ...(findings.length > 0 ? [list] : []),
    ];
    content.push(...making.map(buttonFor));
    // What is good needs no remedy on the stage; the findings offer theirs.
    const remedy = verdict === 'good' ? undefined : (remedies[0] ?? making[0]);
    this.#show(verdict, content, remedy, inspection);
  }

  #show(verdict: KnownVerdict, content: HTMLElement[], remedy?: Remedy, inspection?: Inspection): void {
    this.#verdict.textContent = this.#verdict.dataset.verdict = verdict;
    this.#findings.replaceChildren(...content);
    this.#stageVerdict.show(verdict, remedy, inspection);
  }

  /** Offers to take back what is left out; a click that has left something out gets to undo it. */
  #offerBack(): void {
    const hadFocus = [this.#findings, this.#leftOut].some((box) => box.contains(document.activeElement));
    const buttons = takeBacks(this.#session).map(buttonFor);
    const names = namesLeftOut(this.#session.shown!).map((name) => `“${name}”`);
    const text =
      names.length > 0 ? [make('p', {}, `Left out, neither painted nor in the way: ${names.join(', ')}.`)] : [];
    this.#leftOut.replaceChildren(...text, ...buttons);
    if (hadFocus) buttons.at(-1)?.focus();
  }

  #item(finding: Finding, inspection: Inspection): HTMLElement {
    const { sentence, advice, places = [], locks } = finding;
    const item = make('li', {}, make('p', {}, `${forPeople(sentence)}.`), make('p', {}, forPeople(advice)));
    const remedy = remedyFor(finding, inspection, this.#session, this.#maker);
    if (remedy) {
      const title = `Do it: ${remedy.title[0]!.toLowerCase()}${remedy.title.slice(1)}`;
      item.append(buttonFor({ ...remedy, title }));
    }
    const segments = places.map(({ segment }) => segment);
    if (segments.length > 0) {
      for (const begin of ['pointerenter', 'focusin']) item.addEventListener(begin, () => this.#highlight(segments));
      for (const end of ['pointerleave', 'focusout']) item.addEventListener(end, () => this.#highlight([]));
    }
    const entries = Object.entries(locks ?? {});
    for (const lock of ['keep', 'exclude'] as const) {
      const chosen = entries.filter(([, other]) => other === lock).map(([segment]) => Number(segment));
      if (chosen.length > 0) item.append(this.#lockButton(chosen, lock));
    }
    return item;
  }

  #lockButton(segments: number[], lock: Lock): HTMLButtonElement {
    const them = segments.length === 1 ? 'it' : `all ${segments.length}`;
    const title = lock === 'keep' ? `Keep ${them}` : `Keep ${them} bare`;
    return buttonFor({ title, run: () => this.#session.lock(segments, lock) });
  }

  #highlight(segments: readonly number[]): void {
    const { shown } = this.#session;
    this.#viewer?.stage.highlight('parts', shown && marksOf(shown, segments));
  }
}

function buttonFor({ title, run }: Remedy): HTMLButtonElement {
  const button = make('button', { type: 'button', className: 'quiet' }, title);
  button.addEventListener('click', run);
  return button;
}
