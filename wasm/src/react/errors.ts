import { CagecastError, show } from '../core/error.js';

/** The error of an argument of this entry. @param what  With its article. */
export const wrong = (name: string, value: unknown, what: string): CagecastError =>
  new CagecastError('badArgument', 'cagecast/react', `${name} is ${show(value)}, not ${what}`, { argument: name });
