import type { SegmentStats } from 'cagecast';
import { bareGroupsOf, type Choice, choiceFor, type Locks } from '../choices';
import type { Shown } from '../scene';

/** A scan may consist of thousands of segments. */
const kMaxEntries = 50;

/** Segments that share a row, and their sums. */
export interface Entry {
  name: string;
  /** How many it stands for, as a text, if more than one. */
  pieces: string;
  group: number;
  segments: number[];
  points: number;
  area: number;
  exposedArea: number;
  coveredArea: number;
  lock: Choice;
}

/** The parts of one mesh. */
export interface Branch {
  name: string;
  entries: Entry[];
}

/** What parts are sought by. */
export interface Sought {
  /** In their names, in any case. */
  text: string;
  state: 'all' | 'painted' | 'culled' | 'chosen';
}

/**
 * The segments of a target as a tree: by mesh, the least covered first. Segments of one mesh that the cage does not cover at all, such
 * as thirty teeth, are one entry. Of very many, the largest are listed.
 * @returns The tree, and how many entries there are in all.
 */
export function treeOf(shown: Shown, locks: Locks): { branches: Branch[]; listed: number; all: number } {
  const entries = entriesOf(shown, locks);
  const largest = named(entries.toSorted((a, b) => b.area - a.area).slice(0, kMaxEntries));
  // Sorting is stable: of two with equal coverage the larger comes first.
  const sorted = largest.toSorted((a, b) => coverageOf(a) - coverageOf(b));
  const groups = [...new Set(sorted.map(({ group }) => group))];
  return {
    branches: groups.map((group) => ({
      name: shown.target.mesh.primitives[group]!.name,
      entries: sorted.filter((entry) => entry.group === group),
    })),
    listed: largest.length,
    all: entries.length,
  };
}

/** Whether an entry is sought. @param stats Of its first segment. */
export function isSought(
  { name, lock }: Entry,
  { culled }: Pick<SegmentStats, 'culled'>,
  { text, state }: Sought,
): boolean {
  const isInState = { all: true, painted: !culled, culled, chosen: lock !== 'auto' }[state];
  return isInState && name.toLowerCase().includes(text.trim().toLowerCase());
}

/** The segments with area, grouped into rows. */
function entriesOf(shown: Shown, locks: Locks): Entry[] {
  const entries = new Map<string, Entry>();
  const bare = bareGroupsOf(shown);
  shown.projection.segmentStats.forEach(({ points, area, exposedArea, coveredArea, group }, segment) => {
    const lock = choiceFor(segment, group, locks, bare);
    // What is left out has no area, but can be taken back.
    if (area === 0 && lock !== 'out') return;
    const key = coveredArea > 0 ? `segment ${segment}` : `group ${group} ${exposedArea > 0} ${lock}`;
    const { name } = shown.target.mesh.primitives[group]!;
    const sums = { points: 0, area: 0, exposedArea: 0, coveredArea: 0 };
    const entry = entries.get(key) ?? { name, pieces: '', group, segments: [], ...sums, lock };
    entry.segments.push(segment);
    entry.points += points;
    entry.area += area;
    entry.exposedArea += exposedArea;
    entry.coveredArea += coveredArea;
    entries.set(key, entry);
  });
  return [...entries.values()];
}

/** Numbers entries of the same name, and adds how many pieces each has. */
function named(entries: Entry[]): Entry[] {
  return entries.map((entry) => {
    const namesakes = entries.filter(({ name }) => name === entry.name);
    const number = namesakes.length > 1 ? ` ${namesakes.indexOf(entry) + 1}` : '';
    const pieces = entry.segments.length > 1 ? `, ${entry.segments.length} pieces` : '';
    return { ...entry, name: `${entry.name}${number}`, pieces };
  });
}

function coverageOf({ exposedArea, coveredArea }: Entry): number {
  return exposedArea > 0 ? coveredArea / exposedArea : 0;
}
