import type { Classification, SegmentStats } from 'cagecast';
import { download } from '../../platform/download';
import { make, swatch } from '../../platform/make';
import { element, showNotice } from '../../platform/page';
import { bareGroupsOf, type Choice, choiceFor } from '../../state/choices';
import type { Shown } from '../../state/scene';
import type { Session } from '../../state/session';
import { partsCsv } from '../../state/study/csv';
import { type Branch, type Entry, isSought, type Sought, treeOf } from '../../state/study/parts';
import { cssColor, type Rgb } from '../../view/colors';
import { marksOf, segmentColors } from '../../view/segments';
import type { Stage } from '../../view/stage';
import { nameOfPart, paintedPoints } from '../part-menu';

const kMaxColors = 3; // per row
const kMaxNotes = 3; // about parts that are kept
const kLocks: Record<Choice, string> = {
  auto: 'auto',
  keep: 'keep',
  always: 'paint anyway',
  exclude: 'keep bare',
  out: 'leave out',
};

interface Row {
  entry: Entry;
  row: HTMLTableRowElement;
  cover: HTMLElement;
  verdict: HTMLElement;
  choice: HTMLSelectElement;
  /** Of its mesh, if that has several rows. */
  branch: { row: HTMLTableRowElement; button: HTMLButtonElement; name: string } | undefined;
}

/** The tree of a target's segments, called parts on the page: by mesh, with their verdicts, the user's overrides, and a search. */
export class PartsTree {
  readonly #body = element('segment-rows', HTMLTableSectionElement);
  readonly #search = element('parts-search', HTMLInputElement);
  readonly #state = element('parts-state', HTMLSelectElement);
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
    for (const field of [this.#search, this.#state]) field.addEventListener('input', () => this.#seek());
    element('parts-csv', HTMLButtonElement).addEventListener('click', () => {
      const { shown, classification } = session;
      if (shown && classification)
        download(new Blob([partsCsv(shown, classification)], { type: 'text/csv' }), `${shown.target.name}-parts.csv`);
    });
    session.on('transfer', (shown) => this.#list(shown));
    session.on('zones', ({ classification }) => {
      const { segmentStats } = session.shown!.projection;
      const bare = bareGroupsOf(session.shown);
      const chosen = (s: number) => choiceFor(s, segmentStats[s]!.group, session.locks, bare);
      // Locks may have been set elsewhere, even for some segments of a row only.
      const upToDate = this.#rows.every(({ entry, choice }) =>
        entry.segments.every((segment) => chosen(segment) === choice.value),
      );
      if (!upToDate) this.#list(session.shown!);
      this.#showVerdicts(classification);
      this.#seek();
    });
  }

  #list(shown: Shown): void {
    const { branches, listed, all } = treeOf(shown, this.#session.locks);
    const colors = segmentColors(shown);
    this.#rows = branches.flatMap((branch) => this.#branch(branch, colors));
    this.#body.replaceChildren(
      ...new Set(this.#rows.flatMap(({ row, branch }) => (branch ? [branch.row, row] : [row]))),
    );
    element('segment-caption', HTMLElement).textContent =
      listed < all
        ? `The ${listed} largest of ${all.toLocaleString('en')} connected parts, the least covered first.`
        : 'All connected parts, the least covered first.';
  }

  /** The rows of a mesh; of several, below one that opens and closes them. */
  #branch({ name, entries }: Branch, colors: readonly Rgb[]): Row[] {
    if (entries.length === 1) return [this.#row(entries[0]!, colors, undefined)];
    const button = make('button', { type: 'button', ariaExpanded: 'true', translate: false }, `▾ ${name}`);
    const head = make('th', { scope: 'rowgroup', colSpan: 5 }, button, ` ${entries.length}`);
    const row = make('tr', { className: 'mesh' }, head);
    button.addEventListener('click', () => {
      const opens = button.ariaExpanded !== 'true';
      button.ariaExpanded = String(opens);
      button.textContent = `${opens ? '▾' : '▸'} ${name}`;
      this.#seek();
    });
    const all = entries.flatMap(({ segments }) => segments);
    for (const event of ['pointerenter', 'focusin']) row.addEventListener(event, () => this.#highlight(all));
    return entries.map((entry) => this.#row(entry, colors, { row, button, name }));
  }

  /** Shows the rows that are sought. */
  #seek(): void {
    const { classification } = this.#session;
    if (!classification) return;
    const sought: Sought = { text: this.#search.value, state: this.#state.value as Sought['state'] };
    const seen = new Set<HTMLElement>();
    for (const { entry, row, branch } of this.#rows) {
      const isFound = isSought(entry, classification.segmentStats[entry.segments[0]!]!, sought);
      if (isFound && branch) seen.add(branch.row);
      row.hidden = !isFound || branch?.button.ariaExpanded === 'false';
    }
    for (const { branch } of this.#rows) if (branch) branch.row.hidden = !seen.has(branch.row);
  }

  /** Shows the verdict of each row. */
  #showVerdicts({ segmentStats, zones }: Classification): void {
    const shown = this.#session.shown!;
    const { leftOut } = shown.projection;
    for (const { entry, cover, verdict } of this.#rows) {
      // Segments that share a row are all uncovered and have the same lock, hence the same verdict.
      const { culled, group } = segmentStats[entry.segments[0]!]!;
      const isOut = leftOut.includes(group);
      // It changes with every frame of a moving model.
      cover.textContent = isOut ? '–' : coverOf(entry.segments.map((segment) => segmentStats[segment]!));
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

  #row(entry: Entry, colors: readonly Rgb[], branch: Row['branch']): Row {
    const { name, pieces, segments, points, lock } = entry;
    // Below the name of its mesh, its number is enough to be seen.
    const [common, own] = branch ? [branch.name, name.slice(branch.name.length)] : ['', name];
    const named = [
      make('span', { className: 'unseen', translate: false }, common),
      make('span', { translate: false }, own),
    ];
    const head = make('th', { scope: 'row', title: name }, ...named, pieces);
    head.prepend(swatchOf(segments.slice(0, kMaxColors).map((segment) => colors[segment]!)));
    const choice = this.#select(entry);
    const [cover, verdict] = [make('td'), make('td')];
    const count = make('td', {}, lock === 'out' ? '–' : points.toLocaleString('en'));
    const row = make('tr', { className: branch ? 'piece' : '' }, head, count, cover, verdict, make('td', {}, choice));
    for (const event of ['pointerenter', 'focusin']) row.addEventListener(event, () => this.#highlight(segments));
    return { entry, row, cover, verdict, choice, branch };
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

/** The covered share of the exposed area of segments, as text. */
function coverOf(stats: readonly SegmentStats[]): string {
  const sum = (area: 'exposedArea' | 'coveredArea' | 'beyondArea'): number =>
    stats.reduce((total, segment) => total + segment[area], 0);
  const exposedArea = sum('exposedArea');
  if (exposedArea > 0) return percent(sum('coveredArea') / exposedArea);
  return sum('beyondArea') > 0 ? 'beyond' : 'hidden';
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
