/** A rectangle of a texture: in shares of its sides (0..1), or in whole texels. The first row is at `top` 0. */
export interface Rect {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** The whole texture, in shares. */
export const kWhole: Rect = { left: 0, top: 0, right: 1, bottom: 1 };

/** The texels that a rectangle in shares touches, and `margin` more on every side. @param size Texels per side. */
export function toTexels({ left, top, right, bottom }: Rect, size: number, margin = 0): Rect {
  return {
    left: Math.max(0, Math.floor(left * size) - margin),
    top: Math.max(0, Math.floor(top * size) - margin),
    right: Math.min(size, Math.ceil(right * size) + margin),
    bottom: Math.min(size, Math.ceil(bottom * size) + margin),
  };
}

/** Converts texels to shares. */
export function toShares({ left, top, right, bottom }: Rect, size: number): Rect {
  return { left: left / size, top: top / size, right: right / size, bottom: bottom / size };
}

export function isEmpty({ left, top, right, bottom }: Rect): boolean {
  return left >= right || top >= bottom;
}

/** The smallest rectangle that contains both. */
export function hull(a: Rect, b: Rect): Rect {
  return {
    left: Math.min(a.left, b.left),
    top: Math.min(a.top, b.top),
    right: Math.max(a.right, b.right),
    bottom: Math.max(a.bottom, b.bottom),
  };
}

/**
 * Covers rectangles by at most `most` disjoint ones: rows of the tiles that they touch, clipped to their bounding box.
 * @param rects In texels. @param tile Texels per side; doubled until there are few enough rectangles.
 */
export function disjoint(rects: readonly Rect[], most: number, tile = 32): Rect[] {
  const some = rects.filter((rect) => !isEmpty(rect));
  if (some.length === 0) return [];
  const all = some.reduce(hull);
  const [left, top] = [Math.floor(all.left / tile), Math.floor(all.top / tile)];
  const [columns, rows] = [Math.ceil(all.right / tile) - left, Math.ceil(all.bottom / tile) - top];
  const touched = new Uint8Array(columns * rows);
  for (const rect of some) {
    const [from, to] = [Math.floor(rect.left / tile) - left, Math.ceil(rect.right / tile) - left];
    for (let row = Math.floor(rect.top / tile) - top; tile * (row + top) < rect.bottom; row++)
      touched.fill(1, row * columns + from, row * columns + to);
  }
  const found: Rect[] = [];
  let above: Rect[] = [];
  for (let row = 0; row < rows; row++) {
    const here: Rect[] = [];
    for (let column = 0; column < columns; column++) {
      if (!touched[row * columns + column]) continue;
      const from = column;
      while (column < columns && touched[row * columns + column]) column++;
      const [first, last, bottom] = [
        Math.max(all.left, tile * (left + from)),
        Math.min(all.right, tile * (left + column)),
        Math.min(all.bottom, tile * (top + row + 1)),
      ];
      // Extend the rectangle above if it has the same columns.
      let rect = above.find((other) => other.left === first && other.right === last);
      if (rect) rect.bottom = bottom;
      else found.push((rect = { left: first, top: Math.max(all.top, tile * (top + row)), right: last, bottom }));
      here.push(rect);
    }
    above = here;
  }
  return found.length > most ? disjoint(rects, most, 2 * tile) : found;
}
