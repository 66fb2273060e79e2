import type { CagecastError } from 'cagecast';

const kWords: Record<string, string> = { segment: 'part', target: 'model', Target: 'Model' };

/** A text of the package in the page's words: parts instead of segments, the model instead of the target. Names, in quotes, stay. */
export const forPeople = (text: string): string =>
  text.replace(/"[^"]*"|“[^”]*”|\b(segment|target|Target)/g, (found, word?: string) => kWords[word ?? ''] ?? found);

/** The message of an error, without the name of the package's function that threw it. */
export const reasonOf = (error: unknown): string => (error as CagecastError).reason ?? (error as Error).message;
