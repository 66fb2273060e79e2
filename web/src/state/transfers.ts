import type {
  CagecastError,
  CutTarget,
  Inspection,
  InspectOptions,
  Mesh,
  Projection,
  ProjectOptions,
  SplitVertices,
  Timings,
  TransferOptions,
  TransferResult,
} from 'cagecast';
import type { Model } from './model';

/** A projection, and the split vertices that the view needs. */
export interface WorkerProjection extends Projection {
  /** The target's vertices, split at UV seams; not split if there are no UVs per corner. */
  split: SplitVertices;
}

/** The same, and what it was made with besides the preset. */
export interface SplitProjection extends WorkerProjection {
  weldTolerance: number;
  /** The groups that were left out. */
  leftOut: readonly number[];
}

/** A request was replaced by a later one: not a failure to report. */
export class Superseded extends Error {}

/** Input of exact borders: the zones of the target, and the options they were computed with. */
interface CutOptions {
  result: Pick<TransferResult, 'zones' | 'segments' | 'segmentStats'>;
  rules: TransferOptions;
}

/** Options of transfers that are timed, and how many there are. */
interface TimeOptions {
  rules: TransferOptions;
  runs: number;
}

/** Tasks of the worker, with their options and answers. */
export interface Tasks {
  project: { options: ProjectOptions; answer: WorkerProjection };
  cut: { options: CutOptions; answer: CutTarget };
  inspect: { options: InspectOptions; answer: Inspection };
  /** Times whole transfers, one after the other; two before them, in which the browser compiles, are not timed. */
  time: { options: TimeOptions; answer: { runs: Timings[] } };
}

/** A message to the worker. */
export type Request = {
  [Task in keyof Tasks]: { id: number; task: Task; cage: Mesh; target: Mesh; options: Tasks[Task]['options'] };
}[keyof Tasks];

/**
 * A message from the worker, with the id of the request. `projected` comes before seams are split.
 */
export type Reply =
  | { id: number; projected: true }
  | { id: number; answer: Tasks[keyof Tasks]['answer'] }
  | { id: number; error: ConstructorParameters<typeof CagecastError> };

/** Runs transfers. The page's own is `TransferClient`; tests hand in others. */
export interface Transferer {
  /**
   * Runs a task on a cage and a target. The latest request wins: it ends the one in progress at once.
   * @param onProjected Called when the projection is done and seams are being split.
   * @throws CagecastError, or Superseded if another request came.
   */
  ask<Task extends keyof Tasks>(
    task: Task,
    cage: Model,
    target: Model,
    options: Tasks[Task]['options'],
    onProjected?: () => void,
  ): Promise<Tasks[Task]['answer']>;
  /** Ends the request in progress, if any. */
  cancel(): void;
}
