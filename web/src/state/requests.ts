import type { Locks } from './choices';
import { asCage, asTarget, ownCage } from './model';
import { kSlots, type Requested, type Scene, type Shown, type Slot } from './scene';

/** The files that were requested for the next scene. */
export class Requests {
  readonly #shown: () => Shown | undefined;
  #files: Requested = {};
  /** Those of the requested files that are useless without each other. */
  #together: Requested = {};
  /** Whether the cage was there before the target. */
  #isOlderCage = false;
  #locks: Locks = {};
  #isOtherTarget = false;

  /** @param shown Gives the scene that is shown, which requests fall back to. */
  constructor(shown: () => Shown | undefined) {
    this.#shown = shown;
  }

  get files(): Readonly<Requested> {
    return this.#files;
  }

  /** Locks of the requested target. */
  get locks(): Locks {
    return this.#locks;
  }

  /** Whether the requested target is another one than the current. */
  get isOtherTarget(): boolean {
    return this.#isOtherTarget;
  }

  /** The files that are missing. */
  get missing(): ('target' | 'cage')[] {
    return (['target', 'cage'] as const).filter((slot) => !this.#files[slot]);
  }

  /** @param together Whether all files are dropped if one of them fails. Otherwise the others wait for a replacement. */
  add(change: Requested, locks: Locks, together: boolean): void {
    // What is being loaded together with another model is not for this one.
    if (change.target && this.#shown()) this.abort(...this.#slotsTogether);
    if (change.target) {
      this.#locks = locks;
      this.#isOtherTarget = true;
    }
    if (change.target || change.cage) this.#isOlderCage = !change.cage;
    if (together) this.#together = change;
    for (const slot of Object.values(change)) slot.catch(() => {}); // reported where it is awaited
    this.#files = { ...this.#files, ...change };
  }

  /** Falls back to the current files of slots. */
  abort(...slots: readonly Slot[]): void {
    const shown = this.#shown();
    for (const slot of slots) {
      if (slot === 'target') this.#isOtherTarget = false;
      const { [slot]: _, ...rest } = this.#files;
      this.#files = shown ? { ...rest, [slot]: Promise.resolve(shown[slot]) } : rest;
    }
  }

  /** The requested files are shown. */
  settle(): void {
    this.#isOtherTarget = false;
  }

  /**
   * Waits for the requested files. One that fails is replaced by the current one, as are those requested together with it.
   * @returns Undefined if some are missing.
   */
  async read(isSuperseded: () => boolean): Promise<Scene | undefined> {
    const { paint } = this.#files;
    const target = this.#files.target?.then(asTarget);
    const cage = this.#files.cage?.then(asCage);
    const results = await Promise.allSettled([target, cage, paint]);
    const failed = results.find((result) => result.status === 'rejected');
    if (failed && !isSuperseded()) {
      const lost = kSlots.filter((_, index) => results[index]!.status === 'rejected');
      const together = this.#slotsTogether;
      const isTorn = this.#shown() !== undefined && lost.some((slot) => together.includes(slot));
      this.abort(...kSlots.filter((slot) => lost.includes(slot) || (isTorn && together.includes(slot))));
      throw failed.reason;
    }
    if (failed) return undefined; // nobody waits for it any more
    const [t, given, p] = await Promise.all([target, cage, paint]);
    // A model that is opened alone brings its own cage.
    const own = this.#isOlderCage && t ? ownCage(t) : undefined;
    const c = own ?? given;
    if (own && !isSuperseded()) this.#files = { ...this.#files, cage: Promise.resolve(own) };
    return t && c && p ? { target: t, cage: c, paint: p } : undefined;
  }

  /** The slots whose requested files are useless without each other. */
  get #slotsTogether(): readonly Slot[] {
    return kSlots.filter((slot) => this.#files[slot] === this.#together[slot]);
  }
}
