import { classify } from 'cagecast';
import { Emitter } from 'cagecast/three/layers';
import { Group, type Texture } from 'three';
import { paintableShare } from '../panels/stage-verdict';
import { showError } from '../platform/page';
import { disposeModel, loadModel, type Model } from '../scene/load-model';
import { haveSameUvs } from '../scene/same-uvs';
import { choicesOf, type Session, type Shown } from '../scene/session';
import { TransferClient } from '../scene/transfer-client';
import { reasonOf } from '../scene/wording';
import { frontOf } from '../view/framing';
import { type Look, Overlay } from '../view/overlay/overlay';
import { pick } from '../view/pick';
import type { Viewer } from '../view/viewer';
import { type Avatar, type Entry, kMostAvatars, nameOf } from './avatar';
import { fitLike } from './fit-like';
import type { KeptAvatar, KeptWardrobe } from './kept';
import type { Surroundings } from './set-up-wardrobe';
import { measure, SideBySide } from './side-by-side';
import { drawThumbnails } from './thumbnails';

const kPictureDelay = 1500; // milliseconds without a change before pictures are drawn again
const kPicture = 128; // pixels per side
const kMostInspected = 60_000; // triangles; the time grows with their number

/** The avatars that one paint is drawn for. One of them is on the stage; the others can stand beside it. */
export class Wardrobe extends Emitter<{ change: undefined }> {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #paint: Texture;
  readonly #crowd = new SideBySide();
  readonly #client = new TransferClient();
  readonly #avatars: Avatar[] = [];
  #active: Avatar;
  /** The one that is to be on the stage. */
  #wanted: Avatar | undefined;
  /** Resolves once it is there, or cannot be. */
  #arrival: Promise<void> | undefined;
  #arrived: () => void = () => {};
  #showsAll = false;
  /** What is to be done, one after the other. */
  #work: Promise<void> = Promise.resolve();
  /** Cancels the fits that were asked for. */
  readonly #fits = new Map<Avatar, AbortController>();
  readonly #outdated = new Set<Avatar>();
  #picturing: ReturnType<typeof setTimeout> | undefined;
  #ids = 0;

  constructor({ session, viewer, paint, stack }: Surroundings) {
    super();
    this.#session = session;
    this.#viewer = viewer;
    this.#paint = paint;
    this.#active = this.#make('');
    this.#avatars.push(this.#active);
    if (session.shown) this.#show(session.shown);
    session.on('transfer', (shown) => this.#show(shown));
    session.on('zones', () => this.#onZones());
    session.on('inspected', ({ verdict }) => this.#tell(this.#active, { verdict }));
    session.on('rules', () => this.#onRules());
    stack.on('change', () => this.#pictureLater(this.#avatars));
    stack.on('pictures', () => this.#pictureLater(this.#avatars));
    session.on('progress', ({ state }) => {
      // With something still wanted, loading it was cancelled.
      if (state === 'failed' || (state !== 'working' && this.#wanted)) this.#onFailure();
    });
    this.#onZones();
    this.#active.verdict = session.inspection?.verdict ?? '';
  }

  get avatars(): readonly Avatar[] {
    return this.#avatars;
  }

  /** The one on the stage. */
  get active(): Avatar {
    return this.#active;
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
   * Adds avatars, one after the other. Tells which of them cannot be read, or find no room.
   * @param instead What is removed once the first of them was read.
   */
  async add(entries: readonly Entry[], instead?: Avatar): Promise<void> {
    const left = entries.slice(Math.max(0, kMostAvatars - this.#avatars.length + (instead ? 1 : 0)));
    const added = entries.slice(0, entries.length - left.length).map((entry) => {
      const { name, sample, kept } = entry;
      const { follows = false, locks = {} } = kept ?? {};
      const avatar = { ...this.#make('Waiting'), name, sample, kept, follows, locks };
      this.#avatars.push(avatar);
      return { entry, avatar };
    });
    const troubles = left.length > 0 ? [fullText(left.map(({ name }) => name))] : [];
    if (left.length > 0) showError(troubles[0]!);
    this.#change();
    let common = instead ? undefined : this.#common;
    for (const { entry, avatar } of added)
      this.#queue(avatar, async () => {
        try {
          await this.#read(avatar, entry, common);
          if (!instead) return;
          this.remove(instead);
          instead = undefined;
          await this.#arrival;
          common = this.#common;
        } catch (error) {
          if (!this.#avatars.includes(avatar)) return;
          this.remove(avatar);
          troubles.push((error as Error).message);
          showError(troubles.join(' '));
        }
      });
    await this.#work;
    // What was done meanwhile has cleared it.
    if (left.length > 0) showError(troubles.join(' '));
  }

  /** What a project has of it. */
  get kept(): KeptWardrobe {
    const avatars = this.#avatars.filter(({ files, kept }) => files.length > 0 || kept);
    return {
      at: avatars.indexOf(this.#active),
      all: this.#showsAll,
      avatars: avatars.filter((avatar) => avatar !== this.#active).map((avatar) => avatar.kept ?? this.#keep(avatar)),
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
    for (const avatar of [...this.#avatars]) if (avatar !== this.#active) this.remove(avatar);
    void this.add(entries);
    this.#avatars.splice(this.#avatars.indexOf(this.#active), 1);
    this.#avatars.splice(at, 0, this.#active);
    this.#arrange();
  }

  /** Takes an avatar out and frees its memory; the last one stays. */
  remove(avatar: Avatar): void {
    const at = this.#avatars.indexOf(avatar);
    if (at < 0 || this.#avatars.length === 1) return;
    this.#avatars.splice(at, 1);
    this.#giveUpFits(avatar);
    if (avatar === (this.#wanted ?? this.#active)) {
      const next = this.#avatars
        .slice(at)
        .concat(this.#avatars)
        .find(({ files }) => files.length > 0);
      if (!next) return void this.#avatars.splice(at, 0, avatar);
      this.activate(next);
    }
    this.#clear(avatar);
    this.#arrange();
  }

  /** Puts an avatar on the stage. */
  activate(avatar: Avatar): void {
    if (avatar === (this.#wanted ?? this.#active) || avatar.files.length === 0) return;
    this.#wanted = avatar;
    this.#arrived();
    this.#arrival = new Promise((done) => (this.#arrived = done));
    const { files, cage, sample, locks } = avatar;
    const [file, ...rest] = files;
    const target = loadModel(file!, this.#viewer.renderer, rest).then((model) => ({
      ...model,
      ...(sample && { sample }),
    }));
    this.#session.want({ target, ...(cage && { cage: Promise.resolve(cage) }) }, { ...locks }, true);
  }

  /** The avatar beside the one on the stage that is at a position of the view. @param x,y Client coordinates. */
  at(x: number, y: number): Avatar | undefined {
    if (!this.#showsAll) return undefined;
    const ray = this.#viewer.screen.eyeRay(x, y);
    const far = (mesh: Model['mesh']): number => pick(mesh, ray)?.seen.distanceTo(ray.ray.origin) ?? Infinity;
    let [found, nearest]: [Avatar | undefined, number] = [undefined, far(this.#session.shown!.target.mesh)];
    for (const avatar of this.#avatars) {
      const distance = avatar !== this.#active && avatar.standing ? far(avatar.standing.model.mesh) : Infinity;
      if (distance < nearest) [found, nearest] = [avatar, distance];
    }
    return found;
  }

  /** Fits the cage of the model on the stage to all whose cages have other UVs. */
  fitAll(): void {
    const { cage } = this.#session.shown!;
    for (const avatar of this.#avatars) if (!avatar.takesPaint && avatar.files.length > 0) this.#fitLater(avatar, cage);
  }

  /** The cage that avatars without one get; undefined if the one on the stage belongs to another model. */
  get #common(): Model | undefined {
    const { cage, target } = this.#session.shown ?? {};
    return cage?.sample && cage.sample !== target?.sample ? undefined : cage;
  }

  #make(doing: string): Avatar {
    return {
      id: ++this.#ids,
      name: '',
      sample: undefined,
      files: [],
      cage: undefined,
      follows: false,
      locks: {},
      picture: '',
      verdict: '',
      paintable: undefined,
      takesPaint: false,
      doing,
      kept: undefined,
      standing: undefined,
    };
  }

  /** Does something once all that was asked for before is done, if the avatar is still here then. */
  #queue(avatar: Avatar, work: () => Promise<void>): void {
    this.#work = this.#work.then(async () => {
      if (!this.#avatars.includes(avatar)) return;
      try {
        await work();
      } catch (error) {
        if (this.#avatars.includes(avatar)) showError((error as Error).message);
      } finally {
        this.#tell(avatar, { doing: '' });
      }
    });
  }

  #tell(avatar: Avatar, change: Partial<Avatar>): void {
    Object.assign(avatar, change);
    this.#change();
  }

  #change(): void {
    this.emit('change', undefined);
  }

  /** Another model or cage is on the stage. */
  #show({ target, cage }: Shown): void {
    const wanted = this.#wanted;
    const came = wanted && target.files[0] === wanted.files[0] ? wanted : undefined;
    this.#wanted = undefined;
    this.#arrived();
    const left = this.#active;
    if (came) this.#active = came;
    this.#enlist();
    const active = this.#active;
    if (target.files[0] !== active.files[0]) {
      this.#giveUpFits(active);
      this.#clear(active);
      const name = target.sample?.title ?? nameOf(target.name);
      Object.assign(active, { name, files: target.files, sample: target.sample, picture: '', follows: false });
    }
    const isOther = cage !== active.cage;
    if (isOther && active.standing) this.#clear(active);
    if (isOther) Object.assign(active, { cage, verdict: '' });
    // A cage that was chosen there stays.
    if (isOther && !came) this.#giveUpFits(active);
    if (came && left !== came && this.#avatars.includes(left)) this.#stand(left);
    const common = this.#common;
    for (const avatar of this.#avatars) {
      avatar.takesPaint = avatar.cage !== undefined && haveSameUvs(avatar.cage, cage);
      if (avatar.standing) avatar.standing.takesPaint = avatar.takesPaint;
      if (avatar === active || avatar.takesPaint || !common || avatar.files.length === 0) continue;
      // What waits for a cage gets the one that it waits for; what was fitted to the last cage of this model follows it.
      const lacks = !avatar.cage && (!came || avatar.doing === '');
      if (lacks || (!came && isOther && avatar.follows)) this.#fitLater(avatar, common);
    }
    this.#arrange();
    this.#pictureLater(this.#avatars);
  }

  /** What was to be on the stage is not there: the one that is stays. */
  #onFailure(): void {
    this.#wanted = undefined;
    this.#arrived();
    this.#enlist();
    this.#arrange();
  }

  /** Takes what is on the stage into the list again, if it was removed and nothing came in its place. */
  #enlist(): void {
    if (!this.#avatars.includes(this.#active)) this.#avatars.unshift(this.#active);
  }

  /** Makes an avatar that was on the stage stand beside it. */
  #stand(avatar: Avatar): void {
    if (avatar.standing) {
      this.#update(avatar);
      return;
    }
    this.#queue(avatar, async () => {
      if (avatar === this.#active || avatar.standing) return;
      await this.#place(avatar, await this.#load(avatar));
    });
  }

  #load({ files: [file, ...rest] }: Avatar): Promise<Model> {
    return loadModel(file!, this.#viewer.renderer, rest);
  }

  /** Reads a new avatar and its cage. @param common A cage that is fitted to it if it has none. */
  async #read(avatar: Avatar, { target, cage }: Entry, common: Model | undefined): Promise<void> {
    this.#tell(avatar, { doing: 'Reading' });
    const model = await target();
    if (!this.#avatars.includes(avatar)) return disposeModel(model);
    try {
      avatar.cage = await cage?.();
      this.#session.keepBare(model, avatar.kept?.bare ?? this.#session.bareOf(model.files));
      avatar.files = model.files;
      avatar.kept = undefined;
    } catch (error) {
      disposeModel(model);
      throw error;
    }
    if (!avatar.cage && common) await this.#fit(avatar, model, common, this.#signalOf(avatar));
    await this.#place(avatar, model);
  }

  /** What cancels the fits to an avatar. */
  #signalOf(avatar: Avatar): AbortSignal {
    const abort = this.#fits.get(avatar) ?? new AbortController();
    this.#fits.set(avatar, abort);
    return abort.signal;
  }

  #giveUpFits(avatar: Avatar): void {
    this.#fits.get(avatar)?.abort();
    this.#fits.delete(avatar);
  }

  #fitLater(avatar: Avatar, cage: Model): void {
    const signal = this.#signalOf(avatar);
    this.#tell(avatar, { doing: 'Waiting' });
    this.#queue(avatar, async () => {
      if (signal.aborted) return;
      const model = await this.#load(avatar);
      await this.#fit(avatar, model, cage, signal);
      if (avatar === this.#active) return disposeModel(model);
      this.#clear(avatar);
      await this.#place(avatar, model);
    });
  }

  /** Fits a cage to an avatar. If that is not possible the avatar stays without. */
  async #fit(avatar: Avatar, model: Model, cage: Model, signal: AbortSignal): Promise<void> {
    const onProgress = (share: number): void => this.#tell(avatar, { doing: `Fitting ${Math.round(100 * share)} %` });
    try {
      onProgress(0);
      const file = await fitLike(cage, model, { signal, onProgress });
      const fitted = await loadModel(file, this.#viewer.renderer);
      if (signal.aborted) return;
      Object.assign(avatar, { cage: fitted, follows: true, verdict: '' });
      if (avatar === (this.#wanted ?? this.#active)) this.#session.want({ cage: Promise.resolve(fitted) });
    } catch (error) {
      if (signal.aborted) return;
      showError(`${avatar.name}: ${reasonOf(error)}`);
    }
  }

  /** Transfers the paint to an avatar, and lets it stand beside the one on the stage. */
  async #place(avatar: Avatar, model: Model): Promise<void> {
    if (!this.#avatars.includes(avatar)) return disposeModel(model);
    const { cage } = avatar;
    const { preset } = this.#session.rules;
    this.#tell(avatar, { doing: 'Painting' });
    const projection = cage && (await this.#client.ask('project', cage, model, { preset }));
    if (!this.#avatars.includes(avatar)) return disposeModel(model);
    const { scale, middle, wide, high } = measure(model);
    const [holder, inner] = [new Group(), new Group()];
    inner.position.copy(middle).negate();
    inner.add(model.scene);
    holder.add(inner);
    holder.scale.setScalar(scale);
    const overlay = projection && new Overlay(model.mesh, projection, this.#paint);
    avatar.takesPaint = cage !== undefined && haveSameUvs(cage, this.#session.shown!.cage);
    avatar.standing = { holder, overlay, model, projection, wide, high, takesPaint: avatar.takesPaint };
    this.#update(avatar);
    this.#arrange();
    this.#pictureLater([avatar]);
    await this.#inspect(avatar);
  }

  async #inspect(avatar: Avatar): Promise<void> {
    const { standing, cage, locks } = avatar;
    if (!standing || !cage || standing.model.mesh.indices.length + cage.mesh.indices.length > 3 * kMostInspected)
      return;
    const { preset, threshold } = this.#session.rules;
    const options = {
      preset,
      threshold,
      locks: choicesOf(locks, undefined).locks,
      parts: standing.model.mesh.primitives,
    };
    const parts = options.parts.map(({ name, firstVertex, vertexCount }) => ({ name, firstVertex, vertexCount }));
    const { verdict } = await this.#client.ask('inspect', cage, standing.model, { ...options, parts });
    this.#tell(avatar, { verdict });
  }

  #classify(avatar: Avatar): void {
    const { standing, locks, files } = avatar;
    if (!standing?.projection) return;
    const { threshold } = this.#session.rules;
    const choices = choicesOf(locks, standing.projection, this.#session.bareOf(files));
    const classification = classify(standing.projection, { threshold, ...choices });
    standing.overlay?.classify(classification);
    avatar.paintable = paintableShare(classification.segmentStats);
    this.#viewer.redraw();
  }

  #onZones(): void {
    const { classification, locks } = this.#session;
    if (!classification) return;
    this.#active.locks = { ...locks };
    this.#tell(this.#active, { paintable: paintableShare(classification.segmentStats) });
    this.#pictureLater([this.#active]);
  }

  #onRules(): void {
    for (const avatar of this.#avatars) if (avatar !== this.#active) this.#update(avatar);
  }

  /** Makes what stands beside the stage follow the rules: the threshold at once, another preset by another transfer. */
  #update(avatar: Avatar): void {
    const isOutdated = (): boolean => {
      const { projection } = avatar.standing ?? {};
      return projection !== undefined && projection.preset !== this.#session.rules.preset;
    };
    this.#classify(avatar);
    if (!isOutdated()) return;
    this.#queue(avatar, async () => {
      const { cage, standing } = avatar;
      if (!cage || !standing || avatar === this.#active || !isOutdated()) return;
      const { preset } = this.#session.rules;
      const projection = await this.#client.ask('project', cage, standing.model, { preset });
      if (avatar.standing !== standing) return;
      standing.projection = projection;
      standing.overlay?.setProjection(projection);
      this.#update(avatar);
    });
  }

  /** Frees what stands beside the stage. */
  #clear(avatar: Avatar): void {
    const { standing } = avatar;
    if (!standing) return;
    avatar.standing = undefined;
    standing.holder.removeFromParent();
    standing.overlay?.dispose();
    disposeModel(standing.model);
  }

  /** Shows who is to be seen. */
  #arrange(): void {
    const { shown } = this.#session;
    this.#change();
    if (!this.#showsAll || !shown || this.#avatars.length < 2) {
      this.#viewer.setCrowd(undefined);
      return;
    }
    const front = frontOf(shown.target);
    const cells = this.#avatars.flatMap((avatar) => {
      if (avatar === this.#active) return [undefined];
      if (!avatar.standing) return [];
      avatar.standing.holder.rotation.y = front - frontOf(avatar.standing.model);
      return [avatar.standing];
    });
    this.#crowd.set(cells, measure(shown.target));
    this.#viewer.setCrowd(this.#crowd);
  }

  /** Draws the pictures of some avatars again, once nothing has changed for a while. */
  #pictureLater(avatars: readonly Avatar[]): void {
    for (const avatar of avatars) this.#outdated.add(avatar);
    const isNew = [...this.#outdated].some(({ picture }) => picture === '');
    clearTimeout(this.#picturing);
    this.#picturing = setTimeout(() => this.#takePictures(), isNew ? 0 : kPictureDelay);
  }

  #takePictures(): void {
    const { shown, classification } = this.#session;
    if (!shown || !classification) return; // the zones bring it up again
    const subjects = [...this.#outdated].flatMap((avatar) => {
      const { standing, takesPaint } = avatar;
      const look: Look = takesPaint ? 'result' : 'bare';
      const { holder, overlay } = standing ?? {};
      if (avatar === this.#active)
        return [{ avatar, holder: undefined, overlay: undefined, front: frontOf(shown.target), look }];
      return standing ? [{ avatar, holder, overlay, front: frontOf(standing.model), look }] : [];
    });
    this.#outdated.clear();
    if (subjects.length === 0) return;
    const pictures = drawThumbnails(this.#viewer, subjects, kPicture);
    subjects.forEach(({ avatar }, index) => (avatar.picture = pictures[index]!));
    this.#arrange(); // they were turned for the pictures
  }
}

const fullText = (names: readonly string[]): string =>
  `The wardrobe is full: it holds ${kMostAvatars} avatars, and ${new Intl.ListFormat('en').format(
    names.length > 3 ? [...names.slice(0, 2), `${names.length - 2} more`] : names,
  )} found no room. Remove one first.`;
