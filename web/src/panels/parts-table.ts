import type { Classification, SegmentStats } from 'cagecast';
import { make, swatch } from '../platform/make';
import { element, showNotice } from '../platform/page';
import { bareGroupsOf, type Choice, choiceFor, type Locks } from '../state/choices';
import type { Shown } from '../state/scene';
import type { Session } from '../state/session';
import { cssColor, type Rgb } from '../view/colors';
import { marksOf, segmentColors } from '../view/segments';
import type { Stage } from '../view/stage';
import { nameOfPart, paintedPoints } from './part-menu';

/** A scan may consist of thousands of segments. */
const kMaxRows = 50;
const kMaxColors = 3; // per row
const kMaxNotes = 3; // about parts that are kept
const kLocks: Record<Choice, string> = {
  auto: 'auto',
  keep: 'keep',
  always: 'paint anyway',
  exclude: 'keep bare',
  out: 'leave out',
};

/** Segments that share a row, and their sums. */
interface Entry {
  name: string;
  /** How many it stands for, if more than one. */
  pieces: string;
  segments: number[];
  points: number;
  area: number;
  exposedArea: number;
  coveredArea: number;
  lock: Choice;
}

interface Row {
  segments: readonly number[];
  row: HTMLTableRowElement;
  cover: HTMLElement;
  verdict: HTMLElement;
  choice: HTMLSelectElement;
}

/**
 * The table of a target's segments, called parts on the page: their verdicts, and the user's overrides.
 * Segments of one mesh that the cage does not cover at all, such as thirty teeth, share a row.
 */
export class PartsTable {
  readonly #body = element('segment-rows', HTMLTableSectionElement);
  readonly #session: Session;
  readonly #stage: Stage | undefined;
  #rows: Row[] = [];

  constructor(session: Session, stage: Stage | undefined) {
    this.#session = session;
    this.#stage = stage;
    // Keep the highlight of a tapped row until something else is touched.
    this.#body.addEventListener('pointerleave', ({ pointerType }) => pointerType === 'touch' || this.#highlight([]));
    addEventListener('pointerdown', ({ target }) => this.#body.contains(target as Node) || this.#highlight([]));
    this.#body.addEventListener('focusout', () => this.#highlight([]));
    // Closing the card removes its rows from under the pointer.
    const card = element('parts', HTMLDetailsElement);
    card.addEventListener('toggle', () => card.open || this.#highlight([]));
    session.on('transfer', (shown) => this.#list(shown, session.locks));
    session.on('zones', ({ classification }) => {
      const { segmentStats } = session.shown!.projection;
      const bare = bareGroupsOf(session.shown);
      const chosen = (s: number) => choiceFor(s, segmentStats[s]!.group, session.locks, bare);
      // Locks may have been set elsewhere, even for some segments of a row only.
      const upToDate = this.#rows.every(({ segments, choice }) =>
        segments.every((segment) => chosen(segment) === choice.value),
      );
      if (!upToDate) this.#list(session.shown!, session.locks);
      this.#showVerdicts(classification);
    });
  }

  /** Lists the largest segments of a projection, the least covered first. */
  #list(shown: Shown, locks: Locks): void {
    const entries = entriesOf(shown, locks);
    const colors = segmentColors(shown);
    const largest = named(entries.toSorted((a, b) => b.area - a.area).slice(0, kMaxRows));
    // Sorting is stable: of two with equal coverage the larger comes first.
    const listed = largest.toSorted((a, b) => coverageOf(a) - coverageOf(b));
    this.#rows = listed.map((entry) => this.#row(entry, colors));
    this.#body.replaceChildren(...this.#rows.map(({ row }) => row));
    element('segment-caption', HTMLElement).textContent =
      listed.length < entries.length
        ? `The ${listed.length} largest of ${entries.length.toLocaleString('en')} connected parts, the least covered first.`
        : 'All connected parts, the least covered first.';
  }

  /** Shows the verdict of each row. */
  #showVerdicts({ segmentStats, zones }: Classification): void {
    const shown = this.#session.shown!;
    const { leftOut } = shown.projection;
    for (const { segments, cover, verdict } of this.#rows) {
      // Segments that share a row are all uncovered and have the same lock, hence the same verdict.
      const { culled, group } = segmentStats[segments[0]!]!;
      const isOut = leftOut.includes(group);
      // It changes with every frame of a moving model.
      cover.textContent = isOut ? '–' : coverOf(segments.map((segment) => segmentStats[segment]!));
      verdict.dataset.verdict = culled ? 'culled' : 'passes';
      verdict.textContent = isOut ? 'left out' : verdict.dataset.verdict;
    }
    const kept = Object.entries(this.#session.locks).filter(([, lock]) => lock === 'keep');
    const notes = kept.slice(0, kMaxNotes).map(([key]) => {
      const segment = Number(key);
      return `“${nameOfPart(shown, segment)}” is kept: ${paintedPoints(shown, zones, segment, 'keep')}`;
    });
    showNotice('keep-note', notes.join(' '));
    const real = segmentStats.filter(({ area }) => area > 0);
    const culled = real.filter((segment) => segment.culled).length;
    element('segment-summary', HTMLElement).textContent =
      `${real.length.toLocaleString('en')}, ${culled.toLocaleString('en')} culled`;
  }

  #row(entry: Entry, colors: readonly Rgb[]): Row {
    const { name, pieces, segments, points, lock } = entry;
    const head = make('th', { scope: 'row' }, make('span', { translate: false }, name), pieces);
    head.prepend(swatchOf(segments.slice(0, kMaxColors).map((segment) => colors[segment]!)));
    const choice = this.#select(entry);
    const [cover, verdict] = [make('td'), make('td')];
    const count = make('td', {}, lock === 'out' ? '–' : points.toLocaleString('en'));
    const row = make('tr', {}, head, count, cover, verdict, make('td', {}, choice));
    row.addEventListener('pointerenter', () => this.#highlight(segments));
    row.addEventListener('focusin', () => this.#highlight(segments));
    return { segments, row, cover, verdict, choice };
  }

  #select({ name, pieces, segments, lock }: Entry): HTMLSelectElement {
    const select = make('select', { name: 'lock', ariaLabel: `Override for ${name}${pieces}` });
    for (const [value, text] of Object.entries(kLocks)) select.add(new Option(text, value, false, value === lock));
    select.addEventListener('change', () => this.#session.lock(segments, select.value as Choice));
    return select;
  }

  /** Highlights segments of the target. */
  #highlight(segments: readonly number[]): void {
    const { shown } = this.#session;
    this.#stage?.highlight('parts', shown && marksOf(shown, segments));
  }
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
    const entry = entries.get(key) ?? {
      name: shown.target.mesh.primitives[group]!.name,
      pieces: '',
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

/** Numbers entries of the same name, and adds how many pieces each has. */
function named(entries: Entry[]): Entry[] {
  return entries.map((entry) => {
    const namesakes = entries.filter(({ name }) => name === entry.name);
    const number = namesakes.length > 1 ? ` ${namesakes.indexOf(entry) + 1}` : '';
    const pieces = entry.segments.length > 1 ? `, ${entry.segments.length} pieces` : '';
    return { ...entry, name: `${entry.name}${number}`, pieces };
  });
}

/** The covered share of the exposed area of segments, as text. */
function coverOf(stats: readonly SegmentStats[]): string {
  const sum = (area: 'exposedArea' | 'coveredArea' | 'beyondArea'): number =>
    stats.reduce((total, segment) => total + segment[area], 0);
  const exposedArea = sum('exposedArea');
  if (exposedArea > 0) return percent(sum('coveredArea') / exposedArea);
  return sum('beyondArea') > 0 ? 'beyond' : 'hidden';
}

function coverageOf({ exposedArea, coveredArea }: Entry): number {
  return exposedArea > 0 ? coveredArea / exposedArea : 0;
}

/** The colours of segments in the view “Parts”, side by side. */
function swatchOf(colors: readonly Rgb[]): HTMLElement {
  const stops = colors.map(
    (color, i) => `${cssColor(color)} ${(100 * i) / colors.length}% ${(100 * (i + 1)) / colors.length}%`,
  );
  return swatch(`linear-gradient(to right, ${stops.join(', ')})`);
}

/** Rounded down: 100 % only if nothing is missing, and 0 % only if there is nothing. */
function percent(share: number): string {
  if (share > 0 && share < 0.01) return '< 1 %';
  return `${Math.floor(100 * share)} %`;
}
