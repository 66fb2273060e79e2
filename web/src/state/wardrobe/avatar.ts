import type { Classification } from 'cagecast';
import type { Texture } from 'three';
import type { Locks } from '../choices';
import type { Model } from '../model';
import type { Paint } from '../paint';
import type { Sample } from '../sample';
import type { SplitProjection } from '../transfers';
import type { KnownVerdict } from '../verdict/verdict';
import type { KeptAvatar } from './kept';

/** The greatest number of avatars. */
export const kMaxAvatars = 12;

/** A file's name without its ending. */
export const nameOf = (file: string): string => file.replace(/\.\w+$/, '');

/** What is put into the wardrobe. */
export interface Entry {
  name: string;
  target(): Promise<Model>;
  /** Absent if it is to get one: the user's own that is on the stage, or the one that is chosen for it. */
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
  /** Shows the paint of the stage, one of its own, or none, as in the beginning. */
  setPaint(paint: 'stage' | Texture | undefined): void;
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
  verdict: KnownVerdict;
  /** Whether its cage has the UVs of that of the model on the stage. */
  takesPaint: boolean;
  /** The base paint, drawn for its own cage, which has other UVs. */
  own: { paint: Paint; cage: Model } | undefined;
  /** What is being done to it, for people. */
  doing: string;
  /** As projects have it until it was read. */
  kept: KeptAvatar | undefined;
  standing: Figure | undefined;
}
