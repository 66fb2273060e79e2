import { CagecastError, type Mesh, type Timings } from 'cagecast';
import type { Model } from './load';
import type { Reply, Request, Tasks } from './transfer-messages';

/** A request that a later one made pointless. Not a failure: nothing is to be told. */
export class Superseded extends Error {}

/**
 * Runs what is costly about transfers in a worker, off the main thread.
 * The latest request wins: it ends the one under way at once.
 */
export class TransferClient {
  /** Called a while after a projection that was quick, with how long it takes once the browser has compiled what it runs. */
  onAgain?: (timings: Timings) => void;
  #worker: Worker | undefined = this.#start();
  #lastId = 0;
  #pending:
    | {
        id: number;
        onHalf?: (() => void) | undefined;
        resolve(answer: Tasks[keyof Tasks]['answer']): void;
        reject(error: Error): void;
      }
    | undefined;

  /**
   * Asks for what is to be known of a cage and a target.
   * @param onHalf Called when the first half of it is done.
   * @throws CagecastError, or Superseded if another request came.
   */
  ask<Task extends keyof Tasks>(
    task: Task,
    cage: Model,
    target: Model,
    options: Tasks[Task]['options'],
    onHalf?: () => void,
  ): Promise<Tasks[Task]['answer']> {
    this.cancel();
    return new Promise((resolve, reject) => {
      const id = ++this.#lastId;
      this.#pending = { id, onHalf, resolve, reject };
      this.#worker ??= this.#start();
      this.#worker.postMessage({ id, task, cage: cageArrays(cage), target: targetArrays(target), options } as Request);
    });
  }

  /** Ends the request under way, if any. */
  cancel(): void {
    if (!this.#pending) return;
    // A call into WebAssembly cannot be interrupted from outside; its worker can.
    this.#worker?.terminate();
    this.#worker = this.#start();
    this.#fail(new Superseded());
  }

  #start(): Worker {
    const worker = new Worker(new URL('./transfer-worker.ts', import.meta.url), { type: 'module' });
    worker.onmessage = ({ data }: MessageEvent<Reply>) => {
      if ('again' in data) return data.id === this.#lastId ? this.onAgain?.(data.again) : undefined;
      if (data.id !== this.#pending?.id) return;
      if ('half' in data) return this.#pending.onHalf?.();
      if ('code' in data) return this.#fail(new CagecastError(data.code, data.message));
      this.#pending.resolve(data.answer);
      this.#pending = undefined;
    };
    worker.onerror = (event) => {
      event.preventDefault();
      // It will answer nothing more: the next request has another.
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

function cageArrays({ mesh: { positions, indices, uvs } }: Model): Mesh {
  return { positions, indices, uvs };
}

function targetArrays({ mesh: { positions, indices, groups } }: Model): Mesh {
  return { positions, indices, groups };
}
