import { CagecastError } from '../index.js';

/** Where paint ends: at the target's own triangles, or at the borders of the cage, along which these are cut. */
export type Borders = 'triangle' | 'cut';

/** Whether borders are to be cut. @throws {CagecastError} `badOption` */
export function isCut(fn: string, borders: Borders = 'triangle'): boolean {
  if (borders !== 'triangle' && borders !== 'cut')
    throw new CagecastError(
      'badOption',
      `${fn}: options.borders = ${JSON.stringify(borders)} is unknown; there are: "triangle", "cut"`,
    );
  return borders === 'cut';
}
