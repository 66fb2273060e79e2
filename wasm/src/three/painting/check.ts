import { CagecastError } from '../../index.js';
import { describe } from '../describe.js';

const kEntry = 'cagecast/three/paint';

/** The error of an argument. */
export const wrong = (reason: string): CagecastError => new CagecastError('badArgument', kEntry, reason);

/** @throws {CagecastError} `badOption` that names the field and its value, unless that fits. */
export function check(fits: boolean, name: string, value: unknown, what: string): void {
  if (!fits) throw new CagecastError('badOption', kEntry, `${name} is ${describe(value)}, not ${what}`);
}
