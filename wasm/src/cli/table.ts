export { percent } from '../inspect/finding.js';

/** Lays rows out in columns; all but the first are set to the right. */
export function table(rows: readonly (readonly string[])[], indent = '  '): string {
  const widths = (rows[0] ?? []).map((_, column) => Math.max(...rows.map((row) => row[column]?.length ?? 0)));
  return rows
    .map(
      (row) =>
        indent +
        row
          .map((cell, column) => (column === 0 ? cell.padEnd(widths[0]!) : cell.padStart(widths[column]!)))
          .join('  ')
          .trimEnd(),
    )
    .join('\n');
}

/** "5,316" */
export function integer(n: number): string {
  return n.toLocaleString('en');
}

/** Four significant digits. */
export function short(n: number): string {
  return Number(n.toPrecision(4)).toString();
}

/** A text cut to a length. */
export function cut(text: string, length: number): string {
  return text.length > length ? `${text.slice(0, length - 1)}…` : text;
}

/** How many times what is asked of it a segment reaches: "0.93", "12", "∞" where nothing is asked. */
export function marginText(margin: number | null): string {
  return margin === null ? '∞' : Number(margin.toPrecision(2)).toString();
}

/** Why a segment is not painted, if it is not: by its areas, or because a hole seems to be meant for it. */
export function fateText({ culled, bared }: { culled: boolean; bared: boolean }): string {
  if (bared) return 'culled: a hole';
  return culled ? 'culled' : '';
}
