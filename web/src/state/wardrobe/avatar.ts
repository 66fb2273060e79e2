import type { Classification } from 'cagecast';
import type { Locks } from '../choices';
import type { Model } from '../model';
import type { Sample } from '../sample';
import type { SplitProjection } from '../transfers';
import type { KnownVerdict } from '../verdict';
import type { KeptAvatar } from './kept';

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

/** A model that stands beside the one on the stage, as it is drawn. */
export interface Figure {
  readonly model: Model;
  /** Absent without a cage. */
  readonly projection: SplitProjection | undefined;
  /** Whether the paint fits it. */
  takesPaint: boolean;
  setProjection(projection: SplitProjection): void;
  classify(classification: Classification): void;
  /** Takes it away and frees its memory, but not its model's. */
  dispose(): void;
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
  standing: Figure | undefined;
}
