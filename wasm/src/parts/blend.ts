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

export const noBlends: Blends = { sources: new Uint32Array(0), weights: new Float32Array(0) };

export type AttributeArray = Float32Array | Int8Array | Uint8Array | Int16Array | Uint16Array | Uint32Array;

/** How a new vertex gets an attribute: as the mean of its sources, as a normalised mean direction, or from its heaviest source. */
export type Rule = 'mean' | 'direction' | 'heaviest';

/** Whole numbers that the format does not know are identifiers, such as those of features, so they are not averaged. */
export function ruleOf(semantic: string, values: AttributeArray, normalized: boolean): Rule {
  if (semantic === 'NORMAL' || semantic === 'TANGENT') return 'direction';
  const isIdentifier = semantic.startsWith('_') && !normalized && values.every(Number.isInteger);
  return isIdentifier || semantic.startsWith('JOINTS_') ? 'heaviest' : 'mean';
}

/** The largest value of a normalised type: it stands for 1. */
const one = (values: AttributeArray): number =>
  values instanceof Float32Array
    ? 1
    : 2 ** (8 * values.BYTES_PER_ELEMENT - (values instanceof Int8Array || values instanceof Int16Array ? 1 : 0)) - 1;

function extended<A extends AttributeArray>(values: A, size: number, { sources }: Blends): A {
  const out = new (values.constructor as new (length: number) => A)(values.length + (size * sources.length) / 3);
  out.set(values);
  return out;
}

/** The values of a part's vertices, `size` numbers each, and of its new ones after them. */
export function blend<A extends AttributeArray>(values: A, size: number, blends: Blends, rule: Rule = 'mean'): A {
  const out = extended(values, size, blends);
  blendInto(out, values.length / size, size, blends, rule);
  return out;
}

/** Writes the values of new vertices into an array, from vertex `first` on; before it are those of the vertices they blend. */
export function blendInto(
  values: AttributeArray,
  first: number,
  size: number,
  blends: Blends,
  rule: Rule = 'mean',
): void {
  const { sources, weights } = blends;
  const isFloat = values instanceof Float32Array;
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
      values[to + k] = isFloat ? value : Math.round(value);
    }
  }
}

/**
 * The joints and weights of a part's vertices, new ones included, by semantic. A new vertex has the strongest joints of its sources,
 * as many as there is room for; the weights add up to 1.
 * @param arrayOf  What belongs to a semantic, 4 numbers per vertex; sets are numbered without gaps.
 */
export function blendSkin<A extends AttributeArray>(
  arrayOf: (semantic: string) => A | undefined,
  blends: Blends,
): Map<string, A> {
  const joints: A[] = [];
  const weights: A[] = [];
  for (let set = 0; ; ++set) {
    const [joint, weight] = [arrayOf(`JOINTS_${set}`), arrayOf(`WEIGHTS_${set}`)];
    if (joint === undefined || weight === undefined) break;
    joints.push(joint);
    weights.push(weight);
  }
  const out = {
    joints: joints.map((set) => extended(set, 4, blends)),
    weights: weights.map((set) => extended(set, 4, blends)),
  };
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
      const [set, slot] = [place >> 2, joints[0]!.length + 4 * n + (place & 3)];
      const whole = one(weights[set]!);
      const share =
        place === 0
          ? left
          : weights[set] instanceof Float32Array
            ? Math.fround(pull / sum)
            : Math.round((pull / sum) * whole) / whole;
      left -= share;
      const weight = weights[set] instanceof Float32Array ? share : Math.round(share * whole);
      out.weights[set]![slot] = weight;
      out.joints[set]![slot] = weight > 0 ? joint : 0; // as the format has it
    }
  }
  return new Map(
    joints.flatMap((_, set): [string, A][] => [
      [`JOINTS_${set}`, out.joints[set]!],
      [`WEIGHTS_${set}`, out.weights[set]!],
    ]),
  );
}
