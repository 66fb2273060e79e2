/** A point, direction or colour: x, y, z. */
export type Vec3 = readonly [number, number, number];

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec3, s: number): Vec3 => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a: Vec3): number => Math.sqrt(dot(a, a));
export const mix = (a: Vec3, b: Vec3, t: number): Vec3 => [
  a[0] + (b[0] - a[0]) * t,
  a[1] + (b[1] - a[1]) * t,
  a[2] + (b[2] - a[2]) * t,
];
export const mirrorX = (a: Vec3): Vec3 => [-a[0], a[1], a[2]];

/** The unit vector along `a`; the zero vector stays zero. */
export const unit = (a: Vec3): Vec3 => scale(a, 1 / (length(a) || 1));

export const clamp = (x: number, low = 0, high = 1): number => Math.min(Math.max(x, low), high);

/** 0 up to `from`, 1 from `to` on, smooth between; `from` may be the larger. */
export const smoothstep = (from: number, to: number, x: number): number => {
  const t = clamp((x - from) / (to - from));
  return t * t * (3 - 2 * t);
};

/** A right-handed orthonormal frame whose third axis is `forward` and whose second leans towards `up`. */
export const frame = (forward: Vec3, up: Vec3 = [0, 1, 0]): [Vec3, Vec3, Vec3] => {
  const f = unit(forward);
  const right = unit(cross(up, f));
  return [right, cross(f, right), f];
};
