import { CagecastError } from 'cagecast';
import { arraysOf } from '../state/arrays';
import type { Model } from '../state/model';
import { type Reply, type Request, Superseded, type Tasks, type Transferer } from '../state/transfers';

/**
 * Runs transfers in a worker, off the main thread. The latest request wins: it ends the one in progress at once.
 */
export class TransferClient implements Transferer {
  #worker: Worker | undefined = this.#start();
  #lastId = 0;
  #pending:
    | {
        id: number;
        onProjected?: (() => void) | undefined;
        resolve(answer: Tasks[keyof Tasks]['answer']): void;
        reject(error: Error): void;
      }
    | undefined;

  /**
   * Runs a task on a cage and a target.
   * @param onProjected Called when the projection is done and seams are being split.
   * @throws CagecastError, or Superseded if another request came.
   */
  ask<Task extends keyof Tasks>(
    task: Task,
    cage: Model,
    target: Model,
    options: Tasks[Task]['options'],
    onProjected?: () => void,
  ): Promise<Tasks[Task]['answer']> {
    this.cancel();
    return new Promise((resolve, reject) => {
      const id = ++this.#lastId;
      const { mend, ...arrays } = arraysOf(cage, target);
      const answer = (answer: Tasks[Task]['answer']): void => {
        if (task === 'project') mend?.(answer as Tasks['project']['answer']);
        resolve(answer);
      };
      this.#pending = { id, onProjected, resolve: answer as (answer: Tasks[keyof Tasks]['answer']) => void, reject };
      this.#worker ??= this.#start();
      this.#worker.postMessage({ id, task, ...arrays, options } as Request);
    });
  }

  /** Ends the request in progress, if any. */
  cancel(): void {
    if (!this.#pending) return;
    // A call into WebAssembly cannot be interrupted, but its worker can be terminated.
    this.#worker?.terminate();
    this.#worker = this.#start();
    this.#fail(new Superseded());
  }

  #start(): Worker {
    const worker = new Worker(new URL('./transfer-worker.ts', import.meta.url), { type: 'module' });
    worker.onmessage = ({ data }: MessageEvent<Reply>) => {
      if (data.id !== this.#pending?.id) return;
      if ('projected' in data) return this.#pending.onProjected?.();
      if ('error' in data) return this.#fail(new CagecastError(...data.error));
      this.#pending.resolve(data.answer);
      this.#pending = undefined;
    };
    worker.onerror = (event) => {
      event.preventDefault();
      // It will not answer any more: the next request starts another.
      worker.terminate();
      if (worker === this.#worker) this.#worker = undefined;
      this.#fail(new Error(`the transfer could not be started${event.message ? `: ${event.message}` : ''}`));
    };
    return worker;
  }

  #fail(error: Error): void {
    this.#pending?.reject(error);
    this.#pending = undefined;
  }
}
