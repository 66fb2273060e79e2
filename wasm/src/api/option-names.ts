import { CagecastError, isRecord, show } from '../core/error.js';
import { optionTable } from '../generated/options.js';

/** For each function, the stages whose options it takes, and its other options. */
const kFunctions = {
  project: { stages: ['project'], others: ['reuse'] },
  classify: { stages: ['classify'], others: ['locks', 'masks', 'reuse'] },
  transfer: { stages: ['project', 'classify'], others: ['locks', 'masks', 'reuse'] },
  cutBorders: { stages: ['project', 'classify'], others: ['locks', 'masks'] },
} as const;
export type Fn = keyof typeof kFunctions;

export type OptionName = keyof typeof optionTable;

/** The options of a function: those in `steps`, or the others. */
export const optionsOf = (fn: Fn, isStep: boolean): OptionName[] =>
  (Object.keys(optionTable) as OptionName[]).filter(
    (name) =>
      optionTable[name].isStep === isStep &&
      (kFunctions[fn].stages as readonly string[]).includes(optionTable[name].stage),
  );

/** The names of all options of a function. */
export const optionNames = (fn: Fn): string[] => ['preset', ...optionsOf(fn, false), 'steps', ...kFunctions[fn].others];

/** Checks the names of options. @returns them. @throws {CagecastError} `badOption` that lists those that there are */
export function checkNames(
  fn: string,
  where: string,
  given: unknown,
  known: readonly string[],
): Record<string, unknown> {
  if (!isRecord(given)) throw new CagecastError('badOption', fn, `${where} is ${show(given)}, not an object`);
  const unknown = Object.keys(given).find((name) => !known.includes(name));
  if (unknown !== undefined)
    throw new CagecastError('badOption', fn, `${where}.${unknown} is not an option; ${fn} takes: ${known.join(', ')}`);
  return given as Record<string, unknown>;
}
