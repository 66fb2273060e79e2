import type { Classification, Lock, SegmentStats } from 'cagecast';
import { element } from '../platform/page';
import type { Part } from '../scene/extract';
import type { Locks, Session, Shown } from '../scene/session';
import { cssColor, type Rgb } from '../view/colors';
import { segmentColors, trianglesOf } from '../view/segments';
import type { Viewer } from '../view/viewer';

/** Rows enough to read; a scan may fall into thousands of pieces. */
const kMostRows = 50;
const kMostColors = 3; // of those that share a row
const kLocks: Record<Lock, string> = { auto: 'auto', keep: 'keep', exclude: 'exclude' };

/** Segments that are listed as one, and their numbers together. */
interface Entry {
  name: string;
  segments: number[];
  points: number;
  area: number;
  exposedArea: number;
  coveredArea: number;
  lock: Lock;
}

interface Row {
  segments: readonly number[];
  row: HTMLTableRowElement;
  cover: HTMLElement;
  verdict: HTMLElement;
  choice: HTMLSelectElement;
}

/**
 * The table of a target's segments, which its panel calls parts: how each fared, and what the visitor says about it.
 * Segments of one mesh of which the cage covers nothing, as thirty teeth in a mouth, share a row.
 */
export class PartsTable {
  readonly #body = element('segment-rows', HTMLTableSectionElement);
  readonly #session: Session;
  readonly #viewer: Viewer | undefined;
  #rows: Row[] = [];

  constructor(session: Session, viewer: Viewer | undefined) {
    this.#session = session;
    this.#viewer = viewer;
    // A finger that was lifted still points, until it touches something else.
    this.#body.addEventListener('pointerleave', ({ pointerType }) => pointerType === 'touch' || this.#light([]));
    addEventListener('pointerdown', ({ target }) => this.#body.contains(target as Node) || this.#light([]));
    this.#body.addEventListener('focusout', () => this.#light([]));
    // A card that is closed under the pointer no longer points at anything.
    const card = element('parts', HTMLDetailsElement);
    card.addEventListener('toggle', () => card.open || this.#light([]));
    session.on('transfer', (shown) => this.#list(shown, session.locks));
    session.on('zones', ({ classification }) => {
      // Something else than the table may have locked parts, even some that share a row.
      const told = this.#rows.every(({ segments, choice }) =>
        segments.every((segment) => (session.locks[segment] ?? 'auto') === choice.value),
      );
      if (!told) this.#list(session.shown!, session.locks);
      this.#showVerdicts(classification);
    });
  }

  /** Lists the segments of another target, or of another projection of it: the largest, those that are covered least first. */
  #list(shown: Shown, locks: Locks): void {
    const entries = entriesOf(shown.projection.segmentStats, shown.target.mesh.parts, locks);
    const colors = segmentColors(shown);
    const largest = named(entries.toSorted((a, b) => b.area - a.area).slice(0, kMostRows));
    // Sorting is stable: the larger of two that are covered alike stays before the smaller.
    const listed = largest.toSorted((a, b) => coverageOf(a) - coverageOf(b));
    this.#rows = listed.map((entry) => this.#row(entry, colors));
    this.#body.replaceChildren(...this.#rows.map(({ row }) => row));
    element('segment-caption', HTMLElement).textContent =
      listed.length < entries.length
        ? `The ${listed.length} largest of ${entries.length.toLocaleString('en')} connected parts, those the cage covers least first.`
        : 'Each connected part, those the cage covers least first.';
  }

  /** Writes which segments may be painted, and which may not. */
  #showVerdicts({ segmentStats }: Classification): void {
    for (const { segments, cover, verdict } of this.#rows) {
      // It changes with every frame of a model that moves.
      cover.textContent = coverOf(segments.map((segment) => segmentStats[segment]!));
      // Those that share a row share its verdict: nothing of any of them is covered, and the same was said about all.
      const { culled } = segmentStats[segments[0]!]!;
      verdict.textContent = culled ? 'culled' : 'passes';
      verdict.dataset.verdict = verdict.textContent;
    }
    const real = segmentStats.filter(({ area }) => area > 0);
    const culled = real.filter((segment) => segment.culled).length;
    element('segment-summary', HTMLElement).textContent =
      `${real.length.toLocaleString('en')}, ${culled.toLocaleString('en')} culled`;
  }

  #row(entry: Entry, colors: readonly Rgb[]): Row {
    const { name, segments, points } = entry;
    const row = document.createElement('tr');
    const head = cell('th', name);
    head.scope = 'row';
    head.prepend(swatch(segments.slice(0, kMostColors).map((segment) => colors[segment]!)));
    const verdict = cell('td', '');
    const choice = this.#select(entry);
    const last = document.createElement('td');
    last.append(choice);
    const cover = cell('td', '');
    row.append(head, cell('td', points.toLocaleString('en')), cover, verdict, last);
    row.addEventListener('pointerenter', () => this.#light(segments));
    row.addEventListener('focusin', () => this.#light(segments));
    return { segments, row, cover, verdict, choice };
  }

  #select({ name, segments, lock }: Entry): HTMLSelectElement {
    const select = document.createElement('select');
    select.name = 'lock';
    select.setAttribute('aria-label', `Say about ${name}`);
    for (const [value, text] of Object.entries(kLocks)) select.add(new Option(text, value, false, value === lock));
    select.addEventListener('change', () => this.#session.lock(segments, select.value as Lock));
    return select;
  }

  /** Lights up segments of the target, or none. */
  #light(segments: readonly number[]): void {
    const { shown } = this.#session;
    this.#viewer?.highlight(shown ? trianglesOf(shown, segments) : []);
  }
}

/** The segments that have triangles, as they are listed, in the order of their vertices. */
function entriesOf(stats: readonly SegmentStats[], parts: readonly Part[], locks: Locks): Entry[] {
  const entries = new Map<string, Entry>();
  stats.forEach(({ points, area, exposedArea, coveredArea, group }, segment) => {
    if (area === 0) return;
    const lock = locks[segment] ?? 'auto';
    const key = coveredArea > 0 ? `segment ${segment}` : `group ${group} ${exposedArea > 0} ${lock}`;
    const entry = entries.get(key) ?? {
      name: parts[group]!.name,
      segments: [],
      points: 0,
      area: 0,
      exposedArea: 0,
      coveredArea: 0,
      lock,
    };
    entry.segments.push(segment);
    entry.points += points;
    entry.area += area;
    entry.exposedArea += exposedArea;
    entry.coveredArea += coveredArea;
    entries.set(key, entry);
  });
  return [...entries.values()];
}

/** Numbers those of one name, in the order they come in, and says how many pieces each is of. */
function named(entries: Entry[]): Entry[] {
  return entries.map((entry) => {
    const namesakes = entries.filter(({ name }) => name === entry.name);
    const number = namesakes.length > 1 ? ` ${namesakes.indexOf(entry) + 1}` : '';
    const pieces = entry.segments.length > 1 ? `, ${entry.segments.length} pieces` : '';
    return { ...entry, name: `${entry.name}${number}${pieces}` };
  });
}

/** What share of the exposed area of segments is covered, in words. */
function coverOf(stats: readonly SegmentStats[]): string {
  const sum = (area: 'exposedArea' | 'coveredArea'): number =>
    stats.reduce((total, segment) => total + segment[area], 0);
  const exposedArea = sum('exposedArea');
  return exposedArea > 0 ? percent(sum('coveredArea') / exposedArea) : 'hidden';
}

function coverageOf({ exposedArea, coveredArea }: Entry): number {
  return exposedArea > 0 ? coveredArea / exposedArea : 0;
}

/** The colours of segments in the picture that shows each in its own, side by side. */
function swatch(colors: readonly Rgb[]): HTMLElement {
  const made = document.createElement('i');
  made.className = 'swatch';
  const stops = colors.map(
    (color, i) => `${cssColor(color)} ${(100 * i) / colors.length}% ${(100 * (i + 1)) / colors.length}%`,
  );
  made.style.background = `linear-gradient(to right, ${stops.join(', ')})`;
  return made;
}

function cell(type: 'td' | 'th', text: string): HTMLTableCellElement {
  const made = document.createElement(type);
  made.textContent = text;
  return made;
}

/** Up to 100 % only where nothing is missing, and 0 % only where nothing is there. */
function percent(share: number): string {
  if (share > 0 && share < 0.01) return '< 1 %';
  return `${Math.floor(100 * share)} %`;
}
