import type { InputError } from '../../../scene/input-error.js';
import { exceeds } from '../../checks/read-limits.js';
import type { FormatLimits } from '../limits.js';

/** Checks how deep the braces of a text are nested. @param what  Stands in them. */
export function checkBraces(bytes: Uint8Array, what: string, limits: FormatLimits): void {
  let depth = 0;
  for (const byte of bytes)
    if (byte === 0x7b && ++depth > limits.nesting) throw tooDeep(what, limits);
    else if (byte === 0x7d && depth > 0) --depth;
}

export const tooDeep = (what: string, limits: FormatLimits): InputError =>
  exceeds(`its ${what} are nested more than ${limits.nesting} deep`, 'nesting', limits);
