import { madeOf } from '../made-cages';
import { asCage, asTarget, type Model, ownCage } from '../model';
import type { Shown } from '../scene';
import type { Session } from '../session';
import { reasonOf } from '../wording';
import { type Avatar, type Entry, kMaxAvatars, nameOf } from './avatar';
import { AvatarList } from './avatar-list';
import { AvatarTransfers } from './avatar-transfers';
import type { KeptAvatar, KeptWardrobe } from './kept';
import type { Surroundings } from './surroundings';

/** The avatars that one paint is drawn for. One of them is on the stage; the others can stand beside it. */
export class Wardrobe {
  readonly list: AvatarList;
  readonly #around: Surroundings;
  readonly #session: Session;
  readonly #transfers: AvatarTransfers;
  /** The avatar that was chosen last, and its model, until something comes on the stage. */
  #chosen: { avatar: Avatar; target: Promise<Model> } | undefined;
  #showsAll = false;
  /** Cancels the fits that were asked for. */
  readonly #fits = new Map<Avatar, AbortController>();

  constructor(around: Surroundings) {
    const { session } = around;
    this.#around = around;
    this.#session = session;
    this.list = new AvatarList(around.errors.add);
    this.#transfers = new AvatarTransfers(around, this.list, () => this.#arrange());
    if (session.shown) this.#show(session.shown);
    session.on('transfer', (shown) => this.#show(shown));
    session.on('zones', () => this.#onZones());
    session.on('inspected', ({ verdict }) => {
      // Not while the page mends it by itself.
      if (!session.isMakingCage) this.list.update(this.list.active, { verdict });
    });
    session.on('rules', () => this.#onRules());
    session.on('progress', ({ state }) => {
      // With one still chosen, loading it was cancelled.
      if (state === 'failed' || (state !== 'working' && this.#chosen)) this.#onFailure();
    });
    this.#onZones();
    this.list.active.verdict = session.inspection?.verdict ?? '';
  }

  /** The avatar that is to be on the stage; undefined if another model was opened since it was chosen. */
  get #coming(): Avatar | undefined {
    return this.#chosen && this.#session.requested.target === this.#chosen.target ? this.#chosen.avatar : undefined;
  }

  /** Whether the stage shows all, side by side. */
  get showsAll(): boolean {
    return this.#showsAll;
  }

  set showsAll(shows: boolean) {
    this.#showsAll = shows;
    // One divider across all would hide more than it shows.
    if (shows && this.#session.view.mode === 'compare') this.#session.setView({ mode: 'result' });
    this.#arrange();
  }

  /**
   * Adds avatars, one after the other. Reports which of them cannot be read, or find no room.
   * @param instead What is removed once the first of them was read.
   */
  async add(entries: readonly Entry[], instead?: Avatar): Promise<void> {
    const left = entries.slice(Math.max(0, kMaxAvatars - this.list.all.length + (instead ? 1 : 0)));
    const added = entries.slice(0, entries.length - left.length).map((entry) => {
      const { name, sample, kept } = entry;
      const { follows = false, locks = {} } = kept ?? {};
      const avatar = { ...this.list.make('Waiting'), name, sample, kept, follows, locks };
      this.list.all.push(avatar);
      return { entry, avatar };
    });
    const troubles = left.length > 0 ? [fullText(left.map(({ name }) => name))] : [];
    if (left.length > 0) this.#around.errors.show(troubles[0]!);
    this.list.change();
    const given = this.#given;
    for (const { entry, avatar } of added)
      this.list.queue(avatar, async () => {
        try {
          await this.#read(avatar, entry, given);
          if (!instead) return;
          this.remove(instead);
          instead = undefined;
        } catch (error) {
          if (!this.list.has(avatar)) return;
          this.remove(avatar);
          troubles.push((error as Error).message);
          this.#around.errors.add(troubles.at(-1)!);
        }
      });
    await this.list.done;
    // What was done meanwhile has cleared it.
    if (left.length > 0) this.#around.errors.show(troubles.join('\n'));
  }

  /** What a project has of it. */
  get kept(): KeptWardrobe {
    const avatars = this.list.all.filter(({ files, kept }) => files.length > 0 || kept);
    return {
      at: avatars.indexOf(this.list.active),
      all: this.#showsAll,
      avatars: avatars
        .filter((avatar) => avatar !== this.list.active)
        .map((avatar) => avatar.kept ?? this.#keep(avatar)),
    };
  }

  #keep({ name, sample, files, cage, follows, locks }: Avatar): KeptAvatar {
    return {
      name,
      sample: sample?.name,
      files,
      cage: cage && { files: cage.files, sample: cage.sample?.name },
      follows,
      locks,
      bare: this.#session.bareOf(files),
    };
  }

  /** Puts the avatars of a project beside the one on the stage, in place of the others. @param at The place of that one. */
  restore(entries: readonly Entry[], at: number): void {
    for (const avatar of [...this.list.all]) if (avatar !== this.list.active) this.remove(avatar);
    void this.add(entries);
    this.list.all.splice(this.list.all.indexOf(this.list.active), 1);
    this.list.all.splice(at, 0, this.list.active);
    this.#arrange();
  }

  /** Takes an avatar out and frees its memory; the last one stays. */
  remove(avatar: Avatar): void {
    const at = this.list.all.indexOf(avatar);
    if (at < 0 || this.list.all.length === 1) return;
    this.list.all.splice(at, 1);
    this.#abortFits(avatar);
    if (avatar === (this.#coming ?? this.list.active)) {
      const next = this.list.all
        .slice(at)
        .concat(this.list.all)
        .find(({ files }) => files.length > 0);
      if (!next) return void this.list.all.splice(at, 0, avatar);
      // A model that was opened meanwhile takes its place.
      if (this.#coming || this.#session.keepTarget()) this.activate(next);
    }
    this.#transfers.clear(avatar);
    this.#arrange();
  }

  /** Puts an avatar on the stage. */
  activate(avatar: Avatar): void {
    if (avatar.files.length === 0 || avatar === this.#coming) return;
    // The one that is there comes anew if it would have to give way to a model that was opened since.
    if (!this.#coming && avatar === this.list.active && this.#session.keepTarget()) return;
    const { cage, sample, locks } = avatar;
    const target = this.#load(avatar).then((model) => ({ ...model, ...(sample && { sample }) }));
    this.#chosen = { avatar, target };
    this.#session.request({ target, ...(cage && { cage: Promise.resolve(cage) }) }, { ...locks }, true);
  }

  /** The colours of all have changed. */
  refresh(): void {
    if (this.#session.shown) for (const avatar of this.list.all) this.#transfers.dress(avatar);
    this.list.change();
  }

  /** Fits the cage of the model on the stage to all whose cages have other UVs. */
  fitAll(): void {
    const { cage } = this.#session.shown!;
    for (const avatar of this.list.all) if (!avatar.takesPaint && avatar.files.length > 0) this.#fitLater(avatar, cage);
  }

  /** The cage on the stage if it is the user's own. */
  get #given(): Model | undefined {
    const { cage } = this.#session.shown ?? {};
    return !cage || cage.sample || madeOf(cage.files[0]!) ? undefined : cage;
  }

  /** Another model or cage is on the stage. */
  #show({ target, cage }: Shown): void {
    const coming = this.#coming;
    const came = coming && target.files[0] === coming.files[0] ? coming : undefined;
    this.#chosen = undefined;
    const left = this.list.active;
    if (came) this.list.active = came;
    this.#enlist();
    const active = this.list.active;
    if (target.files[0] !== active.files[0]) {
      this.#abortFits(active);
      this.#transfers.clear(active);
      const name = target.sample?.title ?? nameOf(target.name);
      Object.assign(active, { name, files: target.files, sample: target.sample, follows: false });
    }
    const isOther = cage !== active.cage;
    if (isOther && active.standing) this.#transfers.clear(active);
    if (isOther) Object.assign(active, { cage, verdict: '' });
    // A cage that was chosen there stays.
    if (isOther && !came) this.#abortFits(active);
    if (came && left !== came && this.list.has(left)) this.#stand(left);
    const given = this.#given;
    for (const avatar of this.list.all) {
      this.#transfers.dress(avatar);
      if (avatar === active || avatar.takesPaint || !given || avatar.files.length === 0) continue;
      // A garment that waits for a cage gets it; one fitted to this model's last cage follows it.
      const lacks = !avatar.cage && (!came || avatar.doing === '');
      if (lacks || (!came && isOther && avatar.follows)) this.#fitLater(avatar, given);
    }
    this.#arrange();
    this.refresh();
  }

  /** What was to be on the stage is not there: the one that is stays. */
  #onFailure(): void {
    this.#chosen = undefined;
    this.#enlist();
    this.#arrange();
  }

  /** Takes what is on the stage into the list again, if it was removed and nothing came in its place. */
  #enlist(): void {
    if (!this.list.has(this.list.active)) this.list.all.unshift(this.list.active);
  }

  /** Makes an avatar that was on the stage stand beside it. */
  #stand(avatar: Avatar): void {
    if (avatar.standing) {
      this.#transfers.update(avatar);
      return;
    }
    this.list.queue(avatar, async () => {
      if (avatar === this.list.active || avatar.standing) return;
      await this.#transfers.transfer(avatar, await this.#load(avatar));
    });
  }

  #load({ files: [file, ...rest] }: Avatar): Promise<Model> {
    return this.#around.loader.load(file!, rest);
  }

  /** Reads a new avatar and its cage. @param given A cage that is fitted to it if it has none. Default: one is chosen. */
  async #read(avatar: Avatar, { target, cage }: Entry, given: Model | undefined): Promise<void> {
    this.list.update(avatar, { doing: 'Reading' });
    const model = asTarget(await target());
    if (!this.list.has(avatar)) return this.#around.loader.dispose(model);
    try {
      avatar.cage = cage ? asCage(await cage()) : ownCage(model);
      this.#session.keepBare(model, avatar.kept?.bare ?? this.#session.bareOf(model.files));
      avatar.files = model.files;
      avatar.kept = undefined;
    } catch (error) {
      this.#around.loader.dispose(model);
      throw error;
    }
    if (!avatar.cage) await this.#fit(avatar, model, given, this.#signalOf(avatar));
    await this.#transfers.transfer(avatar, model);
  }

  /** What cancels the fits to an avatar. */
  #signalOf(avatar: Avatar): AbortSignal {
    const abort = this.#fits.get(avatar) ?? new AbortController();
    this.#fits.set(avatar, abort);
    return abort.signal;
  }

  #abortFits(avatar: Avatar): void {
    this.#fits.get(avatar)?.abort();
    this.#fits.delete(avatar);
  }

  #fitLater(avatar: Avatar, cage: Model | undefined): void {
    const signal = this.#signalOf(avatar);
    this.list.update(avatar, { doing: 'Waiting' });
    this.list.queue(avatar, async () => {
      if (signal.aborted) return;
      const model = await this.#load(avatar);
      await this.#fit(avatar, model, cage, signal);
      if (avatar === this.list.active) return this.#around.loader.dispose(model);
      this.#transfers.clear(avatar);
      await this.#transfers.transfer(avatar, model);
    });
  }

  /** Gives an avatar a cage: one that is fitted to it, or that is chosen for it. If that is not possible it stays without. */
  async #fit(avatar: Avatar, model: Model, cage: Model | undefined, signal: AbortSignal): Promise<void> {
    const onProgress = (share: number): void =>
      this.list.update(avatar, { doing: `Fitting ${Math.round(100 * share)} %` });
    const { fit, choose, loader } = this.#around;
    const progress = { signal, onProgress };
    try {
      onProgress(0);
      const fitted = cage ? await loader.load(await fit(cage, model, progress)) : await choose(model, progress);
      if (signal.aborted) return;
      if (avatar === this.list.active && this.#session.isMakingCage) {
        // The one that is being made was asked for since. If it does not come, this is fitted again.
        const end = this.#session.on('progress', ({ state }) => {
          if (state === 'working') return;
          end();
          if (!signal.aborted) this.#fitLater(avatar, cage);
        });
        return;
      }
      Object.assign(avatar, { cage: fitted, follows: cage !== undefined, verdict: '' });
      if (avatar === this.#coming || (avatar === this.list.active && this.#session.keepTarget()))
        this.#session.request({ cage: Promise.resolve(fitted) });
    } catch (error) {
      if (signal.aborted) return;
      this.#around.errors.add(`${avatar.name}: ${reasonOf(error)}`);
    }
  }

  #onZones(): void {
    const { classification, locks } = this.#session;
    if (!classification) return;
    this.list.active.locks = { ...locks };
  }

  #onRules(): void {
    for (const avatar of this.list.all) if (avatar !== this.list.active) this.#transfers.update(avatar);
  }

  #arrange(): void {
    this.list.change();
    const { all, active } = this.list;
    const isAlone = !this.#showsAll || !this.#session.shown || all.length < 2;
    const figures = all.flatMap((avatar) => (avatar === active ? [undefined] : (avatar.standing ?? [])));
    this.#around.view.arrange(isAlone ? undefined : figures);
  }
}

const fullText = (names: readonly string[]): string =>
  `The wardrobe is full: it holds ${kMaxAvatars} avatars, and ${new Intl.ListFormat('en').format(
    names.length > 3 ? [...names.slice(0, 2), `${names.length - 2} more`] : names,
  )} found no room. Remove one first.`;
