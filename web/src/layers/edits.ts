import type { Deed, History } from '../platform/history';
import { areSame, type Layer } from './layer';
import type { LayerStack } from './stack';

const kOneGo = 600; // milliseconds: the same done again that soon, as by a key held down, is one step

/** Notes in the history what the visitor does to the layers. */
export class Edits {
  readonly #stack: LayerStack;
  readonly #history: History;
  #before: readonly Layer[] | undefined;
  #last: { step: Step; at: number } | undefined;

  constructor(stack: LayerStack, history: History) {
    this.#stack = stack;
    this.#history = history;
  }

  /** Begins a step, unless one is under way: all that is done until `end` is undone together, and nothing is undone before it. */
  begin(): void {
    this.#before ??= this.#stack.layers;
    this.#history.held = true;
  }

  /**
   * Ends a step; one that changed nothing is not noted.
   * @param name What undoing it is called. @param beside What was done in it beside changes of the stack.
   */
  end(name: string, beside?: Beside): void {
    const [before, after] = [this.#close(), this.#stack.layers];
    if (!before || (!beside && areSame(before, after))) return;
    const [last, at] = [this.#last, performance.now()];
    if (!beside && last && last.step === this.#history.last && last.step.name === name && at - last.at < kOneGo) {
      last.step.after = after;
      last.at = at;
      return;
    }
    const step = new Step(name, this.#stack, before, after, beside);
    this.#last = beside ? undefined : { step, at };
    this.#history.add(step);
  }

  /** Takes back what was done since `begin`. */
  cancel(): void {
    const before = this.#close();
    if (before) this.#stack.change(this.#stack.layers, before);
  }

  /** Forgets which paints were chosen to lie under everything: another model has put its own there. */
  forgetChoices(): void {
    this.#history.forget((deed) => deed instanceof Step && deed.isChoice);
  }

  /** Forgets all. */
  forget(): void {
    this.#history.forget(() => true);
  }

  #close(): readonly Layer[] | undefined {
    const before = this.#before;
    this.#before = undefined;
    this.#history.held = false;
    return before;
  }

  /** Does something to the layers as a step; as a part of the one that is under way, if one is. @param name What undoing it is called. */
  do<Result>(name: string, run: () => Result): Result {
    if (this.#before) return run();
    this.begin();
    try {
      return run();
    } finally {
      this.end(name);
    }
  }
}

/** What is done in a step beside changes of the stack. */
type Beside = Omit<Deed, 'name'>;

class Step implements Deed {
  constructor(
    readonly name: string,
    private readonly stack: LayerStack,
    private readonly before: readonly Layer[],
    public after: readonly Layer[],
    private readonly beside?: Beside,
  ) {}

  /** Whether a layer holds something else since. */
  get isChoice(): boolean {
    return this.before.some((layer) => this.after.some(({ id, sheet }) => id === layer.id && sheet !== layer.sheet));
  }

  get bytes(): number {
    // Of the layers that are kept only to come back.
    const isIn = (layers: readonly Layer[], { id }: Layer): boolean => layers.some((layer) => layer.id === id);
    const passing = [...this.before, ...this.after].filter(
      (layer) => !isIn(this.before, layer) || !isIn(this.after, layer),
    );
    return passing.reduce((sum, { sheet }) => sum + (sheet.bytes ?? 0), this.beside?.bytes ?? 0);
  }

  undo(): void {
    this.beside?.undo();
    this.stack.change(this.after, this.before);
  }

  redo(): void {
    this.stack.change(this.before, this.after);
    this.beside?.redo();
  }
}
