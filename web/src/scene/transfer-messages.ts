import type {
  Code,
  Mesh,
  Projection,
  ProjectOptions,
  SplitVertices,
  Timings,
  TransferOptions,
  TransferResult,
} from 'cagecast';
import type { CutTarget } from 'cagecast/borders';
import type { Inspection, InspectOptions } from 'cagecast/inspect';

/** A projection, and what the picture needs of it. */
export interface Placed extends Projection {
  /** The target's vertices, split at the seams of the paint; where there are no UVs per corner, nowhere. */
  split: SplitVertices;
}

/** What is to be cut: what was decided about the target, and by which rules. */
export interface CutOptions {
  result: Pick<TransferResult, 'zones' | 'segments' | 'segmentStats'>;
  rules: TransferOptions;
}

/** What the worker can do, and what it answers. */
export interface Tasks {
  project: { options: ProjectOptions; answer: Placed };
  cut: { options: CutOptions; answer: CutTarget };
  inspect: { options: InspectOptions; answer: Inspection };
}

/** What the page asks of the worker. */
export type Request = {
  [Task in keyof Tasks]: { id: number; task: Task; cage: Mesh; target: Mesh; options: Tasks[Task]['options'] };
}[keyof Tasks];

/**
 * What the worker replies, with the id it was asked with; `half` when the first half of it is done. `again` comes a while after a
 * projection that was quick, if nothing else was asked since: how long it takes once the browser has compiled what it runs.
 */
export type Reply =
  | { id: number; half: true }
  | { id: number; answer: Tasks[keyof Tasks]['answer'] }
  | { id: number; code: Code; message: string }
  | { id: number; again: Timings };
