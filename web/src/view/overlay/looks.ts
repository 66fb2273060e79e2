import { type Half, type Mode, showsPaint, type View } from '../../state/view-state';

/**
 * What the overlay shows: nothing, the paint everywhere, the filtered paint, the zones, those with what lies behind the surface, a
 * checker, colours per triangle corner, or what other ways to transfer paint, for either half of the view.
 */
export type Look = 'bare' | 'naive' | 'result' | 'zones' | 'allZones' | 'checker' | 'colors' | 'left' | 'right';

/** Highlights: the parts under the user's pointer, and spots marked to stay bare. */
export type Highlighted = 'parts' | 'bare';

/** The overlay of each mode with one. */
const kLooks: Record<Exclude<Mode, 'compare' | 'steps'>, Look> = {
  result: 'result',
  naive: 'naive',
  zones: 'zones',
  segments: 'colors',
  checker: 'checker',
  distance: 'colors',
  stretch: 'colors',
};

/** The overlays of `steps`. */
const kSteps = ['bare', 'naive', 'allZones', 'colors', 'result'] as const;
/** The cage is drawn until this place of `steps`. */
const kCageEnds = 2.5;

/** What is to be seen left and right of a place of the view, 0..1, and whether the cage is. */
export function sidesOf({ mode, split, step, paint, cage, seeThrough, ...halves }: View): {
  left: Look;
  right: Look;
  at: number;
  cage: boolean;
} {
  if (mode === 'steps') {
    const first = Math.min(Math.floor(step), kSteps.length - 2);
    return { left: kSteps[first + 1]!, right: kSteps[first]!, at: step - first, cage: step < kCageEnds };
  }
  const look = (side: keyof typeof kLooks): Look =>
    side === 'zones' && seeThrough ? 'allZones' : paint || !showsPaint(side) ? kLooks[side] : 'bare';
  const half = (side: 'left' | 'right'): Look => (paint ? lookOf(halves[side], side) : 'bare');
  return mode === 'compare'
    ? { left: half('left'), right: half('right'), at: split, cage }
    : { left: look(mode), right: look(mode), at: 1, cage };
}

/** The overlay of a half. */
export const lookOf = (half: Half, side: 'left' | 'right'): Look =>
  half === 'naive' || half === 'result' ? half : side;
