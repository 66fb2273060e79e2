import { CagecastError, type Classification, classify, init, type Lock, type Preset, type Timings } from 'cagecast';
import type { Borders } from 'cagecast/three';
import { Emitter } from '../platform/events';
import { Pace } from '../platform/pace';
import { kFirstView, type View } from '../view/view';
import type { Model } from './load';
import { makeChecker, type Paint } from './paint';
import { Superseded, TransferClient } from './transfer-client';
import type { Placed } from './transfer-messages';

/** A target, its cage, and what to paint it with. */
export interface Scene {
  target: Model;
  cage: Model;
  paint: Paint;
}

/** A scene that was transferred. */
export interface Shown extends Scene {
  projection: Placed;
}

/** A scene while it is still being read. */
export type Wanted = { [Slot in keyof Scene]?: Promise<Scene[Slot]> };

/** The rules of the transfer. */
export interface Rules {
  preset: Preset;
  threshold: number;
  /** Whether paint ends at the target's own triangles, or these are cut where it does. */
  borders: Borders;
}

/** What the visitor said about segments of the target, by their number; nothing about all others. */
export type Locks = Record<number, Lock>;

/** Ends work under way, because the visitor said so, or something else was wanted. */
type GiveUp = (why: 'cancelled' | 'superseded') => void;

/** The stage in which files are read. */
export const kReading = 'Reading';

/** What became of the latest wish. */
export type Progress =
  /** `share` of the work is done, 0..1, and `stage` is under way. */
  | { state: 'working'; stage: string; share: number }
  | { state: 'ready' }
  /** Nothing is wrong, but there is no transfer without these. */
  | { state: 'waiting'; missing: ('target' | 'cage')[] }
  | { state: 'failed'; error: Error };

/** What happens in a session, in the order in which it does when another model is opened. */
export interface SessionEvents {
  progress: Progress;
  /** Another target, cage or projection is shown. Its zones follow at once; its paint may have changed as well. */
  transfer: Shown;
  /** What is shown has moved, and has this projection now. Its zones follow at once. */
  frame: Placed;
  /** The zones were decided: after a transfer, and for another threshold or lock. `spent` is in milliseconds. */
  zones: { classification: Classification; spent: number };
  /** What is on show was timed again, a while after it was transferred: how long that takes now that the browser has compiled it. */
  again: { timings: Timings; spent: number };
  /** The scene on show has another paint; after `transfer` if both are new. */
  paint: Paint;
  rules: Rules;
  view: View;
}

/**
 * What the page is about: the scene on show, its transfer, the rules it is made by and how it is looked at. Features change
 * it by its methods, and follow it by its events; they do not know each other.
 */
export class Session extends Emitter<SessionEvents> {
  /** What a cage is painted with that has no paint of its own. */
  readonly checker = makeChecker();
  readonly #client = new TransferClient();
  #wanted: Wanted = {};
  /** What of it is of use only together. */
  #together: Wanted = {};
  #shown: Shown | undefined;
  /** What the worker answered last. */
  #projected: Placed | undefined;
  #classification: Classification | undefined;
  #rules: Rules = { preset: 'default', threshold: 0.5, borders: 'triangle' };
  #locks: Locks = {};
  /** What is already said about the target that is wanted. */
  #wantedLocks: Locks = {};
  #view = kFirstView;
  #runs = 0;
  #working = false;
  /** Gives up what a feature does with what is on show. */
  #giveUpWork: GiveUp | undefined;
  #moved = false;
  /** The paint that was told of last. */
  #painted: Paint | undefined;

  constructor() {
    super();
    this.#client.onAgain = (timings) => this.#timeAgain(timings);
  }

  /** What is on show; undefined before the first transfer. */
  get shown(): Shown | undefined {
    return this.#shown;
  }

  /** The zones of what is on show. */
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

  protected override emit<Name extends keyof SessionEvents>(name: Name, event: SessionEvents[Name]): void {
    if (name === 'progress') this.#working = (event as Progress).state === 'working';
    super.emit(name, event);
  }

  /** Whether anything was asked for yet. */
  get begun(): boolean {
    return this.#runs > 0;
  }

  /** Which slots are filled, or being filled. */
  wants(slot: keyof Scene): boolean {
    return this.#wanted[slot] !== undefined;
  }

  /**
   * Asks for other input; whatever was under way and is replaced by it no longer counts. Without a paint the checker is taken.
   * @param locks    What is already said about segments of another target; of those that it does not have nothing.
   * @param together Whether all of it is given up where one cannot be had. Else the others wait for another in its place.
   */
  want(change: Wanted, locks: Locks = {}, together = false): void {
    if (change.target) this.#wantedLocks = locks;
    if (!change.target && !change.cage) this.#giveUpRest();
    if (together) this.#together = change;
    for (const slot of Object.values(change)) slot.catch(() => {}); // told when it is waited for
    this.#wanted = { paint: Promise.resolve(this.checker), ...this.#wanted, ...change };
    void this.#run();
  }

  /** Takes the target for the cage, and the cage for the target. */
  swap(): void {
    const { target, cage } = this.#wanted;
    if (target && cage) this.want({ target: cage, cage: target });
  }

  /** Goes by other rules. A threshold acts at once, another preset takes a transfer. */
  setRules(change: Partial<Rules>): void {
    const before = this.#rules;
    this.#rules = { ...before, ...change };
    this.emit('rules', this.#rules);
    if (this.#rules.preset !== before.preset) {
      this.#giveUpRest();
      // Before anything was asked for there is nothing to do again.
      if (this.begun) void this.#run();
    } else if (this.#shown) this.#classify();
  }

  /** Says of segments whether they are to be painted; acts at once. */
  lock(segments: readonly number[], lock: Lock): void {
    for (const segment of segments) this.#locks[segment] = lock;
    if (this.#shown) this.#classify();
  }

  /** Whether the target is on show in another shape than its file has. */
  get moved(): boolean {
    return this.#moved;
  }

  /** Shows the same target and cage as they have moved. @param projection Of where they are now. @param moved Whether the target is not at rest. */
  showFrame(projection: Placed, moved: boolean): void {
    if (!this.#shown) return;
    this.#moved = moved;
    this.#shown = { ...this.#shown, projection };
    this.emit('frame', projection);
    this.#classify();
  }

  /** Looks at the model in another way. */
  setView(change: Partial<View>): void {
    this.#view = { ...this.#view, ...change };
    this.emit('view', this.#view);
  }

  /** Tells that something went wrong; what is on show stays. */
  fail(error: unknown): void {
    this.emit('progress', { state: 'failed', error: error instanceof Error ? error : new Error(String(error)) });
  }

  /** Gives up what is under way; what is on show stays. Nothing happens once its result is being laid on the model. */
  cancel(): void {
    if (!this.#working) return;
    this.#runs++;
    this.#client.cancel();
    this.#endWork('cancelled');
    for (const slot of ['target', 'cage', 'paint'] as const) this.#giveUp(slot);
    this.#giveUpPreset();
    this.emit('progress', this.#shown ? { state: 'ready' } : { state: 'waiting', missing: ['target', 'cage'] });
  }

  /**
   * Tells of work that a feature does with what is on show.
   * @param giveUp Called if it is given up before it is over.
   * @returns What is to be called when it is over.
   */
  work(stage: string, share: number, giveUp: GiveUp): () => void {
    this.#endWork('superseded');
    this.#giveUpWork = giveUp;
    this.#tell(stage, share);
    return () => {
      if (this.#giveUpWork !== giveUp) return;
      this.#giveUpWork = undefined;
      this.emit('progress', { state: 'ready' });
    };
  }

  #endWork(why: Parameters<GiveUp>[0]): void {
    const giveUp = this.#giveUpWork;
    this.#giveUpWork = undefined;
    giveUp?.(why);
  }

  #tell(stage: string, share: number): void {
    this.emit('progress', { state: 'working', stage, share });
  }

  async #run(): Promise<void> {
    const run = ++this.#runs;
    const superseded = (): boolean => run !== this.#runs;
    this.#endWork('superseded');
    this.#tell(kReading, 0);
    this.#client.cancel();
    try {
      const scene = await this.#read(superseded);
      if (superseded()) return;
      if (!scene) {
        const missing = (['target', 'cage'] as const).filter((slot) => !this.wants(slot));
        return this.emit('progress', { state: 'waiting', missing });
      }
      const before = this.#shown;
      // A sample's paint means nothing on another cage: there the checker takes its place.
      if (scene.paint.sample && scene.paint.sample !== scene.cage.sample) scene.paint = this.checker;
      const { preset } = this.#rules;
      const same = scene.target === before?.target && scene.cage === before.cage && preset === before.projection.preset;
      if (!same) this.#tell('Transferring', 0.3);
      const pace = new Pace(); // from here on: to receive what the worker answers takes the page a while as well
      const projection = same ? before.projection : await this.#project(scene, preset, superseded);
      if (superseded()) return;
      // Segments are the target's alone: what was said about them holds for another cage and preset too.
      if (scene.target !== before?.target) {
        const known = Object.entries(this.#wantedLocks).filter(
          ([segment]) => Number(segment) < projection.segmentStats.length,
        );
        this.#locks = Object.fromEntries(known);
        this.#moved = false;
      }
      if (!same) {
        this.#tell('Laying the paint', 0.9);
        await pace.rest();
        if (superseded()) return;
      }
      // From here on it is on show: too late to give it up.
      this.#working = false;
      this.#shown = { ...scene, projection };
      if (!same) {
        // The zones of what was on show are not those of this.
        this.#classification = undefined;
        this.emit('transfer', this.#shown);
        await pace.rest();
        // Whatever superseded this goes by what is on show.
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
      this.#giveUpPreset();
      this.fail(error);
    }
  }

  /** Waits for the wanted files. One that cannot be read gives way to the one shown before it, and so do those that came together with it. */
  async #read(superseded: () => boolean): Promise<Scene | undefined> {
    const { target, cage, paint } = this.#wanted;
    const results = await Promise.allSettled([target, cage, paint]);
    const failed = results.find((result) => result.status === 'rejected');
    if (failed && !superseded()) {
      const slots = ['target', 'cage', 'paint'] as const;
      const lost = slots.filter((_, index) => results[index]!.status === 'rejected');
      const together = slots.filter((slot) => this.#wanted[slot] === this.#together[slot]);
      const isTorn = this.#shown !== undefined && lost.some((slot) => together.includes(slot));
      for (const slot of slots) if (lost.includes(slot) || (isTorn && together.includes(slot))) this.#giveUp(slot);
      throw failed.reason;
    }
    const [t, c, p] = results.map((result) => (result.status === 'fulfilled' ? result.value : undefined)) as [
      Model?,
      Model?,
      Paint?,
    ];
    return t && c && p ? { target: t, cage: c, paint: p } : undefined;
  }

  async #project({ target, cage }: Scene, preset: Preset, superseded: () => boolean): Promise<Placed> {
    try {
      // The threshold is decided here on the page, the rest in the worker: both start at once.
      const [projection] = await Promise.all([
        this.#client.ask('project', cage, target, { preset }, () => this.#tell('Splitting seams', 0.7)),
        init(),
      ]);
      this.#projected = projection;
      return projection;
    } catch (error) {
      if (!(error instanceof CagecastError) || superseded()) throw error;
      const blamed = /\b(cage|target)\b/.exec(error.message)?.[0] as 'cage' | 'target' | undefined;
      // One that was accepted before stays: then it is the other that does not go with it, and a third file may come.
      const files = { target, cage };
      if (blamed && files[blamed] !== this.#shown?.[blamed]) this.#giveUp(blamed);
      const name = blamed ? files[blamed].name : `${target.name} with ${cage.name}`;
      throw new Error(`${name}: ${error.message.replace(/^\w+: /, '')}`, { cause: error });
    }
  }

  /** Goes back to what is shown, where what was wanted proved unusable. */
  #giveUp(slot: keyof Scene): void {
    const { [slot]: _, ...rest } = this.#wanted;
    this.#wanted = rest;
    if (this.#shown) this.#wanted = { ...rest, [slot]: Promise.resolve(this.#shown[slot]) };
  }

  /** Goes back to what is shown, where what was wanted still waits for something that could not be had. */
  #giveUpRest(): void {
    if (this.#shown && !this.#working) for (const slot of ['target', 'cage', 'paint'] as const) this.#giveUp(slot);
  }

  /** Goes back to the preset of what is shown. */
  #giveUpPreset(): void {
    const { preset } = this.#shown?.projection ?? this.#rules;
    if (preset === this.#rules.preset) return;
    this.#rules = { ...this.#rules, preset };
    this.emit('rules', this.#rules);
  }

  /** Decides by the threshold and the locks as they stand. */
  #classify(): void {
    const decided = this.#decide();
    this.#classification = decided.classification;
    this.emit('zones', decided);
  }

  #decide(): SessionEvents['zones'] {
    const started = performance.now();
    const classification = classify(this.#shown!.projection, {
      threshold: this.#rules.threshold,
      locks: { segments: this.#locks },
    });
    return { classification, spent: performance.now() - started };
  }

  #timeAgain(timings: Timings): void {
    // What has moved since was timed with each frame.
    if (this.#working || !this.#shown || this.#shown.projection !== this.#projected) return;
    this.#shown.projection.timings = timings;
    const { spent } = Array.from({ length: 9 }, () => this.#decide()).sort((a, b) => a.spent - b.spent)[4]!;
    this.emit('again', { timings, spent });
  }
}
