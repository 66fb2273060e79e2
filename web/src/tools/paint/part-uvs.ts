import type { Classification } from 'cagecast';
import type { Vector2 } from 'three';
import type { StickerPart } from '#three';
import type { Shown } from '../../state/scene';
import type { Spot } from '../../view/pick';

type Painted = Pick<Classification, 'cosmeticTriangles'>;
type Target = {
  target: { mesh: Pick<Shown['target']['mesh'], 'indices'> };
  projection: Pick<Shown['projection'], 'uvs' | 'cornerUvs' | 'segments'> & {
    segmentStats: readonly Pick<Shown['projection']['segmentStats'][number], 'group'>[];
  };
};

/** The UVs of a spot. */
export function uvOf(
  { triangle, weights }: Pick<Spot, 'triangle' | 'weights'>,
  { target: { mesh }, projection: { uvs, cornerUvs } }: Target,
): [number, number] {
  let [u, v] = [0, 0];
  weights.forEach((weight, index) => {
    const corner = 3 * triangle + index;
    const [of, at] = cornerUvs.length > 0 ? [cornerUvs, corner] : [uvs, mesh.indices[corner]!];
    u += weight * of[2 * at]!;
    v += weight * of[2 * at + 1]!;
  });
  return [u, v];
}

const kCorners: readonly Spot['weights'][] = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];

/** Where the painted triangles of a model's parts take their paint from. */
export class PartUvs {
  readonly #shown: Target;
  readonly #painted: ArrayLike<number>;
  readonly #parts = new Map<string, StickerPart>();
  readonly #found = new WeakMap<Vector2, { part: StickerPart | undefined }>();

  constructor(shown: Target, { cosmeticTriangles }: Painted) {
    this.#shown = shown;
    this.#painted = cosmeticTriangles;
  }

  /** Of the piece that a triangle belongs to, 6 numbers per triangle. */
  ofPiece(triangle: number): number[] {
    const piece = this.#pieceOf(triangle);
    return this.#uvs((other) => this.#pieceOf(other) === piece);
  }

  /** The meshes that take paint from a UV, the same object for the same ones; undefined if there are none, or no others. */
  at(uv: Vector2): StickerPart | undefined {
    let found = this.#found.get(uv);
    if (!found) this.#found.set(uv, (found = { part: this.#meshesAt(uv) }));
    return found.part;
  }

  #meshesAt({ x, y }: Vector2): StickerPart | undefined {
    const { segmentStats } = this.#shown.projection;
    const meshOf = (triangle: number): number => segmentStats[this.#pieceOf(triangle)]!.group;
    if (segmentStats.every(({ group }) => group === segmentStats[0]!.group)) return undefined;
    const meshes = new Set<number>();
    for (let triangle = 0; triangle < this.#painted.length; triangle++)
      if (this.#painted[triangle] && contains(this.#cornersOf(triangle), x, y)) meshes.add(meshOf(triangle));
    if (meshes.size === 0) return undefined;
    const key = [...meshes].sort().join();
    const part = this.#parts.get(key) ?? { uvs: this.#uvs((triangle) => meshes.has(meshOf(triangle))) };
    this.#parts.set(key, part);
    return part;
  }

  #uvs(belongs: (triangle: number) => boolean): number[] {
    const found: number[] = [];
    for (let triangle = 0; triangle < this.#painted.length; triangle++)
      if (this.#painted[triangle] && belongs(triangle)) found.push(...this.#cornersOf(triangle));
    return found;
  }

  #cornersOf(triangle: number): number[] {
    return kCorners.flatMap((weights) => uvOf({ triangle, weights }, this.#shown));
  }

  #pieceOf(triangle: number): number {
    const { target, projection } = this.#shown;
    return projection.segments[target.mesh.indices[3 * triangle]!]!;
  }
}

/** Whether a triangle of a texture that repeats contains a point of it. @param corners 6 numbers. */
function contains([au, av, bu, bv, cu, cv]: readonly number[], x: number, y: number): boolean {
  if ((bu! - au!) * (cv! - av!) === (bv! - av!) * (cu! - au!)) return false; // a line
  const u = x - Math.floor(x) + Math.floor(Math.min(au!, bu!, cu!));
  const v = y - Math.floor(y) + Math.floor(Math.min(av!, bv!, cv!));
  const within = (atU: number, atV: number): boolean => {
    const side = (fromU: number, fromV: number, toU: number, toV: number): number =>
      (toU - fromU) * (atV - fromV) - (toV - fromV) * (atU - fromU);
    const sides = [side(au!, av!, bu!, bv!), side(bu!, bv!, cu!, cv!), side(cu!, cv!, au!, av!)];
    return sides.every((one) => one >= 0) || sides.every((one) => one <= 0);
  };
  return within(u, v) || within(u + 1, v) || within(u, v + 1) || within(u + 1, v + 1);
}
