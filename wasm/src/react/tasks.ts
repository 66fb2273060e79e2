// Fits and transfers of models, kept as long as the models are: a component that React begins to draw once more finds them here.
import { type Choice, chooseCage, fitCage, loadTemplate } from '../cages/index.js';
import type { TemplateName } from '../cages/template-names.js';
import type { Fit, Landmarks, Template } from '../cages/types.js';
import {
  type ApplyOptions,
  cageModel,
  cageTemplate,
  type Loaded,
  type LoadedCage,
  prepareTransfer,
  type Saved,
} from '../three/index.js';
import { wrong } from './errors.js';

/** Options of a fit and transfer: those of `applyTransfer` but for what is displayed, and a template. */
export interface FittingOptions
  extends Omit<ApplyOptions, 'texture' | 'material' | 'opacity' | 'feather' | 'result' | 'saved'> {
  /**
   * A cage that is first fitted to the model: the name of one that comes with the package, or its own, as a loaded glTF or a `Template`;
   * `auto`: what `chooseCage` of `cagecast/cages` chooses. Default: `cage`.
   */
  template?: TemplateName | 'auto' | Template | Loaded | undefined;
  /** Spots of the model for the fit; they override those that are found. Default: none. */
  landmarks?: Landmarks | undefined;
}

/** What is ready to be applied to a model. */
export interface Fitted {
  /** The cage that was fitted or given; undefined if the model has its own. */
  cage: LoadedCage | undefined;
  /** The fit, if there was one. */
  fit: Fit | undefined;
  /** With `template: 'auto'`, what was chosen, its verdict, and what was tried. */
  choice: Choice | undefined;
  saved: Saved;
}

/** A fit and transfer, done or under way. */
export class Task {
  readonly promise: Promise<Fitted>;
  /** Whether a component wants it that is not mounted yet: React does not tell when it gives such a one up. */
  isKept = false;
  readonly #holders = new Set<Holder>();
  readonly #end: () => void;

  constructor(promise: Promise<Fitted>, end: () => void) {
    this.promise = promise;
    this.#end = end;
  }

  hold(holder: Holder): void {
    this.#holders.add(holder);
  }

  /** Ends it, if it is under way and no other component wants it. */
  release(holder: Holder): void {
    this.#holders.delete(holder);
    setTimeout(() => {
      if (this.#holders.size === 0 && !this.isKept) this.#end();
    }, kPause);
  }
}

/**
 * Milliseconds until a task without holders is ended: in a transition React also draws the old components, which want something else for a
 * moment.
 */
const kPause = 200;

/** What one component wants. */
export class Holder {
  #task: Task | undefined;
  #wanted: Task | undefined;
  #isMounted = false;

  /** Each time that the component is drawn. While it waits, no effect is run. */
  want(task: Task): void {
    this.#wanted = task;
    if (this.#isMounted) this.#hold(task);
    else task.isKept = true;
  }

  /** @returns what is to be called when it is unmounted. */
  mount(): () => void {
    this.#isMounted = true;
    this.#hold(this.#wanted);
    return () => {
      this.#isMounted = false;
      this.#hold(undefined);
    };
  }

  #hold(task: Task | undefined): void {
    if (task === this.#task) return;
    this.#task?.release(this);
    this.#task = task;
    task?.hold(this);
  }
}

const tasks = new WeakMap<object, Map<string, Task>>();

/** Milliseconds that a failure is kept: React tries again at once, and has to fail again to show it. People may try again later. */
const kFailureLasts = 1000;

/** The fit and transfer of a model; it is begun if it is not under way. */
export function taskOf(model: Loaded, options: FittingOptions): Task {
  const owner = (model as { scene?: object } | undefined)?.scene ?? model;
  if (typeof owner !== 'object' || owner === null) throw wrong('model', model, 'a loaded glTF, a scene or a mesh');
  const ofModel = tasks.get(owner) ?? new Map<string, Task>();
  tasks.set(owner, ofModel);
  const key = textOf(options);
  const known = ofModel.get(key);
  if (known) return known;
  const controller = new AbortController();
  let isUnderWay = true;
  const forget = (): boolean => ofModel.get(key) === task && ofModel.delete(key);
  const task: Task = new Task(run(model, options, controller.signal), () => {
    if (!isUnderWay) return;
    forget();
    controller.abort();
  });
  ofModel.set(key, task);
  task.promise
    .catch(() => void setTimeout(forget, kFailureLasts))
    .finally(() => {
      isUnderWay = false;
    });
  return task;
}

async function run(
  model: Loaded,
  { template, landmarks, ...options }: FittingOptions,
  signal: AbortSignal,
): Promise<Fitted> {
  if (template === undefined)
    return {
      cage: options.cage,
      fit: undefined,
      choice: undefined,
      saved: await prepareTransfer(model, { ...options, signal }),
    };
  const read = await cageModel(model);
  const choice = template === 'auto' ? await chooseCage(read, { landmarks, signal }) : undefined;
  const fit =
    template === 'auto' ? choice!.fit : await fitCage(await templateOf(template), read, landmarks, { signal });
  const cage = choice?.cage ?? fit!.cage;
  const saved = await prepareTransfer(model, { ...options, cage, signal });
  return { cage, fit, choice, saved };
}

async function templateOf(template: Exclude<FittingOptions['template'], 'auto' | undefined>): Promise<Template> {
  const loaded = typeof template === 'string' ? await loadTemplate(template) : template;
  return 'positions' in loaded ? loaded : cageTemplate(loaded);
}

const ids = new WeakMap<object, number>();
let idCount = 0;

function idOf(value: object): number {
  const id = ids.get(value) ?? ++idCount;
  ids.set(value, id);
  return id;
}

/** A text that is the same for the same options: plain objects and lists by what they hold, functions by their code, others as they are. */
const textOf = (options: object): string =>
  JSON.stringify(options, (_, value: unknown) => {
    if (typeof value === 'function') return `${value}`;
    if (typeof value !== 'object' || value === null) return value;
    const { scene } = value as { scene?: unknown };
    if (typeof scene === 'object' && scene !== null) return { id: idOf(scene) };
    return Array.isArray(value) || Object.getPrototypeOf(value) === Object.prototype ? value : { id: idOf(value) };
  });
