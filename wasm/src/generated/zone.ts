// Made by wasm/tools/generate.mjs from core/include/cagecast/result.hpp. Do not edit.

/** Why a vertex may, or may not, be painted. All but `Cosmetic` are Non-Cosmetic Zones. */
export const Zone = {
  /** May be painted. */
  Cosmetic: 0,
  /** Another surface of the target lies over it. */
  Occluded: 1,
  /** The cage has a hole over it, or it lies outside the cage. */
  Uncovered: 2,
  /** Its segment is culled; see `culledBy`. */
  Culled: 3,
} as const;

/** A value of {@link Zone}. */
export type Zone = (typeof Zone)[keyof typeof Zone];
