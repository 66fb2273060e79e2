import { oneLine } from './print.js';

/** Characters of a progress bar. */
const kBarLength = 24;

/** Shows the current step in one line of the terminal, and clears it afterwards. Silent if stderr is not a terminal. */
export class Progress {
  readonly #stream = process.stderr;
  #shown = false;
  #isQuiet = false;

  /** Shows nothing from now on. */
  silence(): void {
    this.clear();
    this.#isQuiet = true;
  }

  /** Shows the step that begins now. */
  step(text: string): void {
    if (this.#isQuiet || !this.#stream.isTTY) return;
    this.clear();
    this.#stream.write(`${oneLine(text)} …`.slice(0, (this.#stream.columns || 80) - 1));
    this.#shown = true;
  }

  /** Shows how far a step is. @param share  0..1 */
  share(text: string, share: number): void {
    const done = Math.round(Math.min(1, Math.max(0, share)) * kBarLength);
    this.step(`${text} [${'#'.repeat(done)}${'-'.repeat(kBarLength - done)}] ${Math.floor(100 * share)} %`);
  }

  /** Clears the line. */
  clear(): void {
    if (this.#shown) this.#stream.write('\r\x1b[K');
    this.#shown = false;
  }
}
