import type { Command, History } from 'cagecast/three/paint';
import type { Session } from '../session';
import { type Files, filesIn, kVersion, type Project, type Snapshot } from './project';
import type { Shelf, Work, WorkStore } from './shelf';

// Milliseconds: work is stored when people pause, and at the latest after a while.
const kPause = 700;
const kLongest = 5000;
const kOwnPatience = 1000; // until the page that was reloaded has let go of its slot

/** A line about kept work, and what can be done. */
export interface Offer {
  text: string;
  action?: { title: string; run(): void };
}

/** How people hear of it. */
interface KeeperView {
  offer(offer: Offer): void;
  /** Whether work is kept on this device. */
  note(text: string): void;
  error(text: string): void;
}

/** What an error says, without a full stop. */
const messageOf = (error: unknown): string =>
  (error instanceof Error ? error.message : String(error)).replace(/\.$/, '');

/**
 * Keeps the state of the page in this browser, and brings it back. Each tab has a slot of its own; the works of the last few
 * slots are kept.
 */
export class Keeper {
  readonly #project: Project;
  readonly #session: Session;
  readonly #history: History;
  readonly #shelf: Shelf;
  readonly #view: KeeperView;
  #store: WorkStore | undefined;
  #slot = newSlot();
  /** The last step before the work in this slot. */
  #begin: Command | undefined;
  /** The slot before this one. */
  #aside: string | undefined;
  /** What was stored last: all of it, and the work. */
  #kept: { all: string; work: string; fragment: string } | undefined;
  /** The work of the page as it opened. */
  #first: string | undefined;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #since: number | undefined;
  #saving: Promise<void> | undefined;
  /** How many states are being opened. */
  #opening = 0;
  /** Why the work was not stored when that was tried last. */
  #failure: string | undefined;
  #isSaid = false;

  /** @param page What is kept, and the undo history, which says whether it was worked on. */
  constructor(page: { project: Project; session: Session; history: History }, shelf: Shelf, view: KeeperView) {
    const { project, session, history } = page;
    this.#project = project;
    this.#session = session;
    this.#history = history;
    this.#shelf = shelf;
    this.#view = view;
    project.onTouch(() => this.#touch());
  }

  /** Whether nothing would be lost by leaving now. */
  get isKept(): boolean {
    return this.#has(this.#project.snapshot());
  }

  #has(snapshot: Snapshot | undefined): boolean {
    return snapshot === undefined || snapshot.work === (this.#kept?.work ?? this.#first);
  }

  /** Brings the last work of this tab back, or of the browser. @returns Whether that failed, and no other model was opened meanwhile. */
  async restore(): Promise<boolean> {
    try {
      this.#store = await this.#shelf.open();
      // What may lie there although nothing was kept would come as a surprise.
      if (!this.#shelf.flags.get('work')) return false;
      const own = this.#shelf.flags.get('slot');
      const rank = ({ slot }: Work): number => (slot === own ? 0 : 1);
      const works = (await this.#store.works()).toSorted((a, b) => rank(a) - rank(b));
      const work = await this.#firstFree(works, own);
      if (!work) return false;
      const aside = work === works[0] ? this.#reasonToWait(work) : 'An earlier work of yours is kept.';
      if (!aside) return !(await this.#show(work, true)) && !this.#project.isReplaced;
      this.#offerBack(aside, work.slot);
    } catch (error) {
      this.#fail(error);
    } finally {
      this.#shelf.flags.set('start', undefined);
      void this.#shelf.hold(this.#slot, 0);
      this.#touch();
    }
    return false;
  }

  /** The first of the works that no other tab has open. @param own The slot that this tab had. */
  async #firstFree(works: Work[], own: string | undefined): Promise<Work | undefined> {
    for (const work of works) if (await this.#shelf.hold(work.slot, work.slot === own ? kOwnPatience : 0)) return work;
    return undefined;
  }

  /** Puts the work aside, and opens the page as at first. */
  async startOver(): Promise<void> {
    await this.save();
    this.#shelf.flags.set('start', 'over');
    this.#shelf.startOver();
  }

  /** Opens a project. The work before it stays in its slot, as it was. @returns and @throws like `Project.open`. */
  async open(parts: Record<string, unknown>, files: Files): Promise<boolean> {
    await this.save();
    const { isKept } = this;
    if (!(await this.#open(parts, files))) return false;
    this.#leaveSlot(isKept);
    return true;
  }

  /** Stores the state as it is now, before something else takes its place, which is stored in another slot. */
  async putAside(): Promise<void> {
    if (this.#opening > 0) return; // what is opened knows its slot
    const snapshot = this.#project.snapshot();
    let isKept = true;
    this.#opening++;
    try {
      clearTimeout(this.#timer);
      await this.#saving;
      if (snapshot && this.#isWork(snapshot) && this.#store) await this.#put(snapshot, this.#store);
      isKept = this.#has(snapshot);
    } finally {
      this.#opening--;
    }
    this.#leaveSlot(isKept);
  }

  /** Opens a state. Nothing is stored meanwhile: it would be the models that are shown with settings of those to come. */
  async #open(parts: Record<string, unknown>, files: Files): Promise<boolean> {
    this.#opening++;
    try {
      await this.#saving;
      return await this.#project.open(parts, files);
    } finally {
      this.#opening--;
      this.#touch();
    }
  }

  /** Goes on in a new slot, and offers to bring back what was in the last one. @param isKept Whether that is all of the work. */
  #leaveSlot(isKept: boolean): void {
    const before = this.#kept && this.#slot;
    this.#moveTo(newSlot());
    void this.#shelf.hold(this.#slot, 0);
    this.#begin = this.#history.last;
    this.#kept = this.#first = undefined;
    this.#touch();
    if (before) this.#offerBack(kAside, before, isKept);
    else if (!isKept && this.#failure)
      this.#view.offer({ text: `Your last work could not be put aside: ${this.#failure}.` });
  }

  /** Offers to bring back the work of a slot. @param isWhole Whether all of it is there. */
  #offerBack(text: string, slot: string, isWhole = true): void {
    const back = async (): Promise<void> => {
      const work = (await this.#store!.works()).find((one) => one.slot === slot);
      if (work) await this.#show(work);
    };
    const rest = isWhole || !this.#failure ? '' : ` Its last changes could not be kept: ${this.#failure}.`;
    this.#view.offer({ text: text + rest, action: { title: 'Bring it back', run: () => void back() } });
  }

  /** Goes on in another slot. Only the last one is still held, so that the works of others give way to newer ones. */
  #moveTo(slot: string): void {
    if (slot === this.#slot) return;
    if (this.#aside && this.#aside !== slot) this.#shelf.letGo(this.#aside);
    this.#aside = this.#slot;
    this.#slot = slot;
  }

  /** Stores the state now, if it is work. */
  async save(): Promise<void> {
    clearTimeout(this.#timer);
    await this.#saving;
    this.#since = undefined;
    if (this.#opening > 0) return;
    const snapshot = this.#project.snapshot();
    if (!snapshot || !this.#isWork(snapshot) || !this.#store) return;
    // A stroke that is being drawn is stored when it ends.
    if (this.#history.held) return this.#touch();
    this.#saving = this.#put(snapshot, this.#store).finally(() => (this.#saving = undefined));
    await this.#saving;
  }

  /** Why a work is not brought back without asking; undefined if it is. */
  #reasonToWait({ fragment }: Work): string | undefined {
    if (this.#shelf.flags.get('start') === 'over') return kAside;
    if (this.#shelf.flags.get('work') === 'opening')
      return 'Your last work is kept. The page did not get to show it last time.';
    const { fragment: current } = this.#shelf;
    if (fragment !== current && this.#shelf.isLink(current)) return 'Your last work is kept.';
    return undefined;
  }

  /** @param yields Whether a model that was opened already stays. */
  async #show(work: Work, yields = false): Promise<boolean> {
    await this.save();
    const { isKept } = this;
    // What was only looked at is no work that is missed.
    const isMissed = this.#history.last !== this.#begin;
    const before = isMissed ? this.#kept && this.#slot : undefined;
    const lost = isMissed && !before && !isKept && this.#failure;
    // If it takes the page down, the next one does not try by itself.
    this.#shelf.flags.set('work', 'opening');
    try {
      if (work.version !== kVersion) throw new Error('it was saved by another version of the page');
      const found = new Map<string, File>();
      for (const key of work.files) {
        const blob = await this.#store!.file(key);
        if (!blob) continue;
        const file = blob instanceof File ? blob : new File([blob], 'painting');
        this.#project.know(file, key);
        found.set(key, file);
      }
      if ((yields && this.#project.isReplaced) || !(await this.#open(work.parts, filesIn(found)))) {
        this.#offerBack('Your last work is kept.', work.slot);
        return false;
      }
      this.#moveTo(work.slot);
      this.#shelf.flags.set('slot', work.slot);
      const { parts, work: now } = this.#project.snapshot()!;
      this.#kept = { all: JSON.stringify(parts), work: now, fragment: work.fragment };
      const text = `Your last work is back.${lost ? ` What was here could not be kept: ${lost}.` : ''}`;
      if (before && before !== work.slot) this.#offerBack(`${text} What was here is put aside.`, before, isKept);
      else this.#view.offer({ text, action: { title: 'Start over', run: () => void this.startOver() } });
      this.#view.note(kKept);
      return true;
    } catch (error) {
      this.#view.offer({ text: `Your last work could not be brought back: ${messageOf(error)}.` });
      this.#session.fail(error);
      return false;
    } finally {
      this.#shelf.flags.set('work', 'kept');
    }
  }

  #touch(): void {
    if (!this.#store) return;
    const now = performance.now();
    this.#since ??= now;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.save(), Math.max(0, Math.min(kPause, this.#since + kLongest - now)));
  }

  #isWork({ parts, work }: Snapshot): boolean {
    if (this.#kept) return JSON.stringify(parts) !== this.#kept.all || this.#shelf.fragment !== this.#kept.fragment;
    // What the page or a link opened is no work.
    if (!this.#project.isTouched && !this.#history.last) this.#first = work;
    return work !== this.#first;
  }

  async #put({ parts, work, files }: Snapshot, store: WorkStore): Promise<void> {
    try {
      const { fragment } = this.#shelf;
      const kept = { slot: this.#slot, fragment, version: kVersion, parts, files: [...files.keys()] };
      const added = new Map<string, Blob>();
      do {
        const stored = await store.keys();
        for (const [key, make] of files) if (!stored.has(key) && !added.has(key)) added.set(key, await make());
        // Again if another tab has dropped files meanwhile.
      } while (!(await store.put({ ...kept, at: Date.now() }, added, await this.#shelf.held())));
      this.#kept = { all: JSON.stringify(parts), work, fragment };
      this.#failure = undefined;
      this.#shelf.flags.set('work', 'kept');
      this.#shelf.flags.set('slot', this.#slot);
      this.#view.note(kKept);
    } catch (error) {
      this.#fail(error);
    }
  }

  /** Says once that work is not kept. */
  #fail(error: unknown): void {
    const isFull = (error as Error | null)?.name === 'QuotaExceededError';
    this.#failure = isFull ? 'there is no room left for this page' : messageOf(error);
    const text = `Your work is not kept on this device: ${this.#failure}. Save the project as a file before you leave.`;
    this.#view.note(text);
    if (isFull && !this.#isSaid) this.#view.error(text);
    this.#isSaid = true;
  }
}

const kAside = 'Your last work is put aside.';
const kKept = 'Your work is kept on this device as you go.';

const newSlot = (): string => `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;
