import type { Command, History } from '#three';
import type { Model } from '../model';
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
  /** Whether it goes after a while. */
  isBrief?: boolean;
}

/** A scene that gives way to another: as it is saved, without what the page holds to show it. */
interface Former {
  name: string;
  snapshot: Snapshot;
  files: Promise<ReadonlyMap<string, File>>;
  slot: string;
}

/** The step that brings a scene back. */
class Replacing implements Command {
  readonly bytes = 0;

  constructor(
    readonly name: string,
    readonly undo: () => void,
  ) {}

  redo(): void {} // the steps of what comes back replace this one
}

/** How people hear of it. */
interface KeeperView {
  /** Undefined takes the last one away. */
  offer(offer: Offer | undefined): void;
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
  /** The target requested in place of the shown one, and its file once it is known. */
  #coming: { target?: Promise<Model>; former?: Former | undefined } = {};
  #replacing: Replacing | undefined;
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
    history.on('change', () => {
      if (!this.#replacing || history.last === this.#replacing) return;
      this.#replacing = undefined;
      view.offer(undefined);
    });
    session.on('leave', () => {
      const { target, former } = this.#coming;
      this.#coming = {};
      if (!target || target !== session.requested.target) return;
      const missed = former ?? this.#former();
      if (missed) void this.#giveWay(missed);
    });
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

  /** Opens a project. What it replaces stays in its slot, as it was. @returns and @throws like `Project.open`. */
  async open(parts: Record<string, unknown>, files: Files): Promise<boolean> {
    await this.save();
    const former = this.#former();
    if (!(await this.#open(parts, files))) return false;
    this.#leaveSlot(former);
    return true;
  }

  /** Takes the state as it is now for what the next target replaces: it changes before that is shown. */
  putAside(): void {
    this.#coming = { former: this.#former() };
  }

  /** Once this target is shown, what it replaced can be brought back. */
  replaceBy(target: Promise<Model>): void {
    this.#coming.target = target;
  }

  /** The scene as it is now; undefined if nobody would miss it. */
  #former(): Former | undefined {
    const snapshot = this.#project.snapshot();
    if (!snapshot) return undefined;
    // What was only looked at is no work that is missed.
    if (!this.#project.isTouched && this.#history.last === this.#begin && !this.#kept) return undefined;
    // Made now: paintings may be gone later.
    const all = [...snapshot.files].map(async ([key, make]): Promise<[string, File]> => {
      const made = await make();
      const file = made instanceof File ? made : new File([made], 'painting');
      this.#project.know(file, key);
      return [key, file];
    });
    const files = Promise.all(all).then((entries) => new Map(entries));
    files.catch(() => {}); // reported where it is awaited
    const make = (key: string) => async () => (await files).get(key)!;
    const { name, sample } = this.#session.shown!.target;
    return {
      name: sample?.title ?? name.replace(/\.\w+$/, ''),
      snapshot: { ...snapshot, files: new Map([...snapshot.files.keys()].map((key) => [key, make(key)])) },
      files,
      slot: this.#slot,
    };
  }

  /** Stores a scene that is being replaced, and goes on in another slot once the other one is shown. */
  async #giveWay(former: Former): Promise<void> {
    const shown = new Promise<void>((done) => {
      const end = this.#session.on('progress', ({ state }) => {
        if (state === 'working') return;
        end();
        done();
      });
    });
    this.#opening++;
    try {
      clearTimeout(this.#timer);
      await this.#saving;
      const { snapshot } = former;
      if (this.#store && JSON.stringify(snapshot.parts) !== this.#kept?.all) await this.#put(snapshot, this.#store);
      await shown;
    } finally {
      this.#opening--;
    }
    this.#leaveSlot(former);
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

  /** Goes on in a new slot. @param former What was in the last one. */
  #leaveSlot(former: Former | undefined): void {
    const isKept = this.#has(former?.snapshot);
    this.#moveTo(newSlot());
    void this.#shelf.hold(this.#slot, 0);
    this.#kept = this.#first = undefined;
    this.#begin = this.#history.last;
    this.#view.note('');
    if (former) this.#offerUndo(former, isKept);
    this.#touch();
  }

  /** Makes it an undo step that a scene was replaced: there is one at most, which holds the scene. */
  #offerUndo(former: Former, isKept: boolean): void {
    const step = new Replacing(`replacing ${former.name}`, () => void this.#bringBack(former, step, isKept));
    this.#history.forget((command) => command instanceof Replacing);
    this.#history.add(step);
    this.#begin = this.#replacing = step;
    const rest = isKept || !this.#failure ? '' : ` It could not be kept on this device: ${this.#failure}.`;
    const action = { title: 'Undo', run: () => void this.#history.undo() };
    this.#view.offer({ text: `Replaced ${former.name}.${rest}`, action, isBrief: true });
  }

  async #bringBack({ snapshot, files, slot }: Former, step: Replacing, isKept: boolean): Promise<void> {
    try {
      if (await this.#open(snapshot.parts, filesIn(await files)))
        return this.#goOnIn(slot, isKept && this.#store ? this.#shelf.fragment : undefined);
    } catch (error) {
      this.#session.fail(error);
    }
    // It is still what was done last.
    this.#history.forget((command) => command === step);
    this.#history.add(step);
    this.#begin = step;
  }

  /** Goes on in the slot of a work that was just brought back. @param fragment With which it is stored there; undefined if it is not. */
  #goOnIn(slot: string, fragment: string | undefined): void {
    this.#moveTo(slot);
    this.#shelf.flags.set('slot', slot);
    this.#begin = this.#history.last;
    const { parts, work } = this.#project.snapshot()!;
    this.#kept = fragment === undefined ? undefined : { all: JSON.stringify(parts), work, fragment };
    this.#first = undefined;
    if (this.#kept) this.#view.note(kKept);
  }

  /** Offers to bring back the work of a slot. */
  #offerBack(text: string, slot: string): void {
    const back = async (): Promise<void> => {
      const work = (await this.#store!.works()).find((one) => one.slot === slot);
      if (work) await this.#show(work);
    };
    this.#view.offer({ text, action: { title: 'Bring it back', run: () => void back() } });
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
    const former = this.#former();
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
      this.#goOnIn(work.slot, work.fragment);
      const action = { title: 'Start over', run: () => void this.startOver() };
      if (former) this.#offerUndo(former, isKept);
      else this.#view.offer({ text: 'Your last work is back.', action });
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
    if (!this.#project.isTouched && this.#history.last === this.#begin) this.#first = work;
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
