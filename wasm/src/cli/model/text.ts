// Texts for people and programs. Names from files may be in them.

// What a terminal obeys instead of showing: control characters, and marks that turn the direction of text.
const kCommands = /(?![\n\t])[\p{Cc}\p{Bidi_Control}]/gu;

const escaped = (character: string): string => `\\u${character.charCodeAt(0).toString(16).padStart(4, '0')}`;

/** Harmless to print: "\u001b" for an escape character, as in JSON, where it means the same. */
const harmless = (text: string): string => text.replace(kCommands, escaped);

/** Harmless to print, in one line: names cannot break it. */
export const oneLine = (text: string): string => harmless(text).replace(/[\t\n\u2028\u2029]/g, escaped);

/** A value as JSON that is harmless to print, a line of its own. @param indent  Spaces per level. Default: all on one line */
export const jsonText = (value: unknown, indent?: number): string =>
  `${harmless(JSON.stringify(value, null, indent))}\n`;

/** A text in one line, cut to a length. */
export function cut(name: string, length: number): string {
  const text = oneLine(name);
  return text.length > length ? `${text.slice(0, length - 1)}…` : text;
}

/** How many characters of a name a message shows at most. */
export const kMaxCharacters = 60;

/** A name in a message. */
export const quoted = (name: string): string => `"${cut(name, kMaxCharacters)}"`;

/** A value in a message. JSON has no infinite numbers. */
export const shown = (value: unknown): string =>
  cut(typeof value === 'number' ? String(value) : JSON.stringify(value), kMaxCharacters);

/** The first names of a list, and how many more there are. @param hint  Where those are. */
export const listed = (names: readonly string[], most: number, hint = ''): string =>
  `${names.slice(0, most).join(', ')}${names.length > most ? `, and ${names.length - most} more${hint}` : ''}`;

/** Lays out rows in columns, an indented line for each; all but the first column are right-aligned. */
export function table(rows: readonly (readonly string[])[]): string[] {
  const widths = rows[0]!.map((_, column) => Math.max(...rows.map((row) => row[column]!.length)));
  const pad = (cell: string, column: number) =>
    column === 0 ? cell.padEnd(widths[0]!) : cell.padStart(widths[column]!);
  return rows.map((row) => `  ${row.map(pad).join('  ').trimEnd()}`);
}

/** "5,316" */
export const integer = (n: number): string => n.toLocaleString('en');

/** Four significant digits. */
export const short = (n: number): string => Number(n.toPrecision(4)).toString();

/** What became of the overlays of an earlier transfer. */
export const takenAway = (overlays: number): string =>
  `took away ${integer(overlays)} overlay${overlays === 1 ? '' : 's'} of an earlier transfer`;

/** A line for people, or none. */
export type Line = string | false | undefined;

/** Says which configuration file settings come from, if there is one. */
export const configLine = (config: string | null | undefined): Line => !!config && `settings from ${config}`;
