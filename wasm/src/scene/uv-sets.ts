// Which of several UV sets of a cage its texture is drawn in.
import { show } from '../core/error.js';

/** A set, by its number or its name. */
export type UvSetChoice = number | string;

/** Whether something is the number of a set. */
export const isUvSetNumber = (value: unknown): value is number => Number.isSafeInteger(value) && (value as number) >= 0;
export const uvSetNumberText = 'the number of a UV set, from 0';

/** Whether something is the number or the name of a set. */
export const isUvSetChoice = (value: unknown): value is UvSetChoice =>
  typeof value === 'string' ? value !== '' : isUvSetNumber(value);
export const uvSetText = `${uvSetNumberText}, or its name`;

/** A UV set of a part. */
export interface UvSet {
  number: number;
  /** As a program called it; glTF has no names of sets. */
  name?: string | undefined;
  /** By its name, as `rankOf` says. Default: 1. */
  rank?: number;
  values(): Float32Array;
}

/** What is known about the sets of a part. */
interface Told {
  /** What the user chose. */
  given?: UvSetChoice | undefined;
  /** The set of its own base colour texture, if it has one. */
  used?: number | undefined;
}

/** The set that counts, and others that might be meant. */
interface ChosenSet {
  number: number;
  others: number[];
}

/** In the extras of a mesh that was made of another format: the names of its UV sets, by their numbers. */
export const uvSetNames = 'uvSets';

/** Names of sets for light that is baked. */
const kBaked = /light.?map|bake|occlusion|^ao$|^uv_?2$|uv_?channel_?2/i;
/** Names that programs give the set for textures. */
const kDrawn = /^(uvmap|map_?1|st|uv|uv_?set|default|texture.*|diffuse.*|base_?colou?r.*|uv_?channel_?1)$/i;

/** How likely a texture is drawn in a set of a name: the lower, the likelier. */
export const rankOf = (name: string): number => (kBaked.test(name) ? 2 : kDrawn.test(name) ? 0 : 1);

/** From which difference on two UVs are not the same: a quarter of a texel of a texture of 4096. */
const kSame = 1 / 16384;

/**
 * Chooses the UV set of a part of a cage: as given, else as of its texture, else by names, else the first. A set does not count if its UVs
 * are all in one place, or are those of an earlier set.
 * @param sets  At least one, by their numbers.
 * @param fail  The error if there is none as given.
 */
export function chooseUvSet(sets: readonly UvSet[], { given, used }: Told, fail: (text: string) => unknown): ChosenSet {
  if (given !== undefined) {
    const found = sets.find(({ number, name }) => number === given || name === given);
    if (found) return { number: found.number, others: [] };
    const list = sets.map(({ number, name }) => (name === undefined ? number : `${number} (${show(name)})`));
    throw fail(`has no UV set ${show(given)}: there is ${list.join(', ')}`);
  }
  if (used !== undefined) return { number: used, others: [] };
  const all = distinct(sets);
  const best = Math.min(...all.map(({ rank = 1 }) => rank));
  const [chosen = sets[0]!, ...others] = all.filter(({ rank = 1 }) => rank === best);
  return { number: chosen.number, others: others.map(({ number }) => number) };
}

/** The sets with an area, without copies of others. */
function distinct(sets: readonly UvSet[]): readonly UvSet[] {
  if (sets.length < 2) return sets;
  const isSame = (one: Float32Array, at: (i: number) => number | undefined) =>
    one.every((x, i) => Math.abs(x - at(i)!) < kSame);
  const kept: Float32Array[] = [];
  return sets.filter((set) => {
    const values = set.values();
    if (isSame(values, (i) => values[i % 2]) || kept.some((other) => isSame(values, (i) => other[i]))) return false;
    return kept.push(values);
  });
}
