import { inspect, prepareParts, transfer } from './index.js';
import { hasWorkers } from './thread-of.js';

export interface Engine {
  transfer: typeof transfer;
  inspect: typeof inspect;
  prepareParts: typeof prepareParts;
}

/** What computes: the worker of `cagecast/worker`; where there are none, this thread, for which `cagecast` is loaded. */
export const engine = async (): Promise<Engine> =>
  hasWorkers() ? { transfer, inspect, prepareParts } : import('./here.js');
