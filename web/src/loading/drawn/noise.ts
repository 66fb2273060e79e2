// Noise in space, the same on every machine.

/** A number from 0 to 1 for each point of the integer lattice. */
export function hash(x: number, y: number, z: number): number {
  let h = Math.imul(x, 374761393) ^ Math.imul(y, 668265263) ^ Math.imul(z, 1274126177);
  h = Math.imul(h ^ (h >>> 13), 1274126177);
  return ((h ^ (h >>> 16)) >>> 0) / 4294967296;
}

const ease = (t: number): number => t * t * (3 - 2 * t);
const between = (a: number, b: number, t: number): number => a + (b - a) * t;

/** Smooth noise from 0 to 1, whose features are 1 wide. It runs millions of times, so it makes no arrays. */
export function noise(x: number, y: number, z: number): number {
  const i = Math.floor(x);
  const j = Math.floor(y);
  const k = Math.floor(z);
  const u = ease(x - i);
  const v = ease(y - j);
  const low = between(
    between(hash(i, j, k), hash(i + 1, j, k), u),
    between(hash(i, j + 1, k), hash(i + 1, j + 1, k), u),
    v,
  );
  const high = between(
    between(hash(i, j, k + 1), hash(i + 1, j, k + 1), u),
    between(hash(i, j + 1, k + 1), hash(i + 1, j + 1, k + 1), u),
    v,
  );
  return between(low, high, ease(z - k));
}

/** Noise of several scales, each half as wide and half as strong as the one before; 0 to 1. */
export function clouds(x: number, y: number, z: number, octaves = 4): number {
  let sum = 0;
  let weight = 0;
  let scale = 1;
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
  const i = Math.floor(x);
  const j = Math.floor(y);
  const k = Math.floor(z);
  let nearest = Infinity; // squared
  const found = { distance: 0, dx: 0, dy: 0, dz: 0, id: 0 };
  for (let a = i - 1; a <= i + 1; ++a)
    for (let b = j - 1; b <= j + 1; ++b)
      for (let c = k - 1; c <= k + 1; ++c) {
        const id = hash(a, b, c);
        const dx = x - a - 0.2 - 0.6 * id;
        if (dx * dx >= nearest) continue;
        const dy = y - b - 0.2 - 0.6 * hash(a + 71, b, c);
        if (dx * dx + dy * dy >= nearest) continue;
        const dz = z - c - 0.2 - 0.6 * hash(a, b + 71, c);
        const square = dx * dx + dy * dy + dz * dz;
        if (square >= nearest) continue;
        nearest = square;
        found.dx = dx;
        found.dy = dy;
        found.dz = dz;
        found.id = id;
      }
  found.distance = Math.sqrt(nearest);
  return found;
}
