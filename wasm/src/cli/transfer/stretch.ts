import type { Mesh } from '../../api/mesh.js';
import type { TransferResult } from '../../api/result.js';
import { cross, dot, length, minus, pointAt, type Vector } from '../../inspect/geometry.js';

/** How much the texture is stretched on the triangles that may be painted, by their area. */
export interface Stretch {
  /** Length on the target of a unit step in the texture, in the direction in which it is longest: half of the area has less. */
  median: number;
  /** The same for 95 % of the area. */
  p95: number;
  /** Share of the area where it is more than twice the median; or where the texture has no area, so that one texel fills a triangle. */
  overTwice: number;
}

/** Measures how the texture is stretched; `null` if nothing may be painted. Takes time in proportion to the triangles. */
export function stretchOf(
  { positions, indices }: Mesh & { indices: Uint32Array },
  { uvs, cornerUvs, cosmeticTriangles }: Pick<TransferResult, 'uvs' | 'cornerUvs' | 'cosmeticTriangles'>,
): Stretch | null {
  const measured: { area: number; stretch: number }[] = [];
  const uv = (corner: number, k: number) =>
    cornerUvs.length > 0 ? cornerUvs[2 * corner + k]! : uvs[2 * indices[corner]! + k]!;
  for (let t = 0; t < cosmeticTriangles.length; ++t) {
    if (cosmeticTriangles[t] !== 1) continue;
    const [a, b, c] = [3 * t, 3 * t + 1, 3 * t + 2];
    const [origin, ...others] = [a, b, c].map((corner) => pointAt(positions, indices[corner]!));
    const [p, q] = others.map((point) => minus(point, origin!)) as [Vector, Vector];
    const [pu, pv, qu, qv] = [uv(b, 0) - uv(a, 0), uv(b, 1) - uv(a, 1), uv(c, 0) - uv(a, 0), uv(c, 1) - uv(a, 1)];
    const area = length(cross(p, q)) / 2;
    if (area === 0) continue;
    const uvArea = pu * qv - pv * qu;
    // The steps on the target for a unit step in u, and in v.
    const step = (along: number, across: number) =>
      p.map((x, k) => (x * along - q[k]! * across) / uvArea) as never as Vector;
    const [u, v] = [step(qv, pv), step(-qu, -pu)];
    const [uu, vv, both] = [dot(u, u), dot(v, v), dot(u, v)];
    const stretch = uvArea === 0 ? Infinity : Math.sqrt((uu + vv + Math.hypot(uu - vv, 2 * both)) / 2);
    measured.push({ area, stretch });
  }
  measured.sort((one, other) => one.stretch - other.stretch);
  const total = measured.reduce((sum, { area }) => sum + area, 0);
  if (total === 0) return null;
  const within = (share: number) => {
    let sum = 0;
    const found = measured.find(({ area }) => (sum += area) >= share * total) ?? measured.at(-1)!;
    return Number.isFinite(found.stretch) ? found.stretch : Number.MAX_VALUE;
  };
  const median = within(0.5);
  const over = measured.reduce((sum, { area, stretch }) => sum + (stretch > 2 * median ? area : 0), 0);
  return { median, p95: within(0.95), overTwice: over / total };
}
