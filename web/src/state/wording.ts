import type { CagecastError } from 'cagecast';

/** A text of the package in the page's words: parts instead of segments, the model instead of the target. */
export const forPeople = (text: string): string =>
  text
    .replace(/\bsegment/g, 'part')
    .replace(/\btarget/g, 'model')
    .replace(/\bTarget/g, 'Model');

/** The message of an error, without the name of the package's function that threw it. */
export const reasonOf = (error: unknown): string => (error as CagecastError).reason ?? (error as Error).message;
