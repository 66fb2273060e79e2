import { dot, frame, type Vec3 } from './vec.ts';

/**
 * A solid as a field: negative inside, zero on the surface, positive outside, roughly the distance to it.
 * Plain numbers instead of vectors, for it is called millions of times.
 */
export type Sdf = (x: number, y: number, z: number) => number;

export const sphere =
  (c: Vec3, r: number): Sdf =>
  (x, y, z) =>
    Math.sqrt((x - c[0]) ** 2 + (y - c[1]) ** 2 + (z - c[2]) ** 2) - r;

/** An ellipsoid with radii `r` along the axes, or along `axes` (unit, orthogonal). Near its surface a true distance. */
export const ellipsoid = (c: Vec3, r: Vec3, axes?: readonly [Vec3, Vec3, Vec3]): Sdf => {
  const field = (x: number, y: number, z: number): number => {
    const a = x / r[0];
    const b = y / r[1];
    const d = z / r[2];
    const k0 = Math.sqrt(a * a + b * b + d * d);
    if (k0 < 1e-9) return -Math.min(...r);
    const k1 = Math.sqrt((a / r[0]) ** 2 + (b / r[1]) ** 2 + (d / r[2]) ** 2);
    return (k0 * (k0 - 1)) / k1;
  };
  if (!axes) return (x, y, z) => field(x - c[0], y - c[1], z - c[2]);
  return (x, y, z) => {
    const p: Vec3 = [x - c[0], y - c[1], z - c[2]];
    return field(dot(p, axes[0]), dot(p, axes[1]), dot(p, axes[2]));
  };
};

/** The hull of two balls: a capsule whose radius goes from `ra` at `a` to `rb` at `b`. */
export const roundCone = (a: Vec3, b: Vec3, ra: number, rb = ra): Sdf => {
  const [bx, by, bz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
  const l2 = bx * bx + by * by + bz * bz;
  const rr = ra - rb;
  const a2 = l2 - rr * rr;
  const il2 = 1 / l2;
  return (px, py, pz) => {
    const x = px - a[0];
    const y = py - a[1];
    const z = pz - a[2];
    const along = x * bx + y * by + z * bz;
    const beyond = along - l2;
    const qx = x * l2 - bx * along;
    const qy = y * l2 - by * along;
    const qz = z * l2 - bz * along;
    const x2 = qx * qx + qy * qy + qz * qz;
    const y2 = along * along * l2;
    const z2 = beyond * beyond * l2;
    const k = Math.sign(rr) * rr * rr * x2;
    if (Math.sign(beyond) * a2 * z2 > k) return Math.sqrt(x2 + z2) * il2 - rb;
    if (Math.sign(along) * a2 * y2 < k) return Math.sqrt(x2 + y2) * il2 - ra;
    return (Math.sqrt(x2 * a2 * il2) + along * rr) * il2 - ra;
  };
};

/** A chain of round cones through `points`, each x, y, z and radius. */
export const tube = (points: readonly (readonly [number, number, number, number])[]): Sdf =>
  union(
    ...points.slice(1).map((p, i) => {
      const q = points[i]!;
      return roundCone([q[0], q[1], q[2]], [p[0], p[1], p[2]], q[3], p[3]);
    }),
  );

/** A box of half sizes `h` about `c`, its edges rounded by `r` (within the size). */
export const box =
  (c: Vec3, h: Vec3, r = 0): Sdf =>
  (x, y, z) => {
    const a = Math.abs(x - c[0]) - h[0] + r;
    const b = Math.abs(y - c[1]) - h[1] + r;
    const d = Math.abs(z - c[2]) - h[2] + r;
    const out = Math.sqrt(Math.max(a, 0) ** 2 + Math.max(b, 0) ** 2 + Math.max(d, 0) ** 2);
    return out + Math.min(Math.max(a, b, d), 0) - r;
  };

/** The distance to a flat polygon, negative inside it. */
export const polygon =
  (points: readonly (readonly [number, number])[]): ((u: number, v: number) => number) =>
  (u, v) => {
    let d = Infinity;
    let inside = false;
    points.forEach((a, i) => {
      const b = points[(i + 1) % points.length]!;
      const [ex, ey] = [b[0] - a[0], b[1] - a[1]];
      const [px, py] = [u - a[0], v - a[1]];
      const t = Math.min(Math.max((px * ex + py * ey) / (ex * ex + ey * ey), 0), 1);
      d = Math.min(d, Math.hypot(px - t * ex, py - t * ey));
      if (a[1] > v !== b[1] > v && u < a[0] + ((v - a[1]) / ey) * ex) inside = !inside;
    });
    return inside ? -d : d;
  };

/** A ring about an axis parallel to x through `c`: its radius, and the radius of its tube. */
export const ring =
  (c: Vec3, radius: number, tubeRadius: number): Sdf =>
  (x, y, z) =>
    Math.hypot(Math.hypot(y - c[1], z - c[2]) - radius, x - c[0]) - tubeRadius;

/** A disc about an axis parallel to x through `c`, `half` to each side, its edges rounded by `r`. */
export const disc =
  (c: Vec3, radius: number, half: number, r = 0): Sdf =>
  (x, y, z) => {
    const a = Math.hypot(y - c[1], z - c[2]) - radius + r;
    const b = Math.abs(x - c[0]) - half + r;
    return Math.min(Math.max(a, b), 0) + Math.hypot(Math.max(a, 0), Math.max(b, 0)) - r;
  };

/** The half-space on the side that unit normal `n` points away from; its surface goes through `p`. */
export const halfSpace = (p: Vec3, n: Vec3): Sdf => {
  const d = dot(p, n);
  return (x, y, z) => x * n[0] + y * n[1] + z * n[2] - d;
};

export const union = (...s: Sdf[]): Sdf => {
  return (x, y, z) => {
    let d = s[0]!(x, y, z);
    for (let i = 1; i < s.length; i++) d = Math.min(d, s[i]!(x, y, z));
    return d;
  };
};

const blend = (k: number, a: number, b: number): number => {
  const h = Math.max(k - Math.abs(a - b), 0);
  return Math.min(a, b) - (h * h) / (4 * k);
};

/** Union whose creases are filled over a width of `k`. */
export const smoothUnion = (k: number, ...s: Sdf[]): Sdf => {
  return (x, y, z) => {
    let d = s[0]!(x, y, z);
    for (let i = 1; i < s.length; i++) d = blend(k, d, s[i]!(x, y, z));
    return d;
  };
};

/** Intersection whose edges are rounded over a width of `k`. */
export const smoothIntersect = (k: number, ...s: Sdf[]): Sdf => {
  return (x, y, z) => {
    let d = s[0]!(x, y, z);
    for (let i = 1; i < s.length; i++) d = -blend(k, -d, -s[i]!(x, y, z));
    return d;
  };
};

/** `a` without `b`, the rim of the cut rounded over a width of `k`. */
export const smoothSubtract =
  (k: number, a: Sdf, ...cuts: Sdf[]): Sdf =>
  (x, y, z) => {
    let d = a(x, y, z);
    for (const cut of cuts) d = -blend(k, -d, cut(x, y, z));
    return d;
  };

/** `s` and its mirror image: only its side x ≥ 0 is asked, or x ≥ `round` to leave no crease in the middle. */
export const mirrored =
  (s: Sdf, round = 0): Sdf =>
  (x, y, z) =>
    s(Math.sqrt(x * x + round * round), y, z);

/**
 * `s`, a solid within the ball (c, r), not asked beyond `margin` around it: far away the distance to the ball will do.
 * Blends with it must not be wider than `margin`.
 */
export const local = (c: Vec3, r: number, margin: number, s: Sdf): Sdf => {
  const ball = sphere(c, r);
  return (x, y, z) => {
    const d = ball(x, y, z);
    return d > margin ? d : s(x, y, z);
  };
};

/** `s` grown by `r` (shrunk if negative). */
export const offset =
  (s: Sdf, r: number): Sdf =>
  (x, y, z) =>
    s(x, y, z) - r;

/** `s` turned about the x axis through `pivot`, from +y towards +z by `angle` radians. */
export const turnedX = (s: Sdf, pivot: Vec3, angle: number): Sdf => {
  const c = Math.cos(angle);
  const n = Math.sin(angle);
  return (x, py, pz) => {
    const y = py - pivot[1];
    const z = pz - pivot[2];
    return s(x, y * c + z * n + pivot[1], z * c - y * n + pivot[2]);
  };
};

/** An ellipsoid whose third radius points along `forward`. */
export const lens = (c: Vec3, r: Vec3, forward: Vec3, up?: Vec3): Sdf => ellipsoid(c, r, frame(forward, up));

/** The unit gradient of the field: the surface's outward normal. */
export const gradient = (s: Sdf, p: Vec3, h = 1e-4): Vec3 => {
  const [x, y, z] = p;
  const gx = s(x + h, y, z) - s(x - h, y, z);
  const gy = s(x, y + h, z) - s(x, y - h, z);
  const gz = s(x, y, z + h) - s(x, y, z - h);
  const l = Math.sqrt(gx * gx + gy * gy + gz * gz) || 1;
  return [gx / l, gy / l, gz / l];
};
