import { oneLine } from '../model/text.js';

/** Where a command prints. */
export interface Streams {
  /** Takes what a command prints. @throws {InputError} if that is not possible. */
  stdout(data: Uint8Array | string): void;
  stderr(text: string): void;
  /** Columns of the terminal that shows the progress; none without one. */
  columns?: number | undefined;
}

/** Characters of a progress bar. */
const kBarLength = 24;

/** The process, as a command sees it: its output, a line of progress, and its exit code. */
export class Io {
  exitCode = 0;
  readonly #streams: Streams;
  #isShown = false;
  #isQuiet = false;

  constructor(streams: Streams) {
    this.#streams = streams;
  }

  /** Prints. @throws {InputError} */
  out(data: Uint8Array | string): void {
    this.clear();
    this.#streams.stdout(data);
  }

  /** Prints beside it. */
  err(text: string): void {
    this.clear();
    this.#streams.stderr(text);
  }

  /** Shows no progress from now on. */
  silence(): void {
    this.clear();
    this.#isQuiet = true;
  }

  /** Shows the step that begins now. */
  step(text: string): void {
    const { stderr, columns } = this.#streams;
    if (this.#isQuiet || columns === undefined) return;
    this.clear();
    stderr(`${oneLine(text)} …`.slice(0, columns - 1));
    this.#isShown = true;
  }

  /** Shows how far a step is. @param share  0..1 */
  share(text: string, share: number): void {
    const done = Math.round(Math.min(1, Math.max(0, share)) * kBarLength);
    this.step(`${text} [${'#'.repeat(done)}${'-'.repeat(kBarLength - done)}] ${Math.floor(100 * share)} %`);
  }

  /** Clears the line of the progress. */
  clear(): void {
    if (this.#isShown) this.#streams.stderr('\r\x1b[K');
    this.#isShown = false;
  }
}
