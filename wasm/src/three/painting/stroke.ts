import type { CageTexels, Capsule, SurfacePoint } from './cage-texels.js';

/** Size and symmetry of a stroke. */
export interface StrokeShape {
  /** In the cage's space. */
  radius: number;
  /** Whether the stroke is mirrored to the other half of the cage. */
  mirror: boolean;
}

/** Two points further apart than this many radii are not connected: the pointer jumped to another surface. */
const kFarthest = 4;
// A straight line may leave the cage: it is divided into pieces of this length, in radii, and each end is projected back.
const kPiece = 1;
const kMaxPieces = 16;
// A brush without a radius would divide by zero.
const kMinPressure = 0.05;

/** Turns the points of a pointer path into the capsules that a brush touches. */
export class Stroke {
  #last: SurfacePoint | undefined;
  #lastRadius = 0;

  constructor(
    private readonly texels: CageTexels,
    private readonly shape: StrokeShape,
  ) {}

  /**
   * Extends the stroke to a point, or interrupts it if there is none.
   * @param step Expected distance of consecutive points in the cage's space, if the surface faces the viewer.
   * @param pressure 0..1: the share of the radius at this point.
   * @returns The capsules to paint.
   */
  to(point: SurfacePoint | undefined, step = 0, pressure = 1): Capsule[] {
    const [last, lastRadius] = [this.#last, this.#lastRadius];
    this.#last = point;
    if (!point) return [];
    const { mirror } = this.shape;
    const radius = this.shape.radius * Math.max(kMinPressure, Math.min(1, pressure));
    this.#lastRadius = radius;
    // Behind the edge of a nose lies the cheek: do not connect the two.
    const near = last && last.point.distanceTo(point.point) <= kFarthest * Math.max(radius, lastRadius, step);
    const capsules = near ? this.#between(last, point, [lastRadius, radius]) : [{ from: point, to: point, radius }];
    if (!mirror) return capsules;
    return capsules.flatMap((capsule) => [
      capsule,
      { ...capsule, from: this.texels.mirrored(capsule.from), to: this.texels.mirrored(capsule.to) },
    ]);
  }

  #between(first: SurfacePoint, last: SurfacePoint, [from, to]: readonly [number, number]): Capsule[] {
    const radius = Math.max(from, to);
    const pieces = Math.min(kMaxPieces, Math.max(1, Math.ceil(first.point.distanceTo(last.point) / (kPiece * radius))));
    const outside = first.normal.clone().add(last.normal);
    const points = Array.from({ length: pieces + 1 }, (_, piece) => {
      if (piece === 0) return first;
      if (piece === pieces) return last;
      return this.texels.nearest(first.point.clone().lerp(last.point, piece / pieces), outside) ?? first;
    });
    const radiusAt = (piece: number): number => from + ((to - from) * piece) / pieces;
    return points.slice(1).map((point, piece) => ({
      from: points[piece]!,
      to: point,
      radius: radiusAt(piece),
      toRadius: radiusAt(piece + 1),
    }));
  }
}
