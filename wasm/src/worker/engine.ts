import { inspect, prepareParts, transfer } from './index.js';
import { hasWorkers } from './thread-of.js';

export interface Engine {
  transfer: typeof transfer;
  inspect: typeof inspect;
  prepareParts: typeof prepareParts;
}

/** The computing thread: the worker of `cagecast/worker`; in hosts without workers this one, with `cagecast` loaded for it. */
export const engine = async (): Promise<Engine> =>
  hasWorkers() ? { transfer, inspect, prepareParts } : import('./here.js');
