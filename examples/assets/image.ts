import { PNG } from 'pngjs';
import { corners, type Mesh, point, triangleCount } from './mesh.ts';
import { clamp, unit, type Vec3 } from './vec.ts';

/** A colour and its opacity, each 0..1, in sRGB. */
export type Rgba = readonly [number, number, number, number];

/** What a surface looks like at a point of the model: its colour by position and unit normal. */
export type Shade = (p: Vec3, n: Vec3) => Rgba;

const known = new Map<string, Rgba>(); // paints name their colours at every texel
/** A colour by its name on the web, `#rrggbb`. */
export const rgb = (hex: string, alpha = 1): Rgba => {
  let c = known.get(hex);
  if (!c) {
    const n = parseInt(hex.slice(1), 16);
    known.set(hex, (c = [(n >> 16) / 255, ((n >> 8) & 255) / 255, (n & 255) / 255, 1]));
  }
  return alpha === 1 ? c : [c[0], c[1], c[2], alpha];
};
export const mixColour = (a: Rgba, b: Rgba, t: number): Rgba => [
  a[0] + (b[0] - a[0]) * t,
  a[1] + (b[1] - a[1]) * t,
  a[2] + (b[2] - a[2]) * t,
  a[3] + (b[3] - a[3]) * t,
];
/** Makes a colour lighter (above 1) or darker, not more or less opaque. */
export const lit = (c: Rgba, by: number): Rgba => [clamp(c[0] * by), clamp(c[1] * by), clamp(c[2] * by), c[3]];
/** Lays `top` over `under` with a strength of 0..1. */
export const over = (under: Rgba, top: Rgba, strength: number): Rgba => {
  const s = top[3] * clamp(strength);
  const alpha = s + under[3] * (1 - s);
  if (alpha === 0) return under;
  const part = s / alpha;
  return [
    under[0] + (top[0] - under[0]) * part,
    under[1] + (top[1] - under[1]) * part,
    under[2] + (top[2] - under[2]) * part,
    alpha,
  ];
};

/** A linear-light factor for glTF from a colour as screens show it. */
export const linear = (c: Rgba): [number, number, number, number] => {
  const f = (v: number): number => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  return [f(c[0]), f(c[1]), f(c[2]), c[3]];
};

/**
 * Draws a texture (a PNG's bytes, `size` × `size`) for a mesh with UVs: each texel asks `shade` for the place of the
 * surface it covers, at `samples` × `samples` points. Colours are carried 12 texels beyond the charts, so that filtering finds no seam.
 * @param far  The colour of texels that no chart is near.
 */
export const drawTexture = (mesh: Mesh, size: number, shade: Shade, far: Rgba, samples: number): Buffer => {
  const sums = new Float64Array(size * size * 5);
  const fine = size * samples;
  for (let t = 0; t < triangleCount(mesh); t++) {
    const vs = corners(mesh, t);
    const [a, b, c] = vs.map((v) => [mesh.uvs![2 * v]! * fine, mesh.uvs![2 * v + 1]! * fine] as const) as [Uv, Uv, Uv];
    const whole = cross2(a, b, c);
    if (whole === 0) continue;
    const ps = vs.flatMap((v) => point(mesh, v));
    const ns = vs.flatMap((v) => (mesh.normals ? Array.from(mesh.normals.subarray(3 * v, 3 * v + 3)) : [0, 0, 0]));
    const low = [0, 1].map((k) => Math.max(0, Math.floor(Math.min(a[k]!, b[k]!, c[k]!))));
    const high = [0, 1].map((k) => Math.min(fine - 1, Math.ceil(Math.max(a[k]!, b[k]!, c[k]!))));
    for (let j = low[1]!; j <= high[1]!; j++)
      for (let i = low[0]!; i <= high[0]!; i++) {
        const [x, y] = [i + 0.5, j + 0.5];
        const u = ((c[0] - b[0]) * (y - b[1]) - (c[1] - b[1]) * (x - b[0])) / whole;
        const v = ((a[0] - c[0]) * (y - c[1]) - (a[1] - c[1]) * (x - c[0])) / whole;
        const w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        const colour = shade(
          [
            u * ps[0]! + v * ps[3]! + w * ps[6]!,
            u * ps[1]! + v * ps[4]! + w * ps[7]!,
            u * ps[2]! + v * ps[5]! + w * ps[8]!,
          ],
          unit([
            u * ns[0]! + v * ns[3]! + w * ns[6]!,
            u * ns[1]! + v * ns[4]! + w * ns[7]!,
            u * ns[2]! + v * ns[5]! + w * ns[8]!,
          ]),
        );
        const texel = (Math.floor(j / samples) * size + Math.floor(i / samples)) * 5;
        for (let k = 0; k < 3; k++) sums[texel + k]! += colour[k]! * Math.max(colour[3], 1e-3);
        sums[texel + 3]! += colour[3];
        sums[texel + 4]! += 1;
      }
  }
  const png = new PNG({ width: size, height: size });
  let known = new Uint8Array(size * size);
  for (let t = 0; t < size * size; t++) {
    const n = sums[5 * t + 4]!;
    known[t] = n > 0 ? 1 : 0;
    const weight = n > 0 ? Math.max(sums[5 * t + 3]!, n * 1e-3) : 1;
    for (let k = 0; k < 3; k++)
      png.data[4 * t + k] = Math.round(255 * clamp(n > 0 ? sums[5 * t + k]! / weight : far[k]!));
    png.data[4 * t + 3] = Math.round(255 * clamp(n > 0 ? sums[5 * t + 3]! / n : far[3]));
  }
  for (let ring = 0; ring < 12; ring++) {
    const grown = known.slice();
    for (let j = 0; j < size; j++)
      for (let i = 0; i < size; i++) {
        const t = j * size + i;
        if (known[t]) continue;
        const near = [
          i > 0 ? t - 1 : -1,
          i < size - 1 ? t + 1 : -1,
          j > 0 ? t - size : -1,
          j < size - 1 ? t + size : -1,
        ].filter((n) => n >= 0 && known[n]);
        if (near.length === 0) continue;
        for (let k = 0; k < 4; k++)
          png.data[4 * t + k] = Math.round(near.reduce((s, n) => s + png.data[4 * n + k]!, 0) / near.length);
        grown[t] = 1;
      }
    known = grown;
  }
  return PNG.sync.write(png, { deflateLevel: 9 });
};

type Uv = readonly [number, number];
const cross2 = (a: Uv, b: Uv, c: Uv): number => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
