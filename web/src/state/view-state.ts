/**
 * View modes; `compare` shows two ways to transfer on either side of a divider, `steps` the steps of the method, one after the other.
 */
export const kModes = [
  'compare',
  'result',
  'naive',
  'zones',
  'segments',
  'checker',
  'distance',
  'stretch',
  'steps',
] as const;
export type Mode = (typeof kModes)[number];

/** Those that can be chosen in Play. */
export const kPlayModes: readonly Mode[] = ['compare', 'result', 'steps'];

/**
 * The ways to transfer that are compared, each with the steps of the one before it: the nearest paint everywhere; without what the model
 * itself hides; without what the cage does not cover either; the method as published; and the default rules.
 */
export const kBaselines = ['naive', 'occlusion', 'rays', 'paper', 'default'] as const;
export type Baseline = (typeof kBaselines)[number];

/** What a half of the view shows: a way to transfer, or the result by the rules that are set. */
export const kHalves = [...kBaselines, 'result'] as const;
export type Half = (typeof kHalves)[number];

/** The lights to choose from. */
export const kLightNames = ['studio', 'soft', 'day', 'evening'] as const;
export type LightName = (typeof kLightNames)[number];

/** State of the view. */
export interface View {
  mode: Mode;
  /** Position of the divider in `compare`: 0 at the left edge, 1 at the right. */
  split: number;
  /** What `compare` shows on either side. */
  left: Half;
  right: Half;
  /** Place in `steps`: 0 shows the first step, 4 the last; between two, the next one is wiped over the model from the left. */
  step: number;
  paint: boolean;
  cage: boolean;
  /** Whether `zones` shows what lies behind the surface, too. */
  seeThrough: boolean;
  light: LightName;
  /** What is behind the model, as #rrggbb; empty for the colour of the page. */
  background: string;
}

export const kFirstView: View = {
  mode: 'compare',
  split: 0.5,
  left: 'naive',
  right: 'result',
  step: 0,
  paint: true,
  cage: false,
  seeThrough: false,
  light: 'studio',
  background: '',
};

/** Whether a mode shows paint, which can be switched off. */
export const showsPaint = (mode: Mode): boolean => mode === 'compare' || mode === 'result' || mode === 'naive';

/** The last place of `steps`. */
export const kLastStep = 4;

/** Direction and distance of the camera. */
export interface Angle {
  /** Degrees around the model from its front; counter-clockwise seen from above. */
  turn: number;
  /** Degrees from straight above. */
  tilt: number;
  /** Magnification, relative to the distance at which the whole model is visible. */
  near: number;
  /** What is looked at, in radii of the model from its middle; absent for the middle. */
  at?: readonly [x: number, y: number, z: number] | undefined;
}
