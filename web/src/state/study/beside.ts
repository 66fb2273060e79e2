/** A box, in pixels. */
interface Size {
  width: number;
  height: number;
}

const kGap = 16; // pixels from the spot
const kEdge = 8; // pixels from the edges

/**
 * Where a box is put beside a spot: to its right, else to its left, else below or above it, as far as there is room.
 * @param spot  Where it is in `view`.
 * @param view  What the box stays in; `top` and `bottom` of it are covered.
 * @returns Its upper left corner.
 */
export function beside(
  spot: { x: number; y: number },
  { width, height }: Size,
  view: Size & { top: number; bottom: number },
): { x: number; y: number } {
  const within = (at: number, from: number, to: number): number => Math.max(from, Math.min(at, to));
  const [right, left] = [spot.x + kGap, spot.x - kGap - width];
  const [first, last] = [view.top + kEdge, view.height - view.bottom - kEdge - height];
  const centred = within(spot.y - height / 2, first, last);
  if (right + width + kEdge <= view.width) return { x: Math.max(kEdge, right), y: centred };
  if (left >= kEdge) return { x: Math.min(left, view.width - kEdge - width), y: centred };
  // There is little room then: what is below the view's free part may be covered.
  const [above, below, lowest] = [spot.y - kGap - height, spot.y + kGap, view.height - kEdge - height];
  return {
    x: within(spot.x - width / 2, kEdge, view.width - kEdge - width),
    y: above >= first ? above : within(below, first, lowest),
  };
}
