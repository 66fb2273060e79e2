import type { Model } from '../model';
import type { Scene } from '../scene';
import { kReading, type Session } from '../session';
import { damaged } from './checks';

/** The version of what projects have: it grows when older pages cannot read what newer ones write. */
export const kVersion = 1;

/** Gives a file of a saved project. @throws Error if there is none of that key. */
export type Files = (key: unknown) => File;

/** Gives the files of a project by key. */
export const filesIn =
  (found: ReadonlyMap<unknown, File>): Files =>
  (key) =>
    found.get(key) ?? damaged('a file is missing');

/** Keeps a file with the project, and returns its key. @param pack Makes the file; by default `source` is one. */
export type Keep = (source: object, pack?: () => Promise<Blob>) => string;

/** What a feature restores, in the order in which it happens. */
interface Restoring {
  /** Before the models are requested. */
  before?(): void;
  /** When the models are shown. */
  shown?(): void;
  /** When everything else is ready. */
  ready?(): void;
}

/** A feature's part of a saved project. */
export interface Contribution {
  /** Its key in the project. */
  readonly name: string;
  /** Whether a change of it is work that people would miss. */
  readonly isWork: boolean;
  /** Whether people did something here that the undo history does not have, such as opening files. */
  isTouched?(): boolean;
  /** Calls back when its state has changed, if nothing else tells. */
  follow?(touch: () => void): void;
  /** Its state, as JSON; undefined for nothing. Called often: files that take long to make are made by `pack` if they are needed. */
  save(keep: Keep): unknown;
  /**
   * Reads and checks its state, which may be damaged or hostile, and changes nothing yet.
   * @throws Error that says what is wrong.
   */
  read(saved: unknown, files: Files): Restoring | Promise<Restoring>;
}

/** Reads the models and the base paint of a project. */
export interface SceneContribution extends Omit<Contribution, 'read'> {
  read(saved: unknown, files: Files): Promise<Scene>;
}

/** A state as JSON, and the files in it. */
export interface Snapshot {
  parts: Record<string, unknown>;
  /** Those of the parts that are work, as text to compare. */
  work: string;
  files: Map<string, () => Promise<Blob>>;
}

/** What is saved of the page: the features contribute their parts. */
export class Project {
  readonly #session: Session;
  readonly #scene: SceneContribution;
  readonly #contributions: Contribution[] = [];
  readonly #listeners: (() => void)[] = [];
  readonly #keys = new WeakMap<object, string>();
  #lastKey = 0;
  /** The target of the state that was opened last. */
  #requested: Promise<Model> | undefined;

  constructor(session: Session, scene: SceneContribution) {
    this.#session = session;
    this.#scene = scene;
  }

  add(contribution: Contribution): void {
    this.#contributions.push(contribution);
    contribution.follow?.(() => this.touch());
  }

  /** Says that the state may have changed. */
  touch(): void {
    for (const listener of this.#listeners) listener();
  }

  onTouch(listener: () => void): void {
    this.#listeners.push(listener);
  }

  /** Whether another target was requested since a state was opened last. */
  get isReplaced(): boolean {
    const { target } = this.#session.requested;
    return target !== undefined && target !== this.#requested;
  }

  /** Whether people did something that the undo history does not have. */
  get isTouched(): boolean {
    return [this.#scene, ...this.#contributions].some((one) => one.isTouched?.());
  }

  /** Makes a source known by a key under which it is stored already. */
  know(source: object, key: string): void {
    this.#keys.set(source, key);
  }

  /** The current state; undefined before there is a model. Takes no longer than a millisecond. */
  snapshot(): Snapshot | undefined {
    if (!this.#session.shown) return undefined;
    const files: Snapshot['files'] = new Map();
    const keep: Keep = (source, pack = async () => source as File) => {
      const key =
        this.#keys.get(source) ??
        `${Date.now().toString(36)}-${++this.#lastKey}-${Math.random().toString(36).slice(2)}`;
      this.#keys.set(source, key);
      files.set(key, pack);
      return key;
    };
    const all = [this.#scene, ...this.#contributions].map(({ name, isWork, save }) => ({
      name,
      isWork,
      saved: save(keep),
    }));
    const toObject = (list: typeof all): Record<string, unknown> =>
      Object.fromEntries(list.filter(({ saved }) => saved !== undefined).map(({ name, saved }) => [name, saved]));
    return { parts: toObject(all), work: JSON.stringify(toObject(all.filter(({ isWork }) => isWork))), files };
  }

  /**
   * Opens a saved state: reads all of it, then shows it.
   * @returns Whether it is shown; false if it was superseded or cancelled, or if the transfer failed, which the session has reported.
   * @throws Error that says what is wrong with it; the page is as it was.
   */
  async open(parts: Record<string, unknown>, files: Files): Promise<boolean> {
    const session = this.#session;
    let isRequested = true;
    session.work(kReading, 0, { abort: () => (isRequested = false) });
    // One after the other: each takes more memory while it is read.
    const { target, cage, paint } = await this.#scene.read(parts[this.#scene.name], files);
    const restorings: Restoring[] = [];
    for (const contribution of this.#contributions) {
      const saved = parts[contribution.name];
      if (saved !== undefined && isRequested) restorings.push(await contribution.read(saved, files));
    }
    if (!isRequested) return false;
    for (const restoring of restorings) restoring.before?.();
    this.#requested = Promise.resolve(target);
    session.request({ target: this.#requested, cage: Promise.resolve(cage), paint: Promise.resolve(paint) }, {}, true);
    return new Promise((done) => {
      let isShown = false;
      const ends = [
        session.on('transfer', (shown) => {
          isShown = shown.target === target;
          if (isShown) for (const restoring of restorings) restoring.shown?.();
        }),
        session.on('progress', ({ state }) => {
          if (state === 'working') return;
          for (const end of ends) end();
          if (isShown && state === 'ready') for (const restoring of restorings) restoring.ready?.();
          done(isShown);
        }),
      ];
    });
  }
}
