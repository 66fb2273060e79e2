import type { Pattern } from './patterns';
import { type Canvas, frameOf, normalOf, type Point } from './spots';

/** How bright a surface is that faces the eye, and one that is seen from the side. */
const [kFront, kSide] = [1, 0.55];
const kBare = 0.8; // grey, below what is clear

/**
 * A small picture of a cage with a paint, from the front.
 * @param size  Pixels per side.
 * @returns 4 bytes per pixel, transparent beside the cage.
 */
export function portrait(pattern: Pattern, canvas: Canvas, size: number): Uint8ClampedArray<ArrayBuffer> {
  const { positions, indices } = canvas;
  const frame = frameOf(canvas);
  const colorAt = pattern(frame);
  const framed = (v: number): Point =>
    [0, 1, 2].map((k) => (positions[3 * v + k]! - frame.origin[k]!) / frame.unit) as unknown as Point;
  const points = Array.from({ length: positions.length / 3 }, (_, v) => framed(v));
  // A face fills the picture; of anything else all is seen.
  const box = [0, 1].map((k) => {
    const values = points.map((p) => p[k]!);
    return [Math.min(...values), Math.max(...values)] as const;
  });
  const half = frame.isFace ? 1.75 : Math.max(...box.map(([low, high]) => (high - low) / 2)) * 1.05;
  const [middleX, middleY] = frame.isFace ? [0, -0.15] : box.map(([low, high]) => (low + high) / 2);
  const [depths, spots] = [
    new Float32Array(size * size).fill(-Infinity),
    new Array<{ at: Point; normal: Point } | undefined>(size * size),
  ];
  const scale = size / 2 / half;
  const seen = points.map(([x, y, z]) => [
    (x - middleX!) * scale + size / 2 - 0.5,
    (middleY! - y) * scale + size / 2 - 0.5,
    z,
  ]);
  for (let i = 0; i < indices.length; i += 3) {
    const [u, v, w] = [indices[i]!, indices[i + 1]!, indices[i + 2]!];
    const [p, q, r] = [seen[u]!, seen[v]!, seen[w]!] as [number[], number[], number[]];
    const [ux, uy, vx, vy] = [q[0]! - p[0]!, q[1]! - p[1]!, r[0]! - p[0]!, r[1]! - p[1]!];
    const area = ux * vy - uy * vx;
    if (area >= 0) continue; // its back is seen, as rows go down
    const [a, b, c] = [points[u]!, points[v]!, points[w]!];
    const normal = normalOf(a, b, c);
    const range = (k: number): [number, number] => [
      Math.max(0, Math.ceil(Math.min(p[k]!, q[k]!, r[k]!))),
      Math.min(size - 1, Math.floor(Math.max(p[k]!, q[k]!, r[k]!))),
    ];
    const [[left, right], [top, bottom]] = [range(0), range(1)];
    for (let y = top; y <= bottom; ++y)
      for (let x = left; x <= right; ++x) {
        const s = ((x - p[0]!) * vy - (y - p[1]!) * vx) / area;
        const t = (ux * (y - p[1]!) - uy * (x - p[0]!)) / area;
        const z = a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2]);
        if (s < 0 || t < 0 || s + t > 1 || z <= depths[y * size + x]!) continue;
        depths[y * size + x] = z;
        const at = [0, 1, 2].map((k) => a[k]! + s * (b[k]! - a[k]!) + t * (c[k]! - a[k]!)) as unknown as Point;
        spots[y * size + x] = { at, normal };
      }
  }
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
