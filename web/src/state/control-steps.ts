import type { Command, History } from '#three';

/** A state that people change by controls of the page, other than the layers. */
export interface Controlled<State = unknown> {
  get(): State;
  set(state: State): void;
  /** What was done, as in “Undo: changing the threshold”. */
  nameOf(before: State, after: State): string;
}

const kOneGo = 600; // milliseconds: equal changes in quick succession, such as a held key, become one step

/** Makes what people change by controls steps of the undo history. */
export class ControlSteps {
  readonly #history: History;
  readonly #states: readonly Controlled[];
  readonly #known = new Map<Controlled, unknown>();
  #last: { step: Step; at: number } | undefined;

  constructor(history: History, states: readonly Controlled[]) {
    this.#history = history;
    this.#states = states;
    this.reset();
  }

  /** Takes the current states as given. */
  take(): void {
    for (const state of this.#states) this.#known.set(state, state.get());
  }

  /** Takes the current states as given, such as those of another model, and drops the steps. */
  reset(): void {
    this.take();
    this.#history.forget((command) => command instanceof Step);
  }

  /** Makes a step of what differs since this was called last. Call it after a click, a choice or a drag. */
  record(): void {
    for (const state of this.#states) {
      const [before, after] = [this.#known.get(state), state.get()];
      if (JSON.stringify(before) === JSON.stringify(after)) continue;
      this.#known.set(state, after);
      const name = state.nameOf(before, after);
      const [last, at] = [this.#last, performance.now()];
      if (last && last.step === this.#history.last && last.step.name === name && at - last.at < kOneGo) {
        last.step.after = after;
        last.at = at;
        continue;
      }
      const put = (to: unknown): void => {
        state.set(to);
        this.#known.set(state, state.get());
      };
      const step = new Step(name, before, after, put);
      this.#last = { step, at };
      this.#history.add(step);
    }
  }
}

class Step implements Command {
  readonly bytes = 0;

  constructor(
    readonly name: string,
    private readonly before: unknown,
    public after: unknown,
    private readonly put: (state: unknown) => void,
  ) {}

  undo(): void {
    this.put(this.before);
  }

  redo(): void {
    this.put(this.after);
  }
}
