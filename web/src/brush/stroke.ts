import type { CageTexels, Capsule, SurfacePoint } from './cage-texels';

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
const kMostPieces = 16;

/** Turns the points of a pointer path into the capsules that a brush touches. */
export class Stroke {
  #last: SurfacePoint | undefined;

  constructor(
    private readonly texels: CageTexels,
    private readonly shape: StrokeShape,
  ) {}

  /**
   * Extends the stroke to a point, or interrupts it if there is none.
   * @param step Expected distance of consecutive points in the cage's space, if the surface faces the viewer.
   * @returns The capsules to paint.
   */
  to(point: SurfacePoint | undefined, step = 0): Capsule[] {
    const last = this.#last;
    this.#last = point;
    if (!point) return [];
    const { radius, mirror } = this.shape;
    // Behind the edge of a nose lies the cheek: do not connect the two.
    const near = last && last.point.distanceTo(point.point) <= kFarthest * Math.max(radius, step);
    const capsules = near ? this.#between(last, point) : [{ from: point, to: point, radius }];
    if (!mirror) return capsules;
    return capsules.flatMap((capsule) => [
      capsule,
      { from: this.texels.mirrored(capsule.from), to: this.texels.mirrored(capsule.to), radius },
    ]);
  }

  #between(first: SurfacePoint, last: SurfacePoint): Capsule[] {
    const { radius } = this.shape;
    const pieces = Math.min(
      kMostPieces,
      Math.max(1, Math.ceil(first.point.distanceTo(last.point) / (kPiece * radius))),
    );
    const outside = first.normal.clone().add(last.normal);
    const points = Array.from({ length: pieces + 1 }, (_, piece) => {
      if (piece === 0) return first;
      if (piece === pieces) return last;
      return this.texels.nearest(first.point.clone().lerp(last.point, piece / pieces), outside) ?? first;
    });
    return points.slice(1).map((to, piece) => ({ from: points[piece]!, to, radius }));
  }
}
