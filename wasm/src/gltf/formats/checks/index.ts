import type { Format } from '../../kinds.js';
import type { FormatLimits } from '../limits.js';
import { checkFbx } from './fbx.js';
import { checkObj } from './obj.js';
import { checkPly } from './ply.js';
import { checkStl } from './stl.js';
import { checkUsd } from './usd.js';

/**
 * Looks at what a file says of itself, before its loader believes it: most that stand for gigabytes end here, in milliseconds.
 * @throws {InputError} that names the element, the value and the limit.
 */
export const checks: Record<Format, (bytes: Uint8Array, limits: FormatLimits) => void | Promise<void>> = {
  fbx: checkFbx,
  obj: checkObj,
  ply: checkPly,
  stl: checkStl,
  usd: checkUsd,
};
