import { Emitter } from './events';

/** Something that was done, and can be taken back. */
export interface Deed {
  /** For people: “stroke”, “sticker”. */
  name: string;
  /** What keeping it takes, in bytes. */
  bytes: number;
  undo(): void;
  redo(): void;
}

const kMostBytes = 128 * 2 ** 20;

/** What was done, as far back as memory allows: the oldest deeds are forgotten first. */
export class History extends Emitter<{ change: void }> {
  #done: Deed[] = [];
  #undone: Deed[] = [];

  /** Whether something is being done that will be added: until then nothing is undone or done again. */
  held = false;

  /** What `undo` would take back. */
  get last(): Deed | undefined {
    return this.#done.at(-1);
  }

  /** What `redo` would do again. */
  get next(): Deed | undefined {
    return this.#undone.at(-1);
  }

  /** Keeps a deed that was just done; those that were taken back cannot be done again. */
  add(deed: Deed): void {
    this.#done.push(deed);
    this.#undone = [];
    let bytes = this.#done.reduce((sum, one) => sum + one.bytes, 0);
    while (bytes > kMostBytes) bytes -= this.#done.shift()!.bytes;
    this.emit('change', undefined);
  }

  /** Forgets deeds, whether they are done or undone. */
  forget(isOver: (deed: Deed) => boolean): void {
    this.#done = this.#done.filter((deed) => !isOver(deed));
    this.#undone = this.#undone.filter((deed) => !isOver(deed));
    this.emit('change', undefined);
  }

  /** @returns What was taken back, if anything was. */
  undo(): Deed | undefined {
    const deed = this.#done.at(-1);
    if (!deed || this.held) return;
    // First: what cannot be undone stays done.
    deed.undo();
    this.#undone.push(this.#done.pop()!);
    this.emit('change', undefined);
    return deed;
  }

  /** @returns What was done again, if anything was. */
  redo(): Deed | undefined {
    const deed = this.#undone.at(-1);
    if (!deed || this.held) return;
    deed.redo();
    this.#done.push(this.#undone.pop()!);
    this.emit('change', undefined);
    return deed;
  }
}
