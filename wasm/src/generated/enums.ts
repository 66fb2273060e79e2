// Made by wasm/tools/generate.mjs from core/include/cagecast/result.hpp. Do not edit.

/** What steps 1 to 3 find of a vertex. Its zone also depends on its segment. */
export const Visibility = {
  /** The cage covers it. */
  Covered: 0,
  /** Another surface of the target lies over it. */
  Occluded: 1,
  /** The cage has a hole over it, or it lies outside the cage. */
  Uncovered: 2,
  /** It lies beyond an outer border of the cage, which says nothing of it: its zone is uncovered. */
  Beyond: 3,
} as const;

/** A value of {@link Visibility}. */
export type Visibility = (typeof Visibility)[keyof typeof Visibility];

/** Why a vertex may, or may not, be painted. All but `Cosmetic` are Non-Cosmetic Zones (NCZ). */
export const Zone = {
  /** May be painted. */
  Cosmetic: 0,
  /** Another surface of the target lies over it. */
  Occluded: 1,
  /** The cage has a hole over it, or it lies outside the cage. */
  Uncovered: 2,
  /** Its segment is culled (see `culledBy`), or a mask excludes it. */
  Culled: 3,
} as const;

/** A value of {@link Zone}. */
export type Zone = (typeof Zone)[keyof typeof Zone];
