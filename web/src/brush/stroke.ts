import type { CageAtlas, Capsule, Place } from './atlas'

/** How a brush goes. */
export interface Going {
  /** In the cage's space. */
  radius: number
  /** Whether the other half of the cage gets the same. */
  mirror: boolean
}

/** How many radii apart two places are at most that follow each other on the same surface; farther, the brush was lifted. */
const kFarthest = 4

/** Turns the places a pointer goes through into what a brush touches between them. */
export class Stroke {
  #last: Place | undefined

  constructor(
    private readonly atlas: CageAtlas,
    private readonly going: Going,
  ) {}

  /**
   * Goes on to a place, or off the paint where there is none.
   * @param step How far apart, in the cage's space, two places are that follow each other, if the surface faces the viewer.
   * @returns What is to be painted: up to one capsule, and its mirror image.
   */
  to(place: Place | undefined, step = 0): Capsule[] {
    const last = this.#last
    this.#last = place
    if (!place) return []
    const { radius, mirror } = this.going
    // Past the edge of a nose lies a cheek: nobody means to paint the air between them.
    const near = last && last.point.distanceTo(place.point) <= kFarthest * Math.max(radius, step)
    const capsule = { from: near ? last : place, to: place, radius }
    if (!mirror) return [capsule]
    return [capsule, { from: this.atlas.mirrored(capsule.from), to: this.atlas.mirrored(place), radius }]
  }
}
