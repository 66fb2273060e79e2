import type { Work, WorkStore } from '../state/project/shelf';

const kName = 'cagecast';
/** Of the database; another page with a newer one refuses this one. */
const kVersion = 1;
const kMaxWorks = 3; // beside those of open tabs

/** Keeps works and their files in IndexedDB. All methods fail if the browser does not allow it, or has no room. */
export class Store implements WorkStore {
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

  async works(): Promise<Work[]> {
    const all: Work[] = await resultOf(this.#database.transaction('works').objectStore('works').getAll());
    return all.toSorted((a, b) => b.at - a.at);
  }

  async keys(): Promise<Set<IDBValidKey>> {
    return new Set(await resultOf(this.#database.transaction('files').objectStore('files').getAllKeys()));
  }

  async file(key: string): Promise<Blob | undefined> {
    return resultOf(this.#database.transaction('files').objectStore('files').get(key));
  }

  async put(work: Work, files: ReadonlyMap<string, Blob>, open: ReadonlySet<string>): Promise<boolean> {
    const transaction = this.#database.transaction(['works', 'files'], 'readwrite');
    let failure: unknown;
    let isWhole = true;
    const done = new Promise<boolean>((resolve, reject) => {
      transaction.oncomplete = () => resolve(true);
      transaction.onabort = () => (isWhole ? reject(transaction.error ?? failure) : resolve(false));
    });
    try {
      const [worksOf, filesOf] = [transaction.objectStore('works'), transaction.objectStore('files')];
      for (const [key, file] of files) filesOf.put(file, key);
      worksOf.put(work);
      const keys = await resultOf(filesOf.getAllKeys());
      isWhole = work.files.every((key) => keys.includes(key));
      if (!isWhole) transaction.abort();
      else {
        const all = ((await resultOf(worksOf.getAll())) as Work[]).toSorted((a, b) => b.at - a.at);
        const kept = all.filter(({ slot }, at) => at < kMaxWorks || open.has(slot));
        for (const one of all) if (!kept.includes(one)) worksOf.delete(one.slot);
        const used = new Set<IDBValidKey>(kept.flatMap((one) => one.files));
        for (const key of keys) if (!used.has(key)) filesOf.delete(key);
      }
    } catch (error) {
      failure = error;
      if (transaction.error === null) transaction.abort();
    }
    return done;
  }
}

function resultOf<Result>(request: IDBRequest<Result>): Promise<Result> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}
