import type { Mode } from '../../state/view-state';

/**
 * What the overlay shows: nothing, the paint everywhere, the filtered paint, the zones, a checker, or colours per triangle
 * corner.
 */
export type Look = 'bare' | 'naive' | 'result' | 'zones' | 'checker' | 'colors';

/** What can be highlighted: the parts that the user points to, and what is marked to stay bare. */
export type Highlighted = 'parts' | 'bare';

/** The overlay of each mode other than `compare`. */
export const kLooks: Record<Exclude<Mode, 'compare'>, Look> = {
  result: 'result',
  naive: 'naive',
  zones: 'zones',
  segments: 'colors',
  checker: 'checker',
  distance: 'colors',
  stretch: 'colors',
};
