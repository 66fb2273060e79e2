import { type Command, type History, kOneGo } from './history.js';
import { areSame, type Layer } from './layer.js';
import type { LayerStack } from './stack.js';

/** Records changes of the layers in the undo history. @internal */
export class Edits {
  readonly #stack: LayerStack;
  readonly #history: History;
  #before: readonly Layer[] | undefined;
  #last: { step: Step; at: number; edited: string | undefined } | undefined;

  constructor(stack: LayerStack, history: History) {
    this.#stack = stack;
    this.#history = history;
  }

  /** Begins a step, unless one is open: everything until `end` is undone together. Undo is blocked meanwhile. */
  begin(): void {
    this.#before ??= this.#stack.layers;
    this.#history.held = true;
  }

  /**
   * Ends a step; a step without changes is not recorded.
   * @param name The name of the undo step. @param sideEffect What it did besides changing the stack.
   */
  end(name: string, sideEffect?: SideEffect): void {
    const [before, after] = [this.#close(), this.#stack.layers];
    if (!before || (!sideEffect && areSame(before, after))) return;
    const [last, at] = [this.#last, performance.now()];
    const edited = sideEffect ? undefined : editedIn(before, after);
    const isMore = edited !== undefined && last?.edited === edited && last.step.name === name;
    if (isMore && last.step === this.#history.last && at - last.at < kOneGo) {
      last.step.after = after;
      last.at = at;
      return;
    }
    const step = new Step(name, this.#stack, before, after, sideEffect);
    this.#last = { step, at, edited };
    this.#history.add(step);
  }

  /** Reverts the changes since `begin`. */
  cancel(): void {
    const before = this.#close();
    if (before) this.#stack.change(this.#stack.layers, before);
  }

  /** Drops the steps that chose a base paint: another model has replaced it. */
  forgetChoices(): void {
    this.#history.forget((command) => command instanceof Step && command.isChoice);
  }

  /** Drops all steps. */
  forget(): void {
    this.#history.forget(() => true);
  }

  #close(): readonly Layer[] | undefined {
    const before = this.#before;
    this.#before = undefined;
    this.#history.held = false;
    return before;
  }

  /**
   * Runs a change of the layers as a step, or as part of the open one.
   * @param name The name of the undo step. @param sideEffect What it does besides, if it becomes a step.
   */
  do<Result>(name: string, run: () => Result, sideEffect?: SideEffect): Result {
    if (this.#before) return run();
    this.begin();
    try {
      const result = run();
      this.end(name, sideEffect);
      return result;
    } catch (error) {
      this.cancel();
      throw error;
    }
  }
}

/** Which layers have other properties than before; `undefined` if some were added or removed. */
const editedIn = (before: readonly Layer[], after: readonly Layer[]): string | undefined =>
  before.length === after.length
    ? after.flatMap((layer) => (before.includes(layer) ? [] : layer.id)).join()
    : undefined;

/** What a step does besides changing the stack. */
type SideEffect = Omit<Command, 'name'>;

class Step implements Command {
  constructor(
    readonly name: string,
    private readonly stack: LayerStack,
    private readonly before: readonly Layer[],
    public after: readonly Layer[],
    private readonly sideEffect?: SideEffect,
  ) {}

  /** Whether it put another sheet into a layer. */
  get isChoice(): boolean {
    return this.before.some((layer) => this.after.some(({ id, sheet }) => id === layer.id && sheet !== layer.sheet));
  }

  get bytes(): number {
    // Count the layers that only the history keeps alive.
    const isIn = (layers: readonly Layer[], { id }: Layer): boolean => layers.some((layer) => layer.id === id);
    const passing = [...this.before, ...this.after].filter(
      (layer) => !isIn(this.before, layer) || !isIn(this.after, layer),
    );
    return passing.reduce((sum, { sheet }) => sum + (sheet.bytes ?? 0), this.sideEffect?.bytes ?? 0);
  }

  undo(): void {
    this.sideEffect?.undo();
    this.stack.change(this.after, this.before);
  }

  redo(): void {
    this.stack.change(this.before, this.after);
    this.sideEffect?.redo();
  }
}
