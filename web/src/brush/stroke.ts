import type { CageAtlas, Capsule, Place } from './atlas';

/** How a brush goes. */
export interface Going {
  /** In the cage's space. */
  radius: number;
  /** Whether the other half of the cage gets the same. */
  mirror: boolean;
}

/** How many radii apart two places are at most that follow each other on the same surface; farther, the brush was lifted. */
const kFarthest = 4;
// A straight way from place to place may leave the cage: pieces of it that are this long, in radii, are laid back on it.
const kPiece = 1;
const kMostPieces = 16;

/** Turns the places a pointer goes through into what a brush touches between them. */
export class Stroke {
  #last: Place | undefined;

  constructor(
    private readonly atlas: CageAtlas,
    private readonly going: Going,
  ) {}

  /**
   * Goes on to a place, or off the paint where there is none.
   * @param step How far apart, in the cage's space, two places are that follow each other, if the surface faces the viewer.
   * @returns What is to be painted.
   */
  to(place: Place | undefined, step = 0): Capsule[] {
    const last = this.#last;
    this.#last = place;
    if (!place) return [];
    const { radius, mirror } = this.going;
    // Past the edge of a nose lies a cheek: nobody means to paint the air between them.
    const near = last && last.point.distanceTo(place.point) <= kFarthest * Math.max(radius, step);
    const capsules = near ? this.#between(last, place) : [{ from: place, to: place, radius }];
    if (!mirror) return capsules;
    return capsules.flatMap((capsule) => [
      capsule,
      { from: this.atlas.mirrored(capsule.from), to: this.atlas.mirrored(capsule.to), radius },
    ]);
  }

  #between(first: Place, last: Place): Capsule[] {
    const { radius } = this.going;
    const pieces = Math.min(
      kMostPieces,
      Math.max(1, Math.ceil(first.point.distanceTo(last.point) / (kPiece * radius))),
    );
    const outside = first.normal.clone().add(last.normal);
    const places = Array.from({ length: pieces + 1 }, (_, piece) => {
      if (piece === 0) return first;
      if (piece === pieces) return last;
      return this.atlas.nearest(first.point.clone().lerp(last.point, piece / pieces), outside) ?? first;
    });
    return places.slice(1).map((to, piece) => ({ from: places[piece]!, to, radius }));
  }
}
