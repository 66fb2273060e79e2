import type { Flags, Shelf } from '../state/project/shelf';
import { Store } from './store';

const storageOf = (name: keyof Flags): Storage => (name === 'work' ? localStorage : sessionStorage);

/** Browsers may forbid them; the page works all the same. */
export const flags = {
  get<Name extends keyof Flags>(name: Name): Flags[Name] | undefined {
    try {
      return (storageOf(name).getItem(`cagecast-${name}`) as Flags[Name] | null) ?? undefined;
    } catch {
      return undefined;
    }
  },
  set<Name extends keyof Flags>(name: Name, value: Flags[Name] | undefined): void {
    try {
      if (value === undefined) storageOf(name).removeItem(`cagecast-${name}`);
      else storageOf(name).setItem(`cagecast-${name}`, value);
    } catch {
      // As if it had never been set.
    }
  },
};

const kLock = 'cagecast ';
/** Ends the hold of slots that this tab holds. */
const releases = new Map<string, () => void>();

function hold(slot: string, patience: number): Promise<boolean> {
  const { locks } = navigator;
  if (!locks) return Promise.resolve(true);
  return new Promise((done) => {
    const options = patience > 0 ? { signal: AbortSignal.timeout(patience) } : { ifAvailable: true };
    locks
      .request(kLock + slot, options, (lock) => {
        done(lock !== null);
        return lock && new Promise<void>((release) => releases.set(slot, release));
      })
      .catch(() => done(false));
  });
}

function letGo(slot: string): void {
  releases.get(slot)?.();
  releases.delete(slot);
}

async function held(): Promise<Set<string>> {
  const { held = [] } = (await navigator.locks?.query()) ?? {};
  return new Set(held.flatMap(({ name = '' }) => (name.startsWith(kLock) ? [name.slice(kLock.length)] : [])));
}

/** Keeps works in this browser. @param isLink Whether a fragment of the URL is a link to a state. */
export const shelfOf = (isLink: (fragment: string) => boolean): Shelf => ({
  open: Store.open,
  flags,
  hold,
  letGo,
  held,
  get fragment() {
    return location.hash;
  },
  isLink,
  startOver: () => location.replace(location.pathname + location.search),
});
