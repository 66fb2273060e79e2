import type { Pattern } from './patterns';
import { type Canvas, eachSpot, frameOf } from './spots';

/**
 * Draws a paint for a cage.
 * @param size  Texels per side.
 * @returns 4 bytes per texel: sRGB, alpha; transparent where the cage has nothing.
 */
export function draw(pattern: Pattern, canvas: Canvas, size: number): Uint8ClampedArray<ArrayBuffer> {
  const frame = frameOf(canvas);
  const colorAt = pattern(frame);
  const pixels = new Uint8ClampedArray(4 * size * size);
  eachSpot(canvas, frame, size, (texel, spot) => {
    const found = colorAt(spot);
    for (let k = 0; k < 4; ++k) pixels[4 * texel + k] = 255 * found[k]!;
  });
  return pixels;
}
