// A process that checks files, as it may hang or take all memory; a new one takes its place then.
import { type ChildProcess, fork } from 'node:child_process';
import { fileURLToPath } from 'node:url';
import type { Files } from './check.js';
import type { Answer } from './child.js';

/** A process reads as many, so that what one file leaves behind is not counted for another. */
const kMaxFiles = 2000;

export class Reader {
  /** Read before the first of a process, which pays for what all load. */
  readonly #known: Files;
  #child: ChildProcess | undefined;
  #files = 0;
  #said = '';

  constructor(known: Files) {
    this.#known = known;
  }

  async check(files: Files): Promise<Answer> {
    if (this.#files >= kMaxFiles) this.end();
    if (!this.#child) {
      this.#start();
      const { fault } = await this.#ask({ files: this.#known, isFree: true });
      if (fault !== undefined) throw new Error(`${Object.keys(this.#known)[0]}, unchanged: ${fault}`);
    }
    ++this.#files;
    const answer = await this.#ask({ files });
    if (answer.isMarked) this.end();
    return answer;
  }

  end(): void {
    this.#child?.kill('SIGKILL');
    this.#child = undefined;
  }

  #start(): void {
    this.#files = 0;
    this.#said = '';
    const file = fileURLToPath(new URL('child.ts', import.meta.url));
    this.#child = fork(file, { stdio: ['ignore', 'ignore', 'pipe', 'ipc'], serialization: 'advanced' });
    this.#child.stderr!.setEncoding('utf8').on('data', (text) => (this.#said = (this.#said + text).slice(-2000)));
  }

  #ask(message: { files: Files; isFree?: boolean }): Promise<Answer> {
    const child = this.#child!;
    return new Promise((resolve) => {
      const answered = (answer: unknown) => {
        child.off('close', ended);
        resolve(answer as Answer);
      };
      const ended = (code: number | null) => {
        child.off('message', answered);
        this.#child = undefined;
        const [, over] = /^it takes (.*)$/m.exec(this.#said) ?? [];
        const fault = over ? `it takes ${over}` : `its process ended (${code}): ${this.#said.trim()}`;
        // What was taken is over the limit; how much is not known.
        resolve({ fault, isRead: false, milliseconds: over?.includes(' s ') ? 3000 : 0, megabytes: 0 });
      };
      child.once('message', answered);
      child.once('close', ended);
      child.send(message);
    });
  }
}
