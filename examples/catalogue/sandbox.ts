import { type ChildProcess, fork } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { Failure, meaningOf, type Reason } from './failure.ts';
import type { Answer } from './kinds/kind.ts';
import { settings } from './settings.ts';

/** What the process of a sandbox is asked. */
export interface Task {
  kind: string;
  inputs: Record<string, Uint8Array>;
  settings: Record<string, unknown>;
  /** How long it may take. */
  seconds: number;
}

/** What it replies. */
export type Reply = (Answer | { failure: { reason: Reason; text: string; facts?: object | undefined } }) & {
  cpuMs: number;
};

/** How often a process's memory is looked at. */
const watchMs = 250;
const pageBytes = 4096;

/** Does jobs in a process of its own, one at a time. Whatever happens there, the worker lives on. */
export class Sandbox {
  #child: ChildProcess | undefined;
  /** The end of what the process wrote, which tells why it died. */
  #said = '';

  /** @throws {Failure} that of the job; `limit` or `crash` if its process had to be killed, or died. */
  async run(task: Task): Promise<Answer & { cpuMs: number }> {
    const child = this.#child ?? (await this.#start());
    let reply: Reply;
    try {
      reply = await this.#ask(child, task);
    } catch (error) {
      this.close();
      throw error;
    }
    // The memory of WebAssembly grows, but never shrinks.
    if (memoryOf(child) > settings.memory / 2) this.close();
    if (!('failure' in reply)) return reply;
    throw new Failure(reply.failure.reason, reply.failure.text, { ...reply.failure.facts, cpuMs: reply.cpuMs });
  }

  close(): void {
    this.#child?.kill('SIGKILL');
    this.#child = undefined;
  }

  /** Starts a process, and waits until it can do jobs: that must not count as time of its first one. */
  async #start(): Promise<ChildProcess> {
    const others = process.env['CATALOGUE_KINDS'];
    const child = fork(fileURLToPath(new URL('child.ts', import.meta.url)), {
      execArgv: ['--import', import.meta.resolve('tsx'), `--max-old-space-size=${settings.memory}`],
      serialization: 'advanced',
      // No passwords of Redis, no keys of a cloud.
      env: others ? { CATALOGUE_KINDS: others } : {},
      stdio: ['ignore', 'ignore', 'pipe', 'ipc'],
    });
    this.#said = '';
    child.stderr!.on('data', (data: Buffer) => (this.#said = (this.#said + data).slice(-2000)));
    await new Promise<void>((ready, failed) => {
      child.once('message', () => ready());
      child.once('error', failed);
      child.once('exit', () => {
        if (this.#child === child) this.#child = undefined;
        failed(
          new Failure(
            'unexpected',
            `the process of a job does not start: ${/^.*Error.*$/m.exec(this.#said)?.[0] ?? this.#said.trim()}`,
          ),
        );
      });
    });
    return (this.#child = child);
  }

  #ask(child: ChildProcess, task: Task): Promise<Reply> {
    return new Promise((resolve, reject) => {
      const end = (result: Reply | Failure) => {
        clearTimeout(timer);
        clearInterval(watch);
        child.off('message', end).off('exit', died).off('error', lost);
        result instanceof Failure ? reject(result) : resolve(result);
      };
      const tooMuch = new Failure('limit', `more than ${settings.memory} MB of memory (CATALOGUE_MEMORY)`);
      const died = (code: number | null, signal: string | null) =>
        end(
          /heap out of memory/.test(this.#said)
            ? tooMuch
            : new Failure('crash', `its process died (${signal ?? `exit code ${code}`})`),
        );
      const lost = (error: Error) => end(new Failure('crash', `its process cannot be reached: ${meaningOf(error)}`));
      const late = new Failure('limit', `more than ${task.seconds} s (CATALOGUE_SECONDS, or "seconds" of its kind)`);
      const timer = setTimeout(() => end(late), task.seconds * 1000);
      const watch = setInterval(() => memoryOf(child) > settings.memory && end(tooMuch), watchMs);
      child.on('message', end).on('exit', died).on('error', lost);
      child.send(task, (error) => error && lost(error));
    });
  }
}

/** Megabytes that a process has in memory; 0 where the system does not tell in the way of Linux. */
function memoryOf({ pid }: ChildProcess): number {
  try {
    return (Number(readFileSync(`/proc/${pid}/statm`, 'utf8').split(' ')[1]) * pageBytes) / 1e6;
  } catch {
    return 0;
  }
}
