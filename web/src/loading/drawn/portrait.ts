import type { Pattern } from './patterns';
import { type Canvas, eachPixel, framed, frameOf, normalOf, type Place, pointIn, type Spot } from './spots';

/** How bright a surface is that faces the eye, and one that is seen from the side. */
const [kFront, kSide] = [1, 0.55];
const kBare = 0.8; // grey, below what is clear
/** How far the picture of a face reaches from its middle, and how high that is, in distances of the eyes. */
const [kFace, kFaceMiddle] = [1.75, -0.15];

/**
 * A small picture of a cage with a paint, from the front.
 * @param size  Pixels per side.
 * @returns 4 bytes per pixel, transparent beside the cage.
 */
export function portrait(pattern: Pattern, canvas: Canvas, size: number): Uint8ClampedArray<ArrayBuffer> {
  const { indices } = canvas;
  const frame = frameOf(canvas);
  const points = framed(canvas, frame);
  // A face fills the picture; of anything else all is seen.
  const [across, up] = ([0, 1] as const).map((k) => {
    const values = points.map((p) => p[k]);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    return { middle: (low + high) / 2, half: (high - low) / 2 };
  }) as [{ middle: number; half: number }, { middle: number; half: number }];
  const half = frame.isFace ? kFace : 1.05 * Math.max(across.half, up.half);
  const [middleX, middleY] = frame.isFace ? [0, kFaceMiddle] : [across.middle, up.middle];
  const scale = size / 2 / half;
  const places = points.map(
    ([x, y]): Place => [(x - middleX) * scale + size / 2 - 0.5, (middleY - y) * scale + size / 2 - 0.5],
  );
  const depths = new Float32Array(size * size).fill(-Infinity);
  const spots = new Array<Spot | undefined>(size * size);
  for (let i = 0; i < indices.length; i += 3) {
    const [u, v, w] = [indices[i]!, indices[i + 1]!, indices[i + 2]!];
    const corners = [points[u]!, points[v]!, points[w]!] as const;
    const normal = normalOf(...corners);
    if (normal[2] <= 0) continue; // its back is seen
    eachPixel([places[u]!, places[v]!, places[w]!], size, 0, (pixel, s, t) => {
      const at = pointIn(corners, s, t);
      if (at[2] <= depths[pixel]!) return;
      depths[pixel] = at[2];
      spots[pixel] = { at, normal };
    });
  }
  const colorAt = pattern(frame);
  const pixels = new Uint8ClampedArray(4 * size * size);
  spots.forEach((spot, n) => {
    if (!spot) return;
    const [r, g, b, alpha] = colorAt(spot);
    const light = kSide + (kFront - kSide) * Math.max(0, spot.normal[2]);
    [r, g, b].forEach((value, k) => (pixels[4 * n + k] = 255 * light * (value * alpha + kBare * (1 - alpha))));
    pixels[4 * n + 3] = 255;
  });
  return pixels;
}
