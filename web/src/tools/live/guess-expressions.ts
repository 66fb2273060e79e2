import type { Weights } from './morph-names';

/** Patterns of names, as `keyOf` gives them, and the weights of what matches. It applies if the first matches. */
type Rule = readonly (readonly [name: RegExp, weight: number])[];
const kSide = '(l|r|left|right)';
const named = (pattern: string): RegExp => new RegExp(`^(${pattern})$`);
const rule = (pattern: string): Rule => [[named(pattern), 1]];
const [kJaw, kPucker, kFunnel] = ['(jaw|mouth)(open|opened|down)|openmouth', 'mouthpucker', 'mouthfunnel'].map(
  named,
) as [RegExp, RegExp, RegExp];
const [kSmile, kFrown, kBrow, kBrowsUp, kWide] = [
  `(mouth)?smile${kSide}`,
  `mouthfrown${kSide}`,
  `browdown${kSide}`,
  `browinnerup|browouterup${kSide}`,
  `eyewide${kSide}`,
].map(named) as [RegExp, RegExp, RegExp, RegExp, RegExp];

/** By the titles of expressions; of the rules, the first that applies counts: both eyes in one before each by itself. */
const kRules: Record<string, readonly Rule[]> = {
  Smile: [
    rule('(mouth)?smile'),
    [
      [kSmile, 0.9],
      [named(`cheeksquint${kSide}`), 0.4],
    ],
    rule('fclalljoy'),
    rule('happy|joy|笑い|にこり'),
    rule('fclallfun|fclmth(joy|fun)|fun|grin'),
  ],
  Blink: [
    rule('(eyes?)?blink(both)?|fcleyeclose|まばたき'),
    rule(`(eyes?)?blink${kSide}|${kSide}(eye)?blink`),
    rule('eyes?closed?|closeeyes?'),
    rule(`(fcl)?eyes?closed?${kSide}`),
  ],
  Sad: [
    rule('sad|sorrow|fclallsorrow|悲しい'),
    [
      [kFrown, 0.9],
      [named('browinnerup'), 0.8],
    ],
  ],
  Surprised: [
    rule('surprised?|fclallsurprised|びっくり'),
    [
      [kBrowsUp, 0.9],
      [kWide, 0.8],
      [kJaw, 0.35],
    ],
  ],
  Angry: [
    rule('angry|anger|fclallangry|怒り'),
    [
      [kBrow, 1],
      [kFrown, 0.5],
      [named(`nosesneer${kSide}`), 0.5],
    ],
  ],
};

const vowel = (letters: string): Rule => rule(`(viseme|fclmth|mth|mouth|vowel|vrcv|v|lipsync)?(${letters})`);
/** Shapes of a mouth that speaks: named so, else made of others. */
const kVowels: Record<string, readonly Rule[]> = {
  a: [vowel('a|aa|ah|あ'), [[kJaw, 0.7]]],
  e: [
    vowel('e|ee|eh|え'),
    [
      [kJaw, 0.4],
      [kSmile, 0.3],
    ],
  ],
  i: [
    vowel('i|ih|い'),
    [
      [kJaw, 0.2],
      [kSmile, 0.4],
    ],
  ],
  o: [
    vowel('o|oh|お'),
    [
      [kJaw, 0.45],
      [kFunnel, 0.5],
      [kPucker, 0.5],
    ],
  ],
  u: [
    vowel('u|ou|う'),
    [
      [kJaw, 0.15],
      [kPucker, 0.9],
    ],
  ],
};

/** A morph's name without what programs add: `blendShape1.eyeBlink_L` is `eyeblinkl`. */
const keyOf = (name: string): string =>
  name
    .replace(/^.*[.:|]/, '')
    .toLowerCase()
    .replace(/[^\p{L}\p{N}]/gu, '');

function applied(rules: readonly Rule[], names: readonly string[]): Weights | undefined {
  const found = (of: RegExp): string[] => names.filter((name) => of.test(keyOf(name)));
  const fits = rules.find(([first]) => found(first![0]).length > 0);
  return fits && new Map(fits.flatMap(([of, weight]) => found(of).map((name) => [name, weight] as const)));
}

/** The weights of an expression by the names of morphs; undefined if none of them tells. @param title  A key of the rules, such as “Smile”. */
export const guessed = (title: string, names: readonly string[]): Weights | undefined => applied(kRules[title]!, names);
/** Titles of expressions that are guessed if a file names none. */
export const moods: readonly string[] = ['Sad', 'Surprised', 'Angry'];
/** The shapes of a mouth that speaks, by vowel, as far as there are any. */
export const vowelsOf = (names: readonly string[]): ReadonlyMap<string, Weights> =>
  new Map(
    Object.entries(kVowels).flatMap(([letter, rules]) => {
      const weights = applied(rules, names);
      return weights ? [[letter, weights] as const] : [];
    }),
  );
