import type { Command } from 'commander';
import { standard } from '../gltf/files.js';
import { writeStandard } from './output.js';

// What a terminal obeys instead of showing: control characters, and marks that turn the direction of text.
const kCommands = /(?![\n\t])[\p{Cc}\p{Bidi_Control}]/gu;

/** A text with names from files in it, harmless to print: "\u001b" for an escape character, as in JSON, where it means the same. */
function harmless(text: string): string {
  return text.replace(kCommands, escaped);
}

/** The same for a line: names cannot break it. */
export function oneLine(text: string): string {
  return harmless(text).replace(/[\t\n\u2028\u2029]/g, escaped);
}

/** A value as JSON that is harmless to print, a line of its own. @param indent  Spaces per level. Default: all on one line */
export const jsonText = (value: unknown, indent?: number): string =>
  `${harmless(JSON.stringify(value, null, indent))}\n`;

const escaped = (character: string): string => `\\u${character.charCodeAt(0).toString(16).padStart(4, '0')}`;

/** The flags that say what is printed, as commander parses them. */
export interface PrintFlags {
  json?: boolean;
  quiet?: boolean;
}

/** Adds the flags that say what is printed. */
export const addPrintFlags = (command: Command): Command =>
  command.option('--json', 'print JSON').option('--quiet', 'print nothing but errors');

/** What a command found: for people, and for programs. */
export interface Found {
  lines: readonly string[];
  report: object;
}

/**
 * Prints what a command found: on the standard output, or beside it if a file is written there.
 * @param outputs  The names of written files.
 */
export function print(
  { lines, report }: Found,
  { json = false, quiet = false }: PrintFlags,
  outputs: readonly (string | undefined)[] = [],
): void {
  if (quiet) return;
  const found = json ? jsonText(report, 2) : `${lines.map(oneLine).join('\n')}\n`;
  if (outputs.includes(standard)) process.stderr.write(found);
  else writeStandard(found);
}
