// What the paints look like: the colour at a spot of a model. Faces are found by their landmarks.
import { clouds, hash, nearestCell, noise } from './noise';
import type { Frame, Point, Spot } from './spots';

/** Red, green, blue in sRGB and alpha, 0 to 1. */
export type Color = readonly [red: number, green: number, blue: number, alpha: number];

/** Makes the colours of a paint for one model. */
export type Pattern = (frame: Frame) => (spot: Spot) => Color;

const kClear: Color = [0, 0, 0, 0];

const colors = new Map<string, Color>();

/** The opaque colour #rrggbb. */
function color(hex: string): Color {
  const known = colors.get(hex);
  if (known) return known;
  const part = (at: number): number => Number.parseInt(hex.slice(at, at + 2), 16) / 255;
  const made: Color = [part(1), part(3), part(5), 1];
  colors.set(hex, made);
  return made;
}

/** 0 below `from`, 1 above `to`, and smooth between. */
function step(from: number, to: number, x: number): number {
  const t = Math.min(1, Math.max(0, (x - from) / (to - from)));
  return t * t * (3 - 2 * t);
}

/** A colour over another one. @param share  How much of it, besides its own alpha. */
function over(below: Color, above: Color, share = 1): Color {
  const alpha = above[3] * share;
  if (alpha === 0) return below;
  if (alpha === 1) return above;
  const sum = alpha + below[3] * (1 - alpha);
  const mix = (k: 0 | 1 | 2): number => (above[k] * alpha + below[k] * below[3] * (1 - alpha)) / sum;
  return [mix(0), mix(1), mix(2), sum];
}

/** How near a spot is to a landmark: 1 within `inner`, 0 beyond `outer`; stretched by the shape of an ellipse. */
function near(
  at: Point,
  mark: Point | undefined,
  [inner, outer]: readonly [number, number],
  [wide, high]: readonly [number, number] = [1, 1],
): number {
  if (!mark) return 0;
  const x = (at[0] - mark[0]) / wide;
  const y = (at[1] - mark[1]) / high;
  const z = (at[2] - mark[2]) / 1.5;
  const square = x * x + y * y + z * z;
  return square >= outer * outer ? 0 : 1 - step(inner, outer, Math.sqrt(square));
}

/** How near a spot is to a pair of landmarks. */
function nearPair(
  at: Point,
  frame: Frame,
  name: string,
  range: readonly [number, number],
  { shape, moved = [0, 0, 0] }: { shape?: readonly [number, number]; moved?: Point } = {},
): number {
  // The one of its own side is the nearer one.
  const sign = at[0] > 0 ? 1 : -1;
  const mark = frame.pair(name)[sign > 0 ? 0 : 1];
  return near(at, mark && [mark[0] + sign * moved[0], mark[1] + moved[1], mark[2] + moved[2]], range, shape);
}

/** How far a spot is within the lips: 1 on them. */
function onLips(at: Point, frame: Frame): number {
  const [left, right] = [frame.mark('mouth_corner_left'), frame.mark('mouth_corner_right')];
  const [upper, lower] = [frame.mark('lip_upper'), frame.mark('lip_lower')];
  if (!left || !right || !upper || !lower) return 0;
  const half = Math.abs(left[0] - right[0]) / 2;
  const x = (at[0] - (left[0] + right[0]) / 2) / half;
  if (Math.abs(x) > 1.08 || at[2] < Math.min(left[2], right[2]) - 0.2) return 0;
  const corner = (left[1] + right[1]) / 2;
  const bend = Math.sqrt(Math.max(0, 1 - x * x));
  const bow = 0.03 * Math.exp(-((x / 0.13) ** 2)); // Cupid's bow
  const top = corner + (upper[1] - corner) * 1.25 * bend ** 0.8 - bow;
  const bottom = corner + (lower[1] - corner) * 1.25 * bend;
  const edge = 0.03;
  return step(bottom - edge, bottom + edge, at[1]) * (1 - step(top - edge, top + edge, at[1]));
}

/** Around the vertical axis: 0 in front, ±1 behind. */
const around = ([x, , z]: Point): number => Math.atan2(x, z + 0.6) / Math.PI;

/** Where a spot is on a plane that lies about as the surface does, across one of the axes. */
function flat({ at, normal }: Spot, scale: number): { axis: number; u: number; v: number } {
  const axis = Math.abs(normal[0]) > 0.7 ? 0 : Math.abs(normal[1]) > 0.7 ? 1 : 2;
  return { axis, u: at[(axis + 1) % 3]! * scale, v: at[(axis + 2) % 3]! * scale };
}

const tiger: Pattern =
  (frame) =>
  ({ at }) => {
    const [x, y, z] = at;
    const scale = frame.isFace ? 1 : 2.5;
    const warp = 0.5 * clouds(x * 1.3 * scale, y * 1.3 * scale, z * 1.3 * scale, 3);
    const fur = 0.06 * (noise(x * 30, y * 8, z * 30) - 0.5);
    const pale = Math.max(
      nearPair(at, frame, 'eye_centre', [0.28, 0.52], { shape: [1.1, 0.8] }),
      near(at, frame.mark('lip_lower'), [0.45, 0.95], [1.1, 1]),
      near(at, frame.mark('chin'), [0.3, 0.8]),
    );
    let found = over(color('#e8801c'), color('#b4480c'), step(0.2, 1.4, Math.abs(x) / scale + 0.3 * Math.max(0, y)));
    found = over(found, color('#fff4e2'), pale);
    const lines =
      Math.abs(Math.sin(5.2 * (Math.abs(x) * 0.55 + y + warp * 1.6 + fur) * scale)) *
      (0.75 + 0.5 * noise(x * 4, y * 4, z * 4));
    const muzzle = near(at, frame.mark('nose_tip'), [0.35, 0.75], [1, 1.4]);
    const width = 0.3 * (0.25 + step(0.1, 0.7, Math.abs(x) / scale)) * (1 - muzzle);
    found = over(found, color('#17100c'), 1 - step(width, width + 0.12, lines));
    return over(found, color('#2a1512'), 0.9 * near(at, frame.mark('nose_tip'), [0.14, 0.22], [1.2, 0.8]));
  };

const skull: Pattern =
  (frame) =>
  ({ at }) => {
    const [x, y, z] = at;
    const age = clouds(x * 5, y * 5, z * 5);
    let found = over(color('#f3ead6'), color('#b9a888'), 0.7 * step(0.45, 0.75, age));
    if (y > 0.5) {
      const crack = Math.abs(noise(x * 2.2 + 3, y * 2.2, z * 2.2) - 0.5);
      found = over(found, color('#6f6149'), (1 - step(0.004, 0.016, crack)) * step(0.5, 1.2, y));
    }
    found = over(found, color('#0c0a0a'), nearPair(at, frame, 'eye_centre', [0.36, 0.44], { shape: [1.08, 0.94] }));
    const nose = frame.mark('nose_tip');
    if (nose) {
      const [dx, dy] = [Math.abs(x - nose[0]), y - nose[1]];
      const open = 0.05 + 0.16 * step(0.42, -0.12, dy);
      const inside = dy > -0.14 && dy < 0.45 && z > nose[2] - 0.7 ? 1 - step(open - 0.03, open + 0.02, dx) : 0;
      found = over(found, color('#120e0d'), inside * step(0.015, 0.05, dx + 0.25 * step(0.2, 0, dy)));
    }
    found = over(
      found,
      color('#1c1613'),
      0.85 * nearPair(at, frame, 'mouth_corner', [0.2, 0.5], { shape: [0.8, 1.2], moved: [0.42, 0.12, 0] }),
    );
    const mouth = frame.mark('lip_lower');
    const upper = frame.mark('lip_upper');
    if (mouth && upper && z > -0.3) {
      const middle = (mouth[1] + upper[1]) / 2;
      const reach = 1 - step(0.62, 0.72, Math.abs(x));
      const [dy, curve] = [y - middle, 0.05 * x * x];
      const line = 1 - step(0.012, 0.03, Math.abs(dy - curve));
      const teeth = Math.abs(((x / 0.115 + 100) % 1) - 0.5) * 2;
      const gaps = (1 - step(0.03, 0.16, 1 - teeth)) * (1 - step(0.2, 0.24, Math.abs(dy)));
      found = over(found, color('#17110f'), reach * Math.max(line, gaps));
    }
    return over(found, color('#0c0a0a'), step(0.9, 1.5, -z + 0.3 * Math.abs(x)) * 0.5);
  };

/** Colours for lids, cheeks and lips, on bare skin. */
interface Looks {
  lids: string;
  outer: string;
  cheeks: string;
  lips: string;
  shine?: string;
}

const makeUp =
  ({ lids, outer, cheeks, lips, shine }: Looks, strength: number): Pattern =>
  (frame) =>
  ({ at }) => {
    const [x, y, z] = at;
    const lid =
      nearPair(at, frame, 'eye_centre', [0.16, 0.36], { shape: [1.25, 0.85], moved: [0.03, 0.09, 0] }) *
      step(-0.1, 0.02, y);
    const wing =
      nearPair(at, frame, 'eye_outer', [0.02, 0.3], { shape: [1.4, 0.7], moved: [0.08, 0.08, 0] }) *
      step(-0.08, 0.04, y);
    const cheek = nearPair(at, frame, 'mouth_corner', [0.05, 0.5], { shape: [1.15, 0.8], moved: [0.34, 0.55, 0] });
    let found: Color = kClear;
    found = over(found, color(cheeks), 0.45 * strength * cheek);
    found = over(found, color(lids), 0.75 * strength * lid);
    found = over(found, color(outer), 0.8 * strength * wing);
    if (shine && lid > 0) found = over(found, color(shine), lid * step(0.78, 0.92, noise(x * 55, y * 55, z * 55)));
    return over(found, color(lips), 0.92 * onLips(at, frame));
  };

const freckles: Pattern =
  (frame) =>
  ({ at }) => {
    const [x, y, z] = at;
    const scale = 13;
    const { distance, id } = nearestCell(x * scale, y * scale, z * scale);
    const where = Math.max(
      near(at, frame.mark('nasion'), [0.1, 0.75], [1.9, 0.8]),
      0.9 * nearPair(at, frame, 'mouth_corner', [0.1, 0.75], { shape: [1.1, 1], moved: [0.25, 0.55, 0] }),
    );
    const dot = 1 - step(0.12 + 0.16 * id, 0.26 + 0.2 * id, distance);
    const blush = over(kClear, color('#e0715c'), 0.28 * where);
    return over(
      blush,
      color('#8a4a28'),
      dot * where * (0.45 + 0.5 * id) * step(0.35, 0.6, hash(Math.round(id * 1e6), 3, 7) * 0.5 + where * 0.7),
    );
  };

/** Bands of a flag, from left to right as one looks at it, with the edges that a brush leaves. */
const flag =
  (bands: readonly string[], isUpright: boolean): Pattern =>
  (frame) =>
  ({ at }) => {
    const [x, y, z] = at;
    const reach = frame.isFace ? 1.25 : 1;
    const t = isUpright ? (x / reach + 1) / 2 : (0.9 - y) / 2.7;
    const rough = 0.035 * (clouds(x * 9, y * 3, z * 9, 3) - 0.5);
    const place = Math.min(0.999, Math.max(0, t + rough)) * bands.length;
    const band = Math.floor(place);
    const streak = 0.9 + 0.1 * noise(isUpright ? x * 40 : x * 3, isUpright ? y * 3 : y * 40, z * 3);
    const edge = Math.min(place - band, band + 1 - place);
    const gap = band > 0 || place - band > 0.5 ? (band < bands.length - 1 || band + 1 - place > 0.5 ? edge : 1) : 1;
    const covers = step(-0.02, 0.03, gap);
    const [r, g, b] = color(bands[bands.length - 1 - band]!);
    const face = frame.isFace ? step(-0.95, -0.5, z) : 1;
    return [r * streak, g * streak, b * streak, 0.94 * covers * face];
  };

const camouflage: Pattern =
  (frame) =>
  ({ at }) => {
    const scale = frame.isFace ? 1.5 : 3;
    const [x, y, z] = at.map((v) => v * scale) as unknown as Point;
    const field = (dx: number): number => clouds(x + dx, y * 1.25, z, 3);
    let found = color('#6d7444');
    found = over(found, color('#3c4a2c'), step(0.515, 0.53, field(7)));
    found = over(found, color('#5a4630'), step(0.55, 0.565, field(31)));
    return over(found, color('#17190f'), step(0.585, 0.6, field(53)));
  };

const carbon: Pattern =
  (frame) =>
  ({ at, normal }) => {
    const scale = frame.isFace ? 16 : 42;
    const { u, v } = flat({ at, normal }, scale);
    const isAcross = (Math.floor(u) + Math.floor(v)) % 4 < 2 !== (Math.floor(v) % 2 === 0);
    const thread = isAcross ? u - Math.floor(u) : v - Math.floor(v);
    const lit = 0.075 + 0.13 * Math.sin(Math.PI * thread) * (isAcross ? 1 : 0.55);
    const base: Color = [lit, lit * 1.02, lit * 1.08, 1];
    const stripe = 1 - step(0.1, 0.115, Math.abs(Math.abs(at[0]) - 0.24));
    const thin = 1 - step(0.02, 0.03, Math.abs(Math.abs(at[0]) - 0.42));
    return over(over(base, color('#e02a20'), stripe), color('#f4f4f4'), thin);
  };

const circuit: Pattern =
  (frame) =>
  ({ at, normal }) => {
    const scale = frame.isFace ? 5 : 9;
    const { axis, u, v } = flat({ at, normal }, scale);
    const [i, j] = [Math.floor(u), Math.floor(v)];
    const [x, y] = [u - i - 0.5, v - j - 0.5];
    // Each cell is joined to those of its neighbours that the edge between them says.
    const joined = [
      hash(i, j, axis) > 0.42,
      hash(i + 1, j, axis) > 0.42,
      hash(i, j + 57, axis) > 0.42,
      hash(i, j + 58, axis) > 0.42,
    ];
    const arms = [
      joined[0] && x < 0 ? Math.abs(y) : 1,
      joined[1] && x > 0 ? Math.abs(y) : 1,
      joined[2] && y < 0 ? Math.abs(x) : 1,
      joined[3] && y > 0 ? Math.abs(x) : 1,
    ];
    const count = joined.filter(Boolean).length;
    const pad = count === 1 || count > 2 ? Math.abs(Math.hypot(x, y) - 0.15) : 1;
    const line = Math.min(...arms.map((arm) => (Math.hypot(x, y) < 0.15 && pad < 1 ? 1 : arm)), pad);
    const glow = 1 - step(0.0, 0.28, line);
    const bright = 1 - step(0.025, 0.055, line);
    const base = over(color('#071a1c'), color('#0d3a35'), 0.6 * noise(at[0] * 6, at[1] * 6, at[2] * 6));
    return over(over(base, color('#12b89a'), 0.5 * glow), color('#c8fff0'), bright);
  };

const kPetals = ['#ffffff', '#ffd34d', '#ff8fb3', '#b58cff', '#ff7b54'];

const flowers: Pattern =
  (frame) =>
  ({ at, normal }) => {
    const scale = frame.isFace ? 2.1 : 4.4;
    let found = over(color('#2f7d5b'), color('#14523f'), clouds(at[0] * 4, at[1] * 4, at[2] * 4));
    const leaf = Math.abs(noise(at[0] * 5 + 9, at[1] * 5, at[2] * 5) - 0.5);
    found = over(found, color('#6fb583'), 0.7 * (1 - step(0.01, 0.04, leaf)));
    for (const [n, size] of [
      [0, 1],
      [40, 1.55],
    ] as const) {
      const { dx, dy, dz, id } = nearestCell(at[0] * scale * size + n, at[1] * scale * size, at[2] * scale * size);
      // In the plane of the surface.
      const off = dx * normal[0] + dy * normal[1] + dz * normal[2];
      const [px, py, pz] = [dx - off * normal[0], dy - off * normal[1], dz - off * normal[2]];
      const radius = Math.hypot(px, py, pz);
      const side = Math.abs(normal[1]) < 0.9 ? [normal[2], 0, 0 - normal[0]] : [1, 0, 0];
      const along = Math.hypot(side[0]!, side[2]!) || 1;
      const a = (px * side[0]! + pz * side[2]!) / along;
      const b = Math.sqrt(Math.max(0, radius * radius - a * a)) * Math.sign(py || 1);
      const petals = 5 + Math.floor(id * 3);
      const outline =
        (0.27 + 0.1 * id) * (0.68 + 0.32 * Math.abs(Math.cos((petals / 2) * (Math.atan2(b, a) + 6 * id))));
      const inside = Math.abs(off) < 0.45 ? 1 - step(outline - 0.02, outline + 0.015, radius) : 0;
      const petal = color(kPetals[Math.floor(id * 977) % kPetals.length]!);
      found = over(found, over(petal, color('#7a2f55'), 0.35 * (1 - step(0.05, 0.24, radius))), inside);
      found = over(found, color('#f2b705'), Math.abs(off) < 0.45 ? 1 - step(0.07, 0.09, radius) : 0);
    }
    return found;
  };

const harlequin: Pattern =
  (frame) =>
  ({ at }) => {
    const scale = frame.isFace ? 1 : 2;
    const [u, v] = [around(at) * 6 * scale, at[1] * 1.05 * scale];
    const [p, q] = [u + v, u - v];
    const [i, j] = [Math.floor(p), Math.floor(q)];
    const edge = Math.min(p - i, i + 1 - p, q - j, j + 1 - q);
    const tone = color(['#8c1c3a', '#f0d8a8', '#1f4e6b', '#d9a441'][(((i % 2) + 2) % 2) * 2 + (((j % 2) + 2) % 2)]!);
    const worn = 0.92 + 0.08 * noise(at[0] * 20, at[1] * 20, at[2] * 20);
    const base: Color = [tone[0] * worn, tone[1] * worn, tone[2] * worn, 1];
    return over(base, color('#f7e7b0'), 1 - step(0.02, 0.045, edge));
  };

const scales: Pattern =
  (frame) =>
  ({ at }) => {
    const scale = frame.isFace ? 1 : 2;
    const [u, v] = [around(at) * 17 * scale, at[1] * 4.6 * scale];
    // Rows that overlap like tiles: of the two rows that reach a spot the lower one is in front.
    const row = Math.floor(v);
    const within = (r: number): number => {
      const x = u - Math.floor(u + (r % 2 ? 0.5 : 0)) - (r % 2 ? 0 : 0.5);
      return Math.hypot(x * 1.25, v - r - 1);
    };
    const [front, behind] = [within(row), within(row + 1)];
    const d = front < 0.98 ? front : behind * 0.6;
    const shade = step(0.25, 1, d);
    const tone = clouds(at[0] * 1.6, at[1] * 1.6, at[2] * 1.6);
    const base = over(color('#0b6d72'), color('#2b2f8f'), step(0.35, 0.65, tone));
    const rim = step(0.84, 0.97, d) * (front < 0.98 ? 1 : 0);
    return over(over(base, color('#8ff0d4'), 0.75 * (1 - shade)), color('#062a3a'), 0.9 * rim);
  };

/** By the names of the paints. */
export const patterns: Readonly<Record<string, Pattern>> = {
  tiger,
  skull,
  'soft-make-up': makeUp({ lids: '#b98a6a', outer: '#7a4a3a', cheeks: '#e88a86', lips: '#c4586a' }, 0.8),
  'stage-make-up': makeUp(
    { lids: '#2a4fb8', outer: '#141033', cheeks: '#e0407a', lips: '#b00f30', shine: '#ffe9a8' },
    1.1,
  ),
  freckles,
  tricolour: flag(['#1d4fa3', '#f7f7f4', '#c8202f'], true),
  'club-colours': flag(['#f2c230', '#101418', '#f2c230', '#101418', '#f2c230'], false),
  camouflage,
  carbon,
  circuit,
  flowers,
  harlequin,
  scales,
};
