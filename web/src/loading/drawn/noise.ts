// Noise in space, the same on every machine.

/** A number from 0 to 1 for each point of the integer lattice. */
export function hash(x: number, y: number, z: number): number {
  let h = Math.imul(x, 374761393) ^ Math.imul(y, 668265263) ^ Math.imul(z, 1274126177);
  h = Math.imul(h ^ (h >>> 13), 1274126177);
  return ((h ^ (h >>> 16)) >>> 0) / 4294967296;
}

const ease = (t: number): number => t * t * (3 - 2 * t);
const between = (a: number, b: number, t: number): number => a + (b - a) * t;

/** Smooth noise from 0 to 1, whose features are 1 wide. */
export function noise(x: number, y: number, z: number): number {
  const [i, j, k] = [Math.floor(x), Math.floor(y), Math.floor(z)];
  const [u, v, w] = [ease(x - i), ease(y - j), ease(z - k)];
  const row = (b: number, c: number): number => between(hash(i, j + b, k + c), hash(i + 1, j + b, k + c), u);
  return between(between(row(0, 0), row(1, 0), v), between(row(0, 1), row(1, 1), v), w);
}

/** Noise of several scales, each half as wide and half as strong as the one before; 0 to 1. */
export function clouds(x: number, y: number, z: number, octaves = 4): number {
  let [sum, weight, scale] = [0, 0, 1];
  for (let o = 0; o < octaves; ++o, scale *= 2) {
    sum += noise(x * scale + 17 * o, y * scale, z * scale) / scale;
    weight += 1 / scale;
  }
  return sum / weight;
}

/** The nearest of one point in each cell of the lattice: its distance, and a number from 0 to 1 that is its own. */
export function nearestCell(
  x: number,
  y: number,
  z: number,
): { distance: number; dx: number; dy: number; dz: number; id: number } {
  const [i, j, k] = [Math.floor(x), Math.floor(y), Math.floor(z)];
  let found = { distance: Infinity, dx: 0, dy: 0, dz: 0, id: 0 };
  for (let a = i - 1; a <= i + 1; ++a)
    for (let b = j - 1; b <= j + 1; ++b)
      for (let c = k - 1; c <= k + 1; ++c) {
        const id = hash(a, b, c);
        const dx = x - a - 0.2 - 0.6 * id;
        const dy = y - b - 0.2 - 0.6 * hash(a + 71, b, c);
        const dz = z - c - 0.2 - 0.6 * hash(a, b + 71, c);
        const distance = Math.hypot(dx, dy, dz);
        if (distance < found.distance) found = { distance, dx, dy, dz, id };
      }
  return found;
}
