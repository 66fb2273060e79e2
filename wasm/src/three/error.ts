import { CagecastError, type Code, type ErrorDetails } from '../index.js';

/** The error of an argument: `badArgument` of `cagecast/three`, unless it says otherwise. */
export const wrong = (
  reason: string,
  fn = 'cagecast/three',
  code: Code = 'badArgument',
  details?: ErrorDetails,
): CagecastError => new CagecastError(code, fn, reason, details);
