/** A part of a texture: in shares of its sides, or in whole texels. The texture's first row is at `top` 0. */
export interface Rect {
  left: number
  top: number
  right: number
  bottom: number
}

/** All of a texture, in shares. */
export const kWhole: Rect = { left: 0, top: 0, right: 1, bottom: 1 }

/** The whole texels that a part touches, and `margin` more on every side. @param size Texels a side. */
export function toTexels({ left, top, right, bottom }: Rect, size: number, margin = 0): Rect {
  return {
    left: Math.max(0, Math.floor(left * size) - margin),
    top: Math.max(0, Math.floor(top * size) - margin),
    right: Math.min(size, Math.ceil(right * size) + margin),
    bottom: Math.min(size, Math.ceil(bottom * size) + margin),
  }
}

/** A part in whole texels, as shares. */
export function toShares({ left, top, right, bottom }: Rect, size: number): Rect {
  return { left: left / size, top: top / size, right: right / size, bottom: bottom / size }
}

export function isEmpty({ left, top, right, bottom }: Rect): boolean {
  return left >= right || top >= bottom
}

/** The least part that holds both. */
export function hull(a: Rect, b: Rect): Rect {
  return {
    left: Math.min(a.left, b.left),
    top: Math.min(a.top, b.top),
    right: Math.max(a.right, b.right),
    bottom: Math.max(a.bottom, b.bottom),
  }
}

/** Parts that cover all of the given ones, share no texel, and are at most `most`. Cost: quadratic in their number. */
export function apart(rects: readonly Rect[], most: number): Rect[] {
  const found: Rect[] = []
  for (const rect of rects) {
    if (isEmpty(rect)) continue
    let grown = rect
    // What was swallowed may have made it reach others.
    for (let at = 0; at < found.length; ) {
      if (overlap(found[at]!, grown)) {
        grown = hull(grown, found[at]!)
        found.splice(at, 1)
        at = 0
      } else at++
    }
    found.push(grown)
  }
  return found.length > most ? [found.reduce(hull)] : found
}

function overlap(a: Rect, b: Rect): boolean {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom
}
