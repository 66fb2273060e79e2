import type { Segment } from '../inspect/index.js';
import { oneLine } from './print.js';

export { percent } from '../inspect/finding.js';

/** Lays out rows in columns, an indented line for each; all but the first column are right-aligned. */
export function table(rows: readonly (readonly string[])[]): string[] {
  const widths = (rows[0] ?? []).map((_, column) => Math.max(...rows.map((row) => row[column]?.length ?? 0)));
  return rows.map(
    (row) =>
      '  ' +
      row
        .map((cell, column) => (column === 0 ? cell.padEnd(widths[0]!) : cell.padStart(widths[column]!)))
        .join('  ')
        .trimEnd(),
  );
}

/** "5,316" */
export function integer(n: number): string {
  return n.toLocaleString('en');
}

/** What became of the overlays of an earlier transfer. */
export function takenAway(overlays: number): string {
  return `took away ${integer(overlays)} overlay${overlays === 1 ? '' : 's'} of an earlier transfer`;
}

/** Four significant digits. */
export function short(n: number): string {
  return Number(n.toPrecision(4)).toString();
}

/** A text in one line, cut to a length. */
export function cut(name: string, length: number): string {
  const text = oneLine(name);
  return text.length > length ? `${text.slice(0, length - 1)}…` : text;
}

/** The first names of a list, and how many more there are. @param hint  Where those are. */
export const listed = (names: readonly string[], most: number, hint = ''): string =>
  `${names.slice(0, most).join(', ')}${names.length > most ? `, and ${names.length - most} more${hint}` : ''}`;

/** The columns of a table of segments, after those that name it. */
export const segmentColumns = ['points', 'exposed E', 'covered C', 'F = C/E', 'score', ''];

/** A segment in these columns. */
export const segmentCells = ({ points, exposedArea, coveredArea, coverage, score, culledBy }: Segment): string[] => [
  integer(points),
  short(exposedArea),
  short(coveredArea),
  coverage.toFixed(3),
  scoreText(score),
  fateText(culledBy),
];

/** A segment's score: "0.93", "12", "∞" if it needs no area. */
function scoreText(score: number | null): string {
  return score === null ? '∞' : Number(score.toPrecision(2)).toString();
}

/** Why a segment is not painted, if it is not. */
function fateText(culledBy: Segment['culledBy']): string {
  return { none: '', coverage: 'culled', hole: 'culled (hole)', lock: 'culled (lock)' }[culledBy];
}
