import type { Vec3 } from './vec.ts';

/** 32 bits that are always the same for the same cell: integer hashing, so no state and no seed to keep. */
const bits = (x: number, y: number, z: number, salt: number): number => {
  let h = Math.imul(x, 0x27d4eb2d) ^ Math.imul(y, 0x165667b1) ^ Math.imul(z, 0x9e3779b1) ^ Math.imul(salt, 0x85ebca6b);
  h = Math.imul(h ^ (h >>> 15), 0x2c1b3c6d);
  h = Math.imul(h ^ (h >>> 12), 0x297a2d39);
  return (h ^ (h >>> 15)) >>> 0;
};

const fade = (t: number): number => t * t * (3 - 2 * t);

/** Smooth noise in 0..1 whose features are about one unit apart. */
export const noise = (p: Vec3, salt = 0): number => {
  const [i, j, k] = [Math.floor(p[0]), Math.floor(p[1]), Math.floor(p[2])];
  const [u, v, w] = [fade(p[0] - i), fade(p[1] - j), fade(p[2] - k)];
  let sum = 0;
  for (let c = 0; c < 8; c++) {
    const a = c & 1;
    const b = (c >> 1) & 1;
    const d = c >> 2;
    sum += bits(i + a, j + b, k + d, salt) * (a ? u : 1 - u) * (b ? v : 1 - v) * (d ? w : 1 - w);
  }
  return sum / 2 ** 32;
};

/** Three octaves of `noise`, in 0..1. */
export const fractal = (p: Vec3, salt = 0): number =>
  (noise(p, salt) * 4 +
    noise([p[0] * 2, p[1] * 2, p[2] * 2], salt + 1) * 2 +
    noise([p[0] * 4, p[1] * 4, p[2] * 4], salt + 2)) /
  7;

const kJitter = 0.7 / 1023;

/** The cells of a jittered lattice (about one unit wide) at `p`: the distance to the border, and the cell's own number in 0..1. */
export const cells = (p: Vec3, salt = 0): { border: number; id: number } => {
  const i = p.map(Math.floor) as [number, number, number];
  let first = Infinity;
  let second = Infinity;
  let nearest = 0;
  for (let a = -1; a <= 1; a++)
    for (let b = -1; b <= 1; b++)
      for (let c = -1; c <= 1; c++) {
        const [x, y, z] = [i[0] + a, i[1] + b, i[2] + c];
        const h = bits(x, y, z, salt);
        const dx = x + 0.15 + (h & 1023) * kJitter - p[0];
        const dy = y + 0.15 + ((h >>> 10) & 1023) * kJitter - p[1];
        const dz = z + 0.15 + ((h >>> 20) & 1023) * kJitter - p[2];
        const d = dx * dx + dy * dy + dz * dz;
        if (d < first) {
          second = first;
          first = d;
          nearest = h;
        } else if (d < second) second = d;
      }
  return { border: Math.sqrt(second) - Math.sqrt(first), id: (Math.imul(nearest, 0x9e3779b1) >>> 0) / 2 ** 32 };
};
