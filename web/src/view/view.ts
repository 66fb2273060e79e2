import type { Look } from './overlay';

/** What the picture can show; `compare` is naive and result with a line between them. */
export const kModes = ['compare', 'result', 'naive', 'zones', 'segments', 'checker', 'distance', 'stretch'] as const;
export type Mode = (typeof kModes)[number];

/** How the model is looked at. */
export interface View {
  mode: Mode;
  /** Where the line of `compare` is: 0 at the left edge, 1 at the right. */
  split: number;
  paint: boolean;
  cage: boolean;
}

/** Where the model is looked at from. */
export interface Angle {
  /** Around it, from its front, in degrees; counter-clockwise seen from above. */
  turn: number;
  /** From straight above, in degrees. */
  tilt: number;
  /** How many times nearer than where all of it is seen. */
  near: number;
}

export const kFirstView: View = { mode: 'compare', split: 0.5, paint: true, cage: false };

/** What lies over the model in each mode but `compare`. */
export const kLooks: Record<Exclude<Mode, 'compare'>, Look> = {
  result: 'result',
  naive: 'naive',
  zones: 'zones',
  segments: 'tint',
  checker: 'checker',
  distance: 'tint',
  stretch: 'tint',
};

/** Whether a mode shows the paint, which can then be switched off. */
export const showsPaint = (mode: Mode): boolean => mode === 'compare' || mode === 'result' || mode === 'naive';
