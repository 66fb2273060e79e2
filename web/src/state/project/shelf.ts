/** What the page remembers beside the stored works. */
export interface Flags {
  /** Whether there are stored works; `opening` while one is being brought back. */
  work: 'kept' | 'opening';
  /** The slot of this tab. */
  slot: string;
  /** Whether this tab starts over. */
  start: 'over';
}

/** A saved state of the page. */
export interface Work {
  slot: string;
  /** Milliseconds since 1970. */
  at: number;
  /** The fragment of the page's URL. */
  fragment: string;
  /** The version of the parts. */
  version: number;
  parts: Record<string, unknown>;
  /** Keys of the files in the parts. */
  files: string[];
}

/** Keeps works and their files. All methods fail if the browser does not allow it, or has no room. */
export interface WorkStore {
  /** All works, the latest first. */
  works(): Promise<Work[]>;
  /** Keys of all files. */
  keys(): Promise<Set<unknown>>;
  file(key: string): Promise<Blob | undefined>;
  /**
   * Saves a work with its new files, all or nothing, and drops what is no longer needed: old works and their files.
   * @param open Slots whose works are not dropped.
   * @returns False, and nothing is saved, if another of its files is not there any more.
   */
  put(work: Work, files: ReadonlyMap<string, Blob>, open: ReadonlySet<string>): Promise<boolean>;
}

/** Where a tab keeps its works, and what it knows of the other tabs. */
export interface Shelf {
  open(): Promise<WorkStore>;
  flags: {
    get<Name extends keyof Flags>(name: Name): Flags[Name] | undefined;
    set<Name extends keyof Flags>(name: Name, value: Flags[Name] | undefined): void;
  };
  /**
   * Holds a slot until it is let go, or the tab is closed or reloaded, so that no other tab stores its work there.
   * @param patience Milliseconds to wait for a tab that holds it.
   * @returns Whether it is held; true where browsers cannot say.
   */
  hold(slot: string, patience: number): Promise<boolean>;
  /** Lets a slot go that this tab holds. */
  letGo(slot: string): void;
  /** The slots that tabs hold; none where browsers cannot say. */
  held(): Promise<Set<string>>;
  /** The fragment of the page's URL. */
  readonly fragment: string;
  /** Whether a fragment is a link to a state. */
  isLink(fragment: string): boolean;
  /** Opens the page as at first. */
  startOver(): void;
}
