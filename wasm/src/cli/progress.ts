/** Says on a terminal what is going on, in one line that goes away again. Silent where stderr is not a terminal. */
export class Progress {
  readonly #stream = process.stderr;
  #shown = false;

  /** Shows the step that begins now. */
  step(text: string): void {
    if (!this.#stream.isTTY) return;
    this.clear();
    this.#stream.write(`${text} …`.slice(0, (this.#stream.columns || 80) - 1));
    this.#shown = true;
  }

  /** Takes the line away. */
  clear(): void {
    if (this.#shown) this.#stream.write('\r\x1b[K');
    this.#shown = false;
  }
}
