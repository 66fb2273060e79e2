import { isRecord, show } from '../core/error.js';
import { optionTable } from '../generated/options.js';

/** For each function, the stages whose options it takes, and its other options. */
const kFunctions = {
  project: { stages: ['project'], others: ['parts', 'reuse'] },
  classify: { stages: ['classify'], others: ['parts', 'locks', 'masks', 'reuse'] },
  transfer: { stages: ['project', 'classify'], others: ['parts', 'locks', 'masks', 'reuse'] },
  cutBorders: { stages: ['project', 'classify'], others: ['parts', 'locks', 'masks'] },
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

/** The lists of the option `parts`, of which the first that has a part counts. */
export const kPartLists = ['ignore', 'keep', 'exclude'] as const;
export type PartList = (typeof kPartLists)[number];

/** The lists of `parts` that a function takes. */
export const partListsOf = (fn: Fn): PartList[] =>
  kPartLists.filter((list) =>
    (kFunctions[fn].stages as readonly string[]).includes(list === 'ignore' ? 'project' : 'classify'),
  );

/** The names of all options of a function. */
export const optionNames = (fn: Fn): string[] => ['preset', ...optionsOf(fn, false), 'steps', ...kFunctions[fn].others];

/** What is wrong with the names of options, as the reason of a `badOption`; nothing if all are known. */
export function faultOfNames(fn: string, where: string, given: unknown, known: readonly string[]): string | undefined {
  if (!isRecord(given)) return `${where} is ${show(given)}, not an object`;
  const unknown = Object.keys(given).find((name) => !known.includes(name));
  if (unknown === undefined) return undefined; // it may be the empty text
  return `${where}.${unknown} is not an option; ${fn} takes: ${known.join(', ')}`;
}
