import { CagecastError, type Classification, classify, type Inspection, init, type Projection } from 'cagecast';
import {
  BareMarks,
  bareGroupsOf,
  type Choice,
  type Choices,
  choicesOf,
  kFirstRules,
  knownLocks,
  type Locks,
  type Rules,
} from './choices';
import { choose, isUpToDate, leavingOut, leftOutBy, moveChoices, projectBy } from './left-out';
import type { Model } from './model';
import { Pace } from './pace';
import type { Paint } from './paint';
import { Replay } from './replay';
import { Requests } from './requests';
import { haveSameUvs } from './same-uvs';
import { kSlots, type Requested, type Scene, type Shown } from './scene';
import { type SplitProjection, Superseded, type Transferer } from './transfers';
import { kFirstView, type View } from './view-state';

/** A feature's work on the current scene. */
interface Work {
  /** Called if it is cancelled by the user, or superseded by a newer request. */
  abort: (why: 'cancelled' | 'superseded') => void;
  /** Whether it makes a cage. */
  makesCage?: boolean;
}

/** The stage in which files are read. */
export const kReading = 'Reading';

/** State of the latest request. */
export type Progress =
  /** `share` of the work is done (0..1); `stage` names the current step. */
  | { state: 'working'; stage: string; share: number }
  | { state: 'ready' }
  /** Files are missing. */
  | { state: 'waiting'; missing: ('target' | 'cage')[] }
  | { state: 'failed'; error: Error };

/** Events, in the order in which they occur when a model is opened. */
interface SessionEvents {
  progress: Progress;
  /** What was being done is cancelled by the user. `progress` follows at once. */
  cancel: undefined;
  /** Another target is about to take the place of this one: all is still as it was. */
  leave: Shown;
  /** Another target, cage or projection is shown. `zones` follows at once, then `paint` if it changed. */
  transfer: Shown;
  /** The model moved and has a new projection. `zones` follows at once. */
  frame: SplitProjection;
  /** The zones were computed, after a transfer or a change of threshold or locks. `spent` is in milliseconds. */
  zones: { classification: Classification; spent: number };
  /** The cage that is shown was inspected. */
  inspected: Inspection;
  /** The paint changed; after `transfer` if both did. */
  paint: Paint;
  rules: Rules;
  view: View;
}

/**
 * The state of the page: the scene, its transfer, the options and the view. Features change it by its methods and follow it
 * by its events; they do not know each other.
 */
export class Session extends Replay<SessionEvents> {
  /** The paint of models without a paint of their own. */
  readonly checker: Paint;
  /** Gives the paint of a cage that is requested without one; undefined for the one that there is. */
  paintFor: ((cage: Promise<Model>) => Promise<Paint> | undefined) | undefined;
  readonly #transferer: Transferer;
  readonly #requests = new Requests(() => this.#shown);
  #shown: Shown | undefined;
  #classification: Classification | undefined;
  #inspection: Inspection | undefined;
  #rules = kFirstRules;
  #locks: Locks = {};
  readonly #bare = new BareMarks();
  #view = kFirstView;
  #runs = 0;
  #working = false;
  /** A feature's work on the current scene. */
  #work: Work | undefined;
  #moved = false;
  /** The paint of the latest `paint` event. */
  #painted: Paint | undefined;

  constructor(transferer: Transferer, checker: Paint) {
    super('transfer');
    this.checker = checker;
    this.#transferer = transferer;
  }

  /** The current scene; undefined before the first transfer. */
  get shown(): Shown | undefined {
    return this.#shown;
  }

  /** The zones of the current scene. */
  get classification(): Classification | undefined {
    return this.#classification;
  }

  get rules(): Readonly<Rules> {
    return this.#rules;
  }

  get locks(): Readonly<Locks> {
    return this.#locks;
  }

  get view(): Readonly<View> {
    return this.#view;
  }

  protected override emit<Name extends keyof SessionEvents>(name: Name, event: SessionEvents[Name]): boolean {
    if (name === 'progress') this.#working = (event as Progress).state === 'working';
    return super.emit(name, event);
  }

  /** Whether anything was requested yet. */
  get begun(): boolean {
    return this.#runs > 0;
  }

  /** The files of the scene that is shown or being loaded, by slot. */
  get requested(): Readonly<Requested> {
    return this.#requests.files;
  }

  /**
   * Requests other files; supersedes a request in progress. Without a paint the checker is used.
   * @param locks    Locks of the new target; those of segments it does not have are ignored.
   * @param together Whether all files are dropped if one of them fails. Otherwise the others wait for a replacement.
   */
  request(change: Requested, locks: Locks = {}, together = false): void {
    if (!change.target && !change.cage) this.#abortRest();
    const { cage, paint = cage && this.paintFor?.(cage) } = change;
    const { paint: before = Promise.resolve(this.checker) } = this.requested;
    this.#requests.add({ ...change, paint: paint ?? before }, locks, together);
    void this.#run();
  }

  /**
   * Keeps the current target, for a cage that was made for it and is requested next. One that waits for another cage is dropped.
   * @returns false if another target is being loaded: the cage is not for that one.
   */
  keepTarget(): boolean {
    if (!this.#working) this.#requests.abort('target');
    return !this.#requests.isOtherTarget;
  }

  /** Whether something is being loaded or made that takes the place of what is shown. */
  get isReplacing(): boolean {
    return this.#working && (!this.#work || this.#work.makesCage === true);
  }

  /** Whether another target is being loaded. */
  get isLeaving(): boolean {
    return this.#working && this.#requests.isOtherTarget;
  }

  /** Whether a cage is being made for the current target. */
  get isMakingCage(): boolean {
    return this.#working && this.#work?.makesCage === true;
  }

  /** Exchanges target and cage. */
  swap(): void {
    const { target, cage } = this.requested;
    if (target && cage) this.request({ target: cage, cage: target });
  }

  /** Changes options. A threshold takes effect at once, others with the next transfer, which waits for a cage that is being made. */
  setRules(change: Partial<Rules>): void {
    const before = this.#rules;
    this.#rules = { ...before, ...change };
    this.emit('rules', this.#rules);
    if (this.#rules.preset !== before.preset || this.#rules.weldTolerance !== before.weldTolerance) this.#repeat();
    else if (this.#shown) this.#classify();
  }

  /** Locks segments; takes effect at once. What is left out, or comes back, needs another transfer. */
  lock(segments: readonly number[], lock: Choice): void {
    this.setLocks(choose(this.#locks, segments, lock, this.#shown?.projection.segmentStats ?? []));
  }

  /** Sets the locks of all segments, as `lock`. */
  setLocks(locks: Locks): void {
    const before = this.#locks;
    this.#locks = { ...locks };
    if (!this.#shown) return;
    const { projection } = this.#shown;
    const outBefore = String(leftOutBy(before, projection));
    this.#classify();
    if (String(leftOutBy(this.#locks, projection)) !== outBefore) this.#repeat();
  }

  /** Transfers again, by other rules. */
  #repeat(): void {
    this.#abortRest();
    // Before the first request there is nothing to repeat.
    if (this.begun && !this.isMakingCage) void this.#run();
  }

  /** 1 for each triangle of the shown target that the user marked to stay bare; undefined if there are none. */
  get bare(): Uint8Array | undefined {
    return this.#shown && this.bareOf(this.#shown.target.files);
  }

  /** The same of another model. @param files Its files. */
  bareOf(files: readonly File[]): Uint8Array | undefined {
    return this.#bare.of(files);
  }

  /** Sets which triangles of the shown target stay bare; takes effect at once. */
  setBare(marks: Uint8Array | undefined): void {
    if (this.#shown) this.keepBare(this.#shown.target, marks);
  }

  /** Sets the same of any model; marks for another number of triangles are ignored. */
  keepBare(model: Model, marks: Uint8Array | undefined): void {
    if (this.#bare.set(model, marks) && model.files[0] === this.#shown?.target.files[0]) this.#classify();
  }

  /** Whether the target is deformed. */
  get moved(): boolean {
    return this.#moved;
  }

  /** Shows the same target and cage with other positions. @param moved Whether the target is deformed. */
  showFrame(projection: SplitProjection, moved: boolean): void {
    if (!this.#shown) return;
    this.#moved = moved;
    this.#shown = { ...this.#shown, projection };
    this.emit('frame', projection);
    this.#classify();
  }

  /** What the choices come to. */
  get choices(): Choices {
    return choicesOf(this.#locks, bareGroupsOf(this.#shown), this.#shown?.projection, this.bare);
  }

  /** Changes the view. */
  setView(change: Partial<View>): void {
    this.#view = { ...this.#view, ...change };
    this.emit('view', this.#view);
  }

  /** Says that a paint is added, without superseding work in progress. */
  reportPaint(paint: Paint): void {
    this.emit('paint', paint);
  }

  /** Says what an inspection of the cage that is shown has found. */
  reportInspection(inspection: Inspection): void {
    this.#inspection = inspection;
    this.emit('inspected', inspection);
  }

  /** What the last inspection of target and cage that are shown has found, if there was one. */
  get inspection(): Inspection | undefined {
    return this.#inspection;
  }

  /** Reports an error; the current scene stays. */
  fail(error: unknown): void {
    if (this.isMakingCage) this.#abortRules();
    this.emit('progress', { state: 'failed', error: error instanceof Error ? error : new Error(String(error)) });
  }

  /** Cancels the work in progress; the current scene stays. Too late once the result is being applied. */
  cancel(): void {
    if (!this.#working) return;
    this.#runs++;
    this.#transferer.cancel();
    this.#endWork('cancelled');
    this.#requests.abort(...kSlots);
    this.#abortRules();
    this.emit('cancel', undefined);
    this.emit('progress', this.#shown ? { state: 'ready' } : { state: 'waiting', missing: ['target', 'cage'] });
  }

  /** Names the work on the requested files, and its progress: 0..1. */
  reportLoading(stage: string, share: number): void {
    if (this.#working && !this.#work) this.#report(stage, 0.3 * share);
  }

  /**
   * Announces a feature's work on the current scene. Called again with the same work, it says how far that is.
   * @returns A function to call when the work is done.
   */
  work(stage: string, share: number, work: Work): () => void {
    if (this.#work !== work) this.#endWork('superseded');
    this.#work = work;
    this.#report(stage, share);
    return () => {
      if (this.#work !== work) return;
      this.#work = undefined;
      if (work.makesCage && !this.#isUpToDate) void this.#run();
      else this.emit('progress', { state: 'ready' });
    };
  }

  get #isUpToDate(): boolean {
    return this.#shown !== undefined && isUpToDate(this.#shown.projection, this.#rules, this.#locks);
  }

  #endWork(why: Parameters<Work['abort']>[0]): void {
    const work = this.#work;
    this.#work = undefined;
    work?.abort(why);
  }

  #report(stage: string, share: number): void {
    this.emit('progress', { state: 'working', stage, share });
  }

  async #run(): Promise<void> {
    const run = ++this.#runs;
    const superseded = (): boolean => run !== this.#runs;
    this.#endWork('superseded');
    this.#report(kReading, 0);
    this.#transferer.cancel();
    try {
      const scene = await this.#requests.read(superseded);
      if (superseded()) return;
      if (!scene) return void this.emit('progress', { state: 'waiting', missing: this.#requests.missing });
      const before = this.#shown;
      // A sample's paint does not fit another cage's UVs: show the checker instead.
      const stays = before?.paint === scene.paint && haveSameUvs(before.cage, scene.cage);
      if (scene.paint.sample && scene.paint.sample !== scene.cage.sample && !stays) scene.paint = this.checker;
      const same = scene.target === before?.target && scene.cage === before.cage && this.#isUpToDate;
      if (!same) this.#report('Transferring', 0.3);
      const pace = new Pace(); // receiving the worker's answer blocks the page too
      const projection = same ? before.projection : await this.#project(scene, superseded);
      if (superseded()) return;
      if (!same) {
        this.#report('Applying the paint', 0.9);
        await pace.rest();
        if (superseded()) return;
      }
      // Too late to cancel from here on.
      this.#working = false;
      if (before && scene.target !== before.target) this.emit('leave', before);
      this.#locks = this.#locksFor(scene, projection);
      if (scene.target !== before?.target) this.#moved = false;
      this.#shown = { ...scene, projection };
      this.#requests.settle();
      if (!same) {
        // The zones belong to the previous scene.
        this.#classification = this.#inspection = undefined;
        this.emit('transfer', this.#shown);
        await pace.rest();
        // Needed even if this run was superseded: the newer one builds on the current scene.
        if (!this.#classification) this.#classify();
        await pace.rest();
        if (superseded()) return;
      }
      if (scene.paint !== this.#painted) {
        this.#painted = scene.paint;
        this.emit('paint', scene.paint);
      }
      this.emit('progress', { state: 'ready' });
    } catch (error) {
      if (superseded() || error instanceof Superseded) return;
      this.#abortRules();
      this.fail(error);
    }
  }

  /** The locks of a scene, by the segments of its projection, which depend on target and weld tolerance. */
  #locksFor({ target }: Scene, projection: Projection): Locks {
    const { shown } = this;
    return target === shown?.target
      ? moveChoices(this.#locks, shown.projection.segments, projection.segments)
      : knownLocks(this.#requests.locks, projection);
  }

  async #project(scene: Scene, superseded: () => boolean): Promise<SplitProjection> {
    const { target, cage } = scene;
    try {
      // `classify` runs on the page, the rest in the worker: start both.
      const [projection] = await Promise.all([
        projectBy(
          this.#transferer,
          scene,
          this.#rules,
          (projection) => this.#locksFor(scene, projection),
          () => this.#report('Splitting seams', 0.7),
        ),
        init(),
      ]);
      return projection;
    } catch (error) {
      if (!(error instanceof CagecastError) || superseded()) throw error;
      const files = { target, cage };
      const both = ['target', 'cage'] as const;
      const named = both.filter((slot) => slot === error.argument);
      const blamed = named.length > 0 ? named : both;
      // Keep a model that was accepted before: the other one does not fit it, and may be replaced.
      this.#requests.abort(...blamed.filter((slot) => files[slot] !== this.#shown?.[slot]));
      const name = blamed.map((slot) => files[slot].name).join(' with ');
      throw new Error(`${name}: ${error.reason}`, { cause: error });
    }
  }

  /** Falls back to the current files where a request still waits for one that failed. */
  #abortRest(): void {
    if (this.#shown && !this.#working) this.#requests.abort(...kSlots);
  }

  /** Falls back to the rules of the current scene, and to what is left out of it. */
  #abortRules(): void {
    if (!this.#shown || this.#isUpToDate) return;
    const { preset, weldTolerance, leftOut, segmentStats } = this.#shown.projection;
    const isLeftOut = String(leftOutBy(this.#locks, { segmentStats })) === String(leftOut);
    this.#locks = leavingOut(this.#locks, leftOut, segmentStats);
    this.#rules = { ...this.#rules, preset, weldTolerance };
    this.emit('rules', this.#rules);
    if (!isLeftOut) this.#classify();
  }

  /** Computes the zones from the current threshold and locks. */
  #classify(): void {
    const started = performance.now();
    const classification = classify(this.#shown!.projection, {
      threshold: this.#rules.threshold,
      ...this.choices,
    });
    this.#classification = classification;
    this.emit('zones', { classification, spent: performance.now() - started });
  }
}
