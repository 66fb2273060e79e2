import { Vector3 } from 'three';

/** Positions by name. */
export type Spots = Readonly<Record<string, readonly [number, number, number]>>;

/** A pair whose spots are farther from each other's mirror image than this share of their distance is not symmetric: a bent arm. */
const kMaxSkew = 0.25;

/** The name of a landmark's counterpart on the other side; undefined for those in the middle. */
export function otherSide(name: string): string | undefined {
  const [, stem, side] = /^(.+)_(left|right)$/.exec(name) ?? [];
  return stem && `${stem}_${side === 'left' ? 'right' : 'left'}`;
}

/** Mirrors spots of a model: left becomes right. */
export class Mirror {
  readonly #middle = new Vector3();
  /** From right to left. */
  readonly #across = new Vector3();

  /**
   * Finds the plane between pairs of spots; without a pair, the one through the middle: left is +x in glTF.
   * @param spots  Those of the model that are known.
   * @param middle Of the model.
   * @param but    The name of a spot that does not count, nor does its counterpart.
   */
  constructor(spots: Spots, middle: Vector3, but?: string) {
    let pairs = 0;
    for (const [name, spot] of Object.entries(spots)) {
      const other = name.endsWith('_left') ? otherSide(name)! : '';
      const there = spots[other];
      if (!there || name === but || other === but) continue;
      const [left, right] = [new Vector3(...spot), new Vector3(...there)];
      this.#across.add(left).sub(right);
      this.#middle.addScaledVector(left.add(right), 0.5);
      pairs++;
    }
    if (pairs > 0) this.#middle.divideScalar(pairs);
    else this.#middle.copy(middle);
    if (this.#across.lengthSq() > 0) this.#across.normalize();
    else this.#across.set(1, 0, 0);
  }

  /** The mirror image of a spot. */
  image(spot: readonly [number, number, number]): [number, number, number] {
    const point = new Vector3(...spot);
    const distance = point.clone().sub(this.#middle).dot(this.#across);
    return point.addScaledVector(this.#across, -2 * distance).toArray();
  }

  /** Whether two spots are about each other's mirror image. */
  holds(one: readonly [number, number, number], other: readonly [number, number, number]): boolean {
    const image = new Vector3(...this.image(one));
    const apart = new Vector3(...one).distanceTo(new Vector3(...other));
    return image.distanceTo(new Vector3(...other)) <= kMaxSkew * apart;
  }
}
