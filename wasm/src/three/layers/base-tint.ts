import { kWhite } from '../../gltf/look/saved-layers.js';
import { checkColor } from '../errors.js';
import { type Command, type History, kOneGo } from './history.js';

/** By what the model's own colour is multiplied. Changes in quick succession are one step. */
export class BaseTint {
  #value = kWhite;
  #last: { step: Command & { after: string }; at: number } | undefined;

  /** @param changed  Called after each change. */
  constructor(
    readonly history: History,
    readonly changed: () => void,
  ) {}

  get value(): string {
    return this.#value;
  }

  /** Sets it without a step. @throws {CagecastError} `badOption` */
  set(tint: string, name = 'baseTint'): void {
    checkColor(name, tint);
    if (tint === this.#value) return;
    this.#value = tint;
    this.changed();
  }

  /** Sets it as a step that can be undone. */
  change(tint: string): void {
    const before = this.#value;
    this.set(tint);
    if (tint === before) return;
    const at = performance.now();
    const [last, { history }] = [this.#last, this];
    if (last && last.step === history.last && at - last.at < kOneGo) {
      last.step.after = tint;
      last.at = at;
      return;
    }
    const step = { name: 'changing the base tint', ...this.between(before, tint) };
    this.#last = { step, at };
    history.add(step);
  }

  /** What takes a change back, and makes it again. */
  between(before: string, after: string): Omit<Command, 'name'> & { after: string } {
    const tint = this;
    return {
      after,
      bytes: 0,
      undo: () => tint.set(before),
      redo() {
        tint.set(this.after);
      },
    };
  }
}
