import { CagecastError } from '../../index.js';
import { describe } from '../describe.js';

/** @throws {CagecastError} `badOption` that names the field and its value, unless that fits. */
export function check(fits: boolean, name: string, value: unknown, what: string): void {
  if (!fits) throw new CagecastError('badOption', 'cagecast/three/paint', `${name} is ${describe(value)}, not ${what}`);
}
