import type { KnownVerdict } from '../panels/stage-verdict';
import type { Model } from '../scene/load-model';
import type { Sample } from '../scene/samples';
import type { Locks } from '../scene/session';
import type { SplitProjection } from '../scene/transfer-messages';
import type { KeptAvatar } from './kept';
import type { Beside } from './side-by-side';

/** The greatest number of avatars. */
export const kMaxAvatars = 12;

/** A file's name without its ending. */
export const nameOf = (file: string): string => file.replace(/\.\w+$/, '');

/** What is put into the wardrobe. */
export interface Entry {
  name: string;
  target(): Promise<Model>;
  /** Absent if the cage of the model on the stage is to be fitted. */
  cage?: (() => Promise<Model>) | undefined;
  sample?: Sample | undefined;
  /** What a project has of it until it was read; absent for samples. */
  kept?: KeptAvatar | undefined;
}

/** A model beside the one on the stage. */
interface Standing extends Beside {
  model: Model;
  projection: SplitProjection | undefined;
}

/** One of the models that are painted together. */
export interface Avatar {
  readonly id: number;
  name: string;
  sample: Sample | undefined;
  /** The file, then those it refers to; empty until it was read. */
  files: readonly File[];
  cage: Model | undefined;
  /** Whether its cage was fitted here, and follows that of the model on the stage. */
  follows: boolean;
  locks: Locks;
  /** URL of a picture; empty until it was drawn. */
  picture: string;
  verdict: KnownVerdict;
  /** Of the visible surface, 0..1: what can be painted. */
  paintable: number | undefined;
  /** Whether its cage has the UVs of that of the model on the stage. */
  takesPaint: boolean;
  /** What is being done to it, for people. */
  doing: string;
  /** As projects have it until it was read. */
  kept: KeptAvatar | undefined;
  standing: Standing | undefined;
}
