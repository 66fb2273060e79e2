import { show } from '../core/error.js';
import { CagecastError } from '../index.js';

/** Where the paint ends: at existing triangle edges, or at the borders of the cage, along which triangles are cut. */
export type Borders = 'triangle' | 'cut';

/** Whether to cut borders. @throws {CagecastError} `badOption` */
export function isCut(fn: string, borders: Borders = 'triangle'): boolean {
  if (borders !== 'triangle' && borders !== 'cut')
    throw new CagecastError(
      'badOption',
      fn,
      `options.borders = ${show(borders)} is unknown; there are: "triangle", "cut"`,
    );
  return borders === 'cut';
}
