const kName = 'cagecast';
/** Of the database; another page with a newer one refuses this one. */
const kVersion = 1;
const kMostWorks = 3;

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

/** Keeps works and their files in IndexedDB. All methods fail if the browser does not allow it, or has no room. */
export class Store {
  readonly #database: IDBDatabase;

  private constructor(database: IDBDatabase) {
    this.#database = database;
    // So that a newer page can open a newer one.
    database.onversionchange = () => database.close();
  }

  static async open(): Promise<Store> {
    const request = indexedDB.open(kName, kVersion);
    request.onupgradeneeded = () => {
      request.result.createObjectStore('works', { keyPath: 'slot' });
      request.result.createObjectStore('files');
    };
    return new Store(await resultOf(request));
  }

  /** All works, the latest first. */
  async works(): Promise<Work[]> {
    const all: Work[] = await resultOf(this.#database.transaction('works').objectStore('works').getAll());
    return all.toSorted((a, b) => b.at - a.at);
  }

  async file(key: string): Promise<Blob | undefined> {
    return resultOf(this.#database.transaction('files').objectStore('files').get(key));
  }

  /** Saves a work with its new files, all or nothing, and drops what is no longer needed: old works and their files. */
  async put(work: Work, files: ReadonlyMap<string, Blob>): Promise<void> {
    const transaction = this.#database.transaction(['works', 'files'], 'readwrite');
    let failure: unknown;
    const done = new Promise<void>((resolve, reject) => {
      transaction.oncomplete = () => resolve();
      transaction.onabort = () => reject(transaction.error ?? failure);
    });
    try {
      const [worksOf, filesOf] = [transaction.objectStore('works'), transaction.objectStore('files')];
      for (const [key, file] of files) filesOf.put(file, key);
      worksOf.put(work);
      const all = (await resultOf(worksOf.getAll())) as Work[];
      const kept = all.toSorted((a, b) => b.at - a.at).slice(0, kMostWorks);
      for (const { slot } of all) if (!kept.some((one) => one.slot === slot)) worksOf.delete(slot);
      const used = new Set(kept.flatMap((one) => one.files));
      for (const key of await resultOf(filesOf.getAllKeys())) if (!used.has(key as string)) filesOf.delete(key);
    } catch (error) {
      failure = error;
      if (transaction.error === null) transaction.abort();
    }
    await done;
  }
}

function resultOf<Result>(request: IDBRequest<Result>): Promise<Result> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}
