import type { Locks } from '../choices';

/** An avatar beside the one on the stage, as projects have it. */
export interface KeptAvatar {
  name: string;
  /** The name of the sample that it is. */
  sample: string | undefined;
  files: readonly File[];
  cage: { files: readonly File[]; sample: string | undefined } | undefined;
  follows: boolean;
  locks: Locks;
  /** 1 for each triangle that was marked to stay bare. */
  bare: Uint8Array | undefined;
}

/** The wardrobe, as projects have it. */
export interface KeptWardrobe {
  /** The place of the one on the stage among all. */
  at: number;
  /** Whether all are shown. */
  all: boolean;
  /** The others. */
  avatars: readonly KeptAvatar[];
}

export const kAlone: KeptWardrobe = { at: 0, all: false, avatars: [] };

/** The wardrobe, as the rest of the page sees it. */
export interface WardrobeOfPage {
  /** Adds dropped files. @param isAsked Whether people want that. @returns False if they are not for it. */
  take(files: readonly File[], isAsked?: boolean): boolean;
  /** What a project has of it. */
  readonly kept: KeptWardrobe;
  restore(kept: KeptWardrobe): void;
  /** Called when it may have changed. */
  onChange: () => void;
}
