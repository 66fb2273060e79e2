import type { Vector } from '../../inspect/geometry.js';

/** The axes of a picture: right, up and towards the eye, as orthogonal unit vectors. */
export interface View {
  right: Vector;
  up: Vector;
  eye: Vector;
}

/** Where a model is seen from, in degrees. */
export interface Angles {
  /** Around the vertical axis: 0 from its front (+z), 90 from its own left (+x), 180 from its back. Default: 0. */
  azimuth?: number | undefined;
  /** Above the horizon; −90 to 90. Default: 0. */
  elevation?: number | undefined;
}

/** Views by their names. `left` and `right` are those of the model itself; `face` is its head from the front. */
export const views = {
  front: {},
  back: { azimuth: 180 },
  left: { azimuth: 90 },
  right: { azimuth: -90 },
  top: { elevation: 90 },
  bottom: { elevation: -90 },
  face: {},
} as const satisfies Record<string, Angles>;
export type ViewName = keyof typeof views;

/** The axes of a view. */
export function viewAt({ azimuth = 0, elevation = 0 }: Angles): View {
  const [sinA, cosA, sinE, cosE] = [sine(azimuth), sine(azimuth + 90), sine(elevation), sine(elevation + 90)];
  return {
    right: [cosA, 0, 0 - sinA],
    up: [0 - sinA * sinE, cosE, 0 - cosA * sinE],
    eye: [sinA * cosE, sinE, cosA * cosE],
  };
}

/** The sine of an angle in degrees; exactly 0 or ±1 where it is. */
const sine = (degrees: number): number =>
  degrees % 180 === 0
    ? 0
    : degrees % 90 === 0
      ? Math.sign(Math.sin((degrees / 180) * Math.PI))
      : Math.sin((degrees / 180) * Math.PI);
