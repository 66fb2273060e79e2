/** What the page remembers beside the stored works. */
interface Flags {
  /** Whether there are stored works; `opening` while one is being brought back. */
  work: 'kept' | 'opening';
  /** The slot of this tab. */
  slot: string;
  /** Whether this tab starts over. */
  start: 'over';
}

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

/**
 * Holds a slot until it is let go, or the tab is closed or reloaded, so that no other tab stores its work there.
 * @param patience Milliseconds to wait for a tab that holds it.
 * @returns Whether it is held; true where browsers cannot tell.
 */
export function holdSlot(slot: string, patience: number): Promise<boolean> {
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

/** Lets a slot go that this tab holds. */
export function letGoOf(slot: string): void {
  releases.get(slot)?.();
  releases.delete(slot);
}

/** The slots that tabs hold; none where browsers cannot tell. */
export async function heldSlots(): Promise<Set<string>> {
  const { held = [] } = (await navigator.locks?.query()) ?? {};
  return new Set(held.flatMap(({ name = '' }) => (name.startsWith(kLock) ? [name.slice(kLock.length)] : [])));
}
