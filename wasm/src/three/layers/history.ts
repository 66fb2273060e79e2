import { Emitter } from './emitter.js';

/** An action that can be undone. @internal */
export interface Command {
  /** For people, such as “stroke”. */
  name: string;
  /** Memory it holds, in bytes. */
  bytes: number;
  undo(): void;
  redo(): void;
}

/** Milliseconds: equal edits in quick succession, such as by a held key, become one step. */
export const kOneGo = 600;
const kMaxBytes = 128 * 2 ** 20;

/** The undo history, limited to 128 MiB: the oldest commands are dropped first. @internal */
export class History extends Emitter<{ change: undefined }> {
  #done: Command[] = [];
  #undone: Command[] = [];

  /** Whether a command is in progress: undo and redo do nothing meanwhile. */
  held = false;

  /** The command that `undo` would undo. */
  get last(): Command | undefined {
    return this.#done.at(-1);
  }

  /** The command that `redo` would repeat. */
  get next(): Command | undefined {
    return this.#undone.at(-1);
  }

  /** Adds a command after it was done; clears the undone ones. */
  add(command: Command): void {
    this.#done.push(command);
    this.#undone = [];
    let bytes = this.#done.reduce((sum, one) => sum + one.bytes, 0);
    while (bytes > kMaxBytes) bytes -= this.#done.shift()!.bytes;
    this.emit('change', undefined);
  }

  /** Drops commands, done or undone. */
  forget(matches: (command: Command) => boolean): void {
    this.#done = this.#done.filter((command) => !matches(command));
    this.#undone = this.#undone.filter((command) => !matches(command));
    this.emit('change', undefined);
  }

  /** @returns The undone command, if any. */
  undo(): Command | undefined {
    const command = this.#done.at(-1);
    if (!command || this.held) return;
    // Before the pop: a command that throws stays done.
    command.undo();
    this.#undone.push(this.#done.pop()!);
    this.emit('change', undefined);
    return command;
  }

  /** @returns The repeated command, if any. */
  redo(): Command | undefined {
    const command = this.#undone.at(-1);
    if (!command || this.held) return;
    command.redo();
    this.#done.push(this.#undone.pop()!);
    this.emit('change', undefined);
    return command;
  }
}
