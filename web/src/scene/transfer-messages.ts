import type {
  CagecastError,
  CutTarget,
  Mesh,
  Projection,
  ProjectOptions,
  SplitVertices,
  Timings,
  TransferOptions,
  TransferResult,
} from 'cagecast';
import type { Inspection, InspectOptions } from 'cagecast/inspect';

/** A projection, and the split vertices that the view needs. */
export interface SplitProjection extends Projection {
  /** The target's vertices, split at UV seams; not split if there are no UVs per corner. */
  split: SplitVertices;
}

/** Input of exact borders: the zones of the target, and the options they were computed with. */
interface CutOptions {
  result: Pick<TransferResult, 'zones' | 'segments' | 'segmentStats'>;
  rules: TransferOptions;
}

/** Tasks of the worker, with their options and answers. */
export interface Tasks {
  project: { options: ProjectOptions; answer: SplitProjection };
  cut: { options: CutOptions; answer: CutTarget };
  inspect: { options: InspectOptions; answer: Inspection };
}

/** A message to the worker. */
export type Request = {
  [Task in keyof Tasks]: { id: number; task: Task; cage: Mesh; target: Mesh; options: Tasks[Task]['options'] };
}[keyof Tasks];

/**
 * A message from the worker, with the id of the request. `projected` comes before seams are split. `retimed` comes some time
 * after a quick projection if no other request came: its timings once the browser has compiled the code.
 */
export type Reply =
  | { id: number; projected: true }
  | { id: number; answer: Tasks[keyof Tasks]['answer'] }
  | { id: number; error: ConstructorParameters<typeof CagecastError> }
  | { id: number; retimed: Timings };
