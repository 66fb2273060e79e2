import { count } from '../api/mesh.js';
import { CagecastError, show } from '../core/error.js';

/** The vertices that cutting added to a part, in order, after the existing ones. */
export interface Blends {
  /** 3 per new vertex: the vertices of the part that it blends. */
  sources: Uint32Array;
  /** 3 per new vertex: the weights of these vertices; they add up to 1. */
  weights: Float32Array;
}

/** The source of a new vertex with the greatest weight. */
export function heaviestOf({ sources, weights }: Blends, n: number): number {
  let best = 3 * n;
  for (let i = best + 1; i < 3 * n + 3; ++i) if (weights[i]! > weights[best]!) best = i;
  return sources[best]!;
}

/** How the vertices of a part become those of a prepared one: existing ones keep their numbers, then come those of cuts, then copies. */
export interface Split {
  /** 1 per vertex: the vertex that it copies, numbered before there were copies; of all but the copies, itself. */
  sources: Uint32Array;
  /** Number of copies. */
  copies: number;
  /** What cutting added; undefined if nothing was cut. */
  cut: Blends | undefined;
}

export type AttributeArray =
  | Float32Array
  | Float64Array
  | Int8Array
  | Uint8Array
  | Uint8ClampedArray
  | Int16Array
  | Uint16Array
  | Int32Array
  | Uint32Array;

const kRules = ['mean', 'direction', 'heaviest'] as const;

/** How a new vertex gets an attribute: as the mean of its sources, as a normalised mean direction, or from its heaviest source. */
export type Rule = (typeof kRules)[number];

/** Whole numbers that the format does not know are identifiers, such as those of features, so they are not averaged. */
export function ruleOf(semantic: string, values: AttributeArray, normalized: boolean): Rule {
  if (semantic === 'NORMAL' || semantic === 'TANGENT') return 'direction';
  const isIdentifier = semantic.startsWith('_') && !normalized && values.every(Number.isInteger);
  return isIdentifier || semantic.startsWith('JOINTS_') ? 'heaviest' : 'mean';
}

const kindOf = (values: AttributeArray): string => values[Symbol.toStringTag];
const isFloat = (values: AttributeArray): boolean => kindOf(values).startsWith('Float');

/** The largest value of a normalised type: it stands for 1. */
const one = (values: AttributeArray): number =>
  isFloat(values) ? 1 : 2 ** (8 * values.BYTES_PER_ELEMENT - (kindOf(values).startsWith('Int') ? 1 : 0)) - 1;

/**
 * The values of an attribute for all vertices of a prepared part: those of its existing vertices, blends where borders were cut, and
 * copies. For every attribute of a vertex buffer, and for the deltas of every morph target; joints and their weights are
 * `applySplitToSkin`'s.
 *
 * @param values    `itemSize` numbers for each vertex that the part had: a typed array of any kind but BigInts. It is not changed.
 * @param itemSize  Numbers per vertex: 3 for positions, 2 for UVs.
 * @param split     A part that `prepareParts` returned.
 * @param rule      How blends are made. `mean` (default): by weights, rounded in arrays of whole numbers. `direction`: for normals
 * and tangents, of length 1, or the largest whole number of the array's type; a fourth number is a sign. `heaviest`: for numbers that
 * are names, such as those of features, from the source with the greatest weight.
 * @returns an array of the same type, `itemSize` numbers for each entry of `split.sources`.
 * @throws {CagecastError} `badArgument` that names the argument, its value and what is needed.
 *
 * @example
 * const positions = applySplit(mesh.positions, 3, part);
 * const normals = applySplit(mesh.normals, 3, part, 'direction');
 */
export function applySplit<A extends AttributeArray>(
  values: A,
  itemSize: number,
  split: Split,
  rule: Rule = 'mean',
): A {
  const fn = 'applySplit';
  const own = vertexCount(fn, split);
  if (!kRules.includes(rule))
    throw wrong(fn, 'rule', `= ${show(rule)} is unknown; there are: "mean", "direction", "heaviest"`);
  if (!(Number.isInteger(itemSize) && itemSize > 0))
    throw wrong(fn, 'itemSize', `is ${show(itemSize)}, not a whole number of at least 1`);
  if (rule === 'direction' && itemSize !== 3 && itemSize !== 4)
    throw wrong(fn, 'itemSize', `is ${itemSize}, but a direction has 3 numbers, or 4 with a sign`);
  checkValues(fn, 'values', values, itemSize, own);
  const out = extended(values, itemSize, split);
  if (split.cut) blendInto(out, own, itemSize, split.cut, rule);
  copyInto(out, itemSize, split);
  return out;
}

const wrong = (fn: string, argument: string, text: string, at = 0): CagecastError =>
  new CagecastError('badArgument', fn, `${argument} ${text}`, { argument: /^\w+/.exec(argument)![0], at });

/** How many vertices a part had before it was cut and split. */
function vertexCount(fn: string, split: Partial<Split> | undefined): number {
  const { sources, copies, cut } = split ?? {};
  if (!(sources instanceof Uint32Array) || typeof copies !== 'number')
    throw wrong(fn, 'split', `is ${show(split)}, not a part that prepareParts returned`);
  return sources.length - copies - (cut ? cut.sources.length / 3 : 0);
}

function checkValues(fn: string, name: string, values: AttributeArray, size: number, vertices: number): void {
  if (!ArrayBuffer.isView(values) || !/^(Float|Int|Uint)/.test(kindOf(values)))
    throw wrong(fn, name, `is ${show(values)}, not a typed array of numbers`);
  if (values.length !== size * vertices)
    throw wrong(
      fn,
      name,
      `has ${values.length} numbers, not ${size} for each of ${count(vertices, 'vertex')}`,
      values.length,
    );
}

/** Room for all vertices; only the existing ones have values. */
function extended<A extends AttributeArray>(values: A, size: number, { sources }: Split): A {
  const out = new (values.constructor as new (length: number) => A)(size * sources.length);
  out.set(values);
  return out;
}

/** Writes the values of copies. */
function copyInto(values: AttributeArray, size: number, { sources, copies }: Split): void {
  for (let v = sources.length - copies; v < sources.length; ++v)
    for (let k = 0; k < size; ++k) values[size * v + k] = values[size * sources[v]! + k]!;
}

/** Writes the values of new vertices into an array, from vertex `first` on; before it are those of the vertices they blend. */
function blendInto(values: AttributeArray, first: number, size: number, blends: Blends, rule: Rule): void {
  const { sources, weights } = blends;
  const isWhole = !isFloat(values);
  const mean = new Float64Array(size);
  for (let i = 0; i < sources.length; i += 3) {
    const [a, b, c] = [size * sources[i]!, size * sources[i + 1]!, size * sources[i + 2]!];
    for (let k = 0; k < size; ++k)
      mean[k] = weights[i]! * values[a + k]! + weights[i + 1]! * values[b + k]! + weights[i + 2]! * values[c + k]!;
    const to = size * (first + i / 3);
    const heaviest = rule === 'mean' ? 0 : size * heaviestOf(blends, i / 3);
    const length = rule === 'direction' ? Math.hypot(mean[0]!, mean[1]!, mean[2]!) : 0;
    for (let k = 0; k < size; ++k) {
      let value = mean[k]!;
      // A tangent's fourth number is a sign.
      if (rule === 'heaviest' || (rule === 'direction' && (k > 2 || length === 0))) value = values[heaviest + k]!;
      else if (rule === 'direction') value *= one(values) / length;
      values[to + k] = isWhole ? Math.round(value) : value;
    }
  }
}

/** Joints and weights: of each set an array, 4 numbers per vertex. */
export interface SkinArrays<J extends AttributeArray = AttributeArray, W extends AttributeArray = J> {
  joints: readonly J[];
  weights: readonly W[];
}

/**
 * The joints and weights of all vertices of a prepared part. A vertex of a cut has the strongest joints of its sources, as many as
 * there is room for; its weights add up to 1.
 *
 * @param skin   As many arrays of joints as of weights, 4 numbers for each vertex that the part had. Weights in arrays of whole
 * numbers are normalised: the largest of the type is 1. They are not changed.
 * @param split  A part that `prepareParts` returned.
 * @returns arrays of the same types.
 * @throws {CagecastError} `badArgument` that names the array, its length and what is needed.
 */
export function applySplitToSkin<J extends AttributeArray, W extends AttributeArray>(
  { joints, weights }: SkinArrays<J, W>,
  split: Split,
): { joints: J[]; weights: W[] } {
  const fn = 'applySplitToSkin';
  const own = vertexCount(fn, split);
  if (joints?.length !== weights?.length || !joints)
    throw wrong(fn, 'skin', `has ${joints?.length ?? 0} arrays of joints, and ${weights?.length ?? 0} of weights`);
  joints.forEach((set, s) => checkValues(fn, `skin.joints[${s}]`, set, 4, own));
  weights.forEach((set, s) => checkValues(fn, `skin.weights[${s}]`, set, 4, own));
  const out = {
    joints: joints.map((set) => extended(set, 4, split)),
    weights: weights.map((set) => extended(set, 4, split)),
  };
  if (split.cut) blendSkin(out, own, split.cut);
  for (const set of [...out.joints, ...out.weights]) copyInto(set, 4, split);
  return out;
}

/** Writes the joints and weights of new vertices, from vertex `first` on. */
function blendSkin({ joints, weights }: SkinArrays, first: number, blends: Blends): void {
  for (let n = 0; n < blends.sources.length / 3; ++n) {
    const pulls = new Map<number, number>();
    for (let i = 3 * n; i < 3 * n + 3; ++i) {
      for (let slot = 4 * blends.sources[i]!; slot < 4 * blends.sources[i]! + 4; ++slot) {
        joints.forEach((set, s) => {
          const pull = (blends.weights[i]! * weights[s]![slot]!) / one(weights[s]!);
          if (pull > 0) pulls.set(set[slot]!, (pulls.get(set[slot]!) ?? 0) + pull);
        });
      }
    }
    const strongest = [...pulls].sort(([a, x], [b, y]) => y - x || a - b).slice(0, 4 * joints.length);
    const sum = strongest.reduce((all, [, pull]) => all + pull, 0);
    let left = 1;
    // From the weakest on, so that the strongest gets the remainder of rounding.
    for (let place = strongest.length - 1; place >= 0; --place) {
      const [joint, pull] = strongest[place]!;
      const [set, slot] = [place >> 2, 4 * (first + n) + (place & 3)];
      const own = weights[set]!;
      const whole = one(own);
      const share =
        place === 0 ? left : isFloat(own) ? Math.fround(pull / sum) : Math.round((pull / sum) * whole) / whole;
      left -= share;
      own[slot] = isFloat(own) ? share : Math.round(share * whole);
      joints[set]![slot] = own[slot]! > 0 ? joint : 0; // as glTF has it
    }
  }
}

/**
 * The joints and weights of a cut part, by glTF's names; none if nothing was cut, and they are as other attributes.
 * @param arrayOf  What belongs to a name; sets are numbered without gaps.
 */
export function splitSkin<A extends AttributeArray>(
  arrayOf: (semantic: string) => A | undefined,
  split: Split,
): Map<string, A> {
  const [joints, weights]: [A[], A[]] = [[], []];
  for (let set = 0; split.cut; ++set) {
    const [joint, weight] = [arrayOf(`JOINTS_${set}`), arrayOf(`WEIGHTS_${set}`)];
    if (joint === undefined || weight === undefined) break;
    joints.push(joint);
    weights.push(weight);
  }
  const skin = applySplitToSkin({ joints, weights }, split);
  return new Map(
    joints.flatMap((_, set): [string, A][] => [
      [`JOINTS_${set}`, skin.joints[set]!],
      [`WEIGHTS_${set}`, skin.weights[set]!],
    ]),
  );
}
