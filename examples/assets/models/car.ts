import { makeCage } from '../cage.ts';
import { type Part, textured } from '../glb.ts';
import { lit, mixColour, over, type Rgba, rgb, type Shade } from '../image.ts';
import { bothSides, finderOn, inMiddle } from '../landmarks.ts';
import {
  clip,
  join,
  type Mesh,
  mirror,
  point,
  reflected,
  settleOn,
  simplify,
  surface,
  symmetricSurface,
  triangleCount,
  vertexCount,
  withFieldNormals,
} from '../mesh.ts';
import type { Model } from '../model.ts';
import { fractal } from '../noise.ts';
import {
  box,
  disc,
  ellipsoid,
  mirrored,
  offset,
  polygon,
  ring,
  roundCone,
  type Sdf,
  smoothIntersect,
  smoothSubtract,
  smoothUnion,
  turnedX,
  union,
} from '../sdf.ts';
import { lathe, spokedRim } from '../shapes.ts';
import { namedHoles, symmetric, type Template } from '../template.ts';
import { boxAtlas, pelt } from '../unwrap.ts';
import { scale, smoothstep, type Vec3 } from '../vec.ts';

// Metres. The car drives towards +z and stands on y = 0; its left is +x.
const kAxles = [1.3, -1.32] as const;
const kWheel = { radius: 0.335, x: 0.775, half: 0.1 };
const kArch = 0.395;
const kSill = 0.235; // the body ends at this y

// ---- the body's outer surface, without any opening ----

/** The height of bonnet, belt and boot along the car. */
const deck = (z: number): number => {
  if (z > 0.8) {
    const t = (z - 0.8) / 1.3;
    return 0.93 - 0.045 * t - 0.15 * t * t * t;
  }
  if (z < -1.2) {
    const t = (-1.2 - z) / 0.9;
    return 0.965 - 0.07 * t * t;
  }
  return 0.93 + 0.0175 * (0.8 - z);
};
const flank = (y: number, z: number): number =>
  0.88 - 0.07 * ((y - 0.55) / 0.4) ** 2 - 0.085 * (z / 2.1) ** 4 + 0.012 * smoothstep(0.79, 0.74, y);
const lower: Sdf = smoothIntersect(
  0.13,
  (_x, y, z) => (y - deck(z)) * 0.98,
  (x, y, z) => x - flank(y, z),
  (x, y, z) =>
    (z - 2.14 + 0.13 * (x / 0.85) ** 2 + 0.22 * Math.max(y - 0.5, 0) ** 2 * 2 + 0.4 * Math.max(0.4 - y, 0) ** 2) * 0.96,
  (x, y, z) =>
    (-z - 2.1 + 0.1 * (x / 0.85) ** 2 + 0.3 * Math.max(y - 0.8, 0) ** 2 + 0.5 * Math.max(0.45 - y, 0) ** 2) * 0.97,
  (_x, y) => 0.16 - y,
);
/** The plane through two points of the side view (z, y) and square to it; outside is above. */
const slope = (a: readonly [number, number], b: readonly [number, number], bow = 0): Sdf => {
  const [dz, dy] = [b[0] - a[0], b[1] - a[1]];
  const l = Math.hypot(dz, dy);
  return (x, y, z) => ((y - a[1]) * dz - (z - a[0]) * dy) / l + bow * x * x;
};
const cabin: Sdf = smoothIntersect(
  0.12,
  slope([0.2, 1.43], [1.02, 0.9], 0.12),
  slope([-1.62, 0.93], [-0.9, 1.4], 0.12),
  (x, y, z) => y - 1.425 + 0.05 * ((z + 0.25) / 0.6) ** 2 + 0.06 * x * x,
  (x, y) => (x - 0.785 + 0.38 * (y - 0.92)) * 0.935,
  (_x, y) => 0.6 - y,
);
const flare = union(...kAxles.map((z) => ring([0.845, kWheel.radius, z], kArch + 0.01, 0.032)));
const shell: Sdf = mirrored(smoothUnion(0.05, smoothUnion(0.05, lower, cabin), flare), 0.01);
const mirrorHousing = smoothUnion(
  0.03,
  ellipsoid([0.98, 0.99, 0.71], [0.105, 0.068, 0.06]),
  roundCone([0.8, 0.93, 0.72], [0.93, 0.965, 0.71], 0.022),
);

// ---- where the openings are; each field is negative inside, and goes through the body along one axis ----

const sideWindows = [
  polygon([
    [0.6, 0.965],
    [0.04, 1.315],
    [-0.25, 1.325],
    [-0.25, 0.965],
  ]),
  polygon([
    [-0.33, 0.965],
    [-0.33, 1.325],
    [-0.82, 1.285],
    [-1.16, 1.06],
    [-1.16, 0.975],
  ]),
];
const screen = polygon([
  [-0.66, 0.975],
  [0.66, 0.975],
  [0.545, 1.325],
  [-0.545, 1.325],
]);
const rearScreen = polygon([
  [-0.62, 1.015],
  [0.62, 1.015],
  [0.52, 1.3],
  [-0.52, 1.3],
]);
const headlight = polygon([
  [0.44, 0.6],
  [0.79, 0.635],
  [0.76, 0.745],
  [0.5, 0.7],
]);
const taillight = polygon([
  [0.45, 0.66],
  [0.83, 0.64],
  [0.82, 0.8],
  [0.5, 0.78],
]);
const grille = polygon([
  [-0.36, 0.42],
  [0.36, 0.42],
  [0.4, 0.58],
  [-0.4, 0.58],
]);
const kRound = 0.03; // radius of the openings' corners

interface Opening {
  name: string;
  field: Sdf;
}
const alongZ = (shape: (u: number, v: number) => number, from: number, to: number): Sdf => {
  return (x, y, z) => Math.max(shape(x, y) - kRound + 0.03, from - z, z - to);
};
const openings: Opening[] = [
  { name: 'windscreen', field: alongZ(screen, 0.15, 1.2) },
  { name: 'rear-window', field: alongZ(rearScreen, -1.8, -0.8) },
  ...sideWindows.map((shape, i) => ({
    name: ['front-windows', 'rear-windows'][i]!,
    field: ((x, y, z) => Math.max(shape(z, y), 0.45 - x)) as Sdf,
  })),
  { name: 'headlights', field: alongZ(headlight, 1.5, 2.5) },
  { name: 'taillights', field: alongZ(taillight, -2.5, -1.5) },
  { name: 'grille', field: alongZ(grille, 1.8, 2.5) },
];
const arch = (grow: number): Sdf =>
  union(
    ...kAxles.map(
      (cz): Sdf =>
        (x, y, z) =>
          Math.max(Math.hypot(y - kWheel.radius, z - cz) - kArch - grow, 0.45 - x),
    ),
  );
const bumperLine = (p: Vec3): number => 0.41 + 0.04 * smoothstep(1.6, 2.1, Math.abs(p[2])) - p[1]; // positive below it

// ---- parts ----

const bounds = { min: [-0.05, 0.05, -2.25] as Vec3, max: [1.0, 1.55, 2.28] as Vec3 };

/** A piece of the shell's right half, with few triangles, and its mirror image. */
const panel = (half: Mesh, keep: (p: Vec3) => number, triangles: number, inset = 0): Mesh => {
  const piece = clip(half, keep);
  const few = simplify(piece, Math.min(triangles / 2, triangleCount(piece)));
  const whole = mirror(few);
  const { normals } = withFieldNormals(whole, shell);
  return {
    positions: whole.positions.map((x, i) => x - inset * normals![i]!),
    indices: whole.indices,
    normals: normals!,
  };
};

/** The same surface with its other side outside. */
const turned = ({ positions, indices, normals }: Mesh): Mesh => {
  return {
    positions,
    indices: indices.map((_, i) => indices[i - (i % 3) + [0, 2, 1][i % 3]!]!),
    normals: normals!.map((x) => -x),
  };
};

const tyreProfile: [number, number][] = [
  [0.2, 0.07],
  [0.235, 0.098],
  [0.3, 0.1],
  [0.328, 0.08],
  [0.335, 0.04],
  [0.335, -0.04],
  [0.328, -0.08],
  [0.3, -0.1],
  [0.235, -0.098],
  [0.2, -0.075],
  [0.01, -0.07],
];

const rimProfile: [number, number][] = [
  [0, -0.01],
  [0.165, -0.01],
  [0.192, -0.07],
  [0.213, -0.075],
  [0.213, 0.074],
  [0.203, 0.08],
  [0.192, 0.052],
  [0.075, 0.03],
  [0.055, 0.052],
  [0, 0.055],
];

const kSeat: Vec3 = [0.36, 0.3, -0.1];
const seat = (at: Vec3, half: number): Sdf => {
  const base = smoothUnion(
    0.03,
    box([at[0], at[1] + 0.15, at[2] + 0.12], [half, 0.07, 0.25], 0.05),
    box([at[0], at[1] + 0.06, at[2] + 0.1], [half * 0.8, 0.08, 0.2], 0.03),
  );
  const backrest = turnedX(
    smoothUnion(
      0.04,
      box([at[0], at[1] + 0.44, at[2] - 0.14], [half, 0.3, 0.06], 0.055),
      box([at[0], at[1] + 0.8, at[2] - 0.14], [Math.min(half, 0.12), 0.075, 0.045], 0.04),
    ),
    [at[0], at[1] + 0.15, at[2] - 0.14],
    -0.22,
  );
  return smoothUnion(0.02, base, backrest);
};
const seatsSolid: Sdf = mirrored(
  union(
    seat(kSeat, 0.24),
    smoothIntersect(0.02, seat([0.2, 0.32, -0.84], 0.4), (x) => x - 0.56),
  ),
);
const dashboardSolid: Sdf = mirrored(
  smoothUnion(0.04, box([0, 0.83, 0.86], [0.66, 0.085, 0.16], 0.06), box([0, 0.6, 0.78], [0.12, 0.2, 0.14], 0.04)),
);
/** The floor with its wheel wells: what is left of the shell's inside below the seats. */
const floorSolid: Sdf = mirrored(
  smoothSubtract(
    0.03,
    smoothIntersect(
      0.03,
      offset(shell, -0.03),
      (_x, y) => y - 0.66,
      (_x, y) => 0.25 - y,
    ),
    union(...kAxles.map((z) => disc([0.85, kWheel.radius, z], kArch + 0.012, 0.33))),
    box([0, 0.8, -0.25], [0.7, 0.5, 1.15], 0.05),
  ),
);

const steeringWheel = (): Mesh => {
  const solid: Sdf = (x, y, z) => {
    // The wheel lies in the plane of y' and x; z' is its axis, tilted back.
    const [dx, dy, dz] = [x - 0.36, y - 0.87, z - 0.55];
    const v = dy * 0.91 + dz * 0.42;
    const w = -dy * 0.42 + dz * 0.91;
    const r = Math.hypot(dx, v);
    const rimPart = Math.hypot(r - 0.18, w) - 0.017;
    const spoke = Math.max(Math.abs(v + 0.01) - 0.022, Math.abs(dx) - 0.18, Math.abs(w - 0.02) - 0.009);
    const spokeDown = Math.max(Math.abs(dx) - 0.02, v, -0.18 - v, Math.abs(w - 0.02) - 0.009);
    const hub = Math.max(r - 0.055, Math.abs(w - 0.02) - 0.02);
    const column = Math.max(r - 0.024, -w, w - 0.28);
    return Math.min(rimPart, spoke, spokeDown, hub, column);
  };
  const fine = surface(solid, { min: [0.14, 0.6, 0.4], max: [0.58, 1.1, 0.95] }, 0.014);
  const few = simplify(fine, 300);
  return withFieldNormals(few, solid);
};

// ---- looks ----

const line = (distance: number, width = 0.004): number => smoothstep(width + 0.003, width, Math.abs(distance));
const doors = [
  polygon([
    [0.78, 0.33],
    [0.7, 0.95],
    [0.02, 1.37],
    [-0.29, 1.37],
    [-0.29, 0.33],
  ]),
  polygon([
    [-0.29, 0.33],
    [-0.29, 1.37],
    [-0.85, 1.33],
    [-1.25, 0.97],
    [-0.92, 0.6],
    [-0.9, 0.33],
  ]),
];
const bodyShade: Shade = (p, n) => {
  const [x, y, z] = [Math.abs(p[0]), p[1], p[2]];
  let c = rgb('#b9c3cc');
  const onSide = x > 0.5 && Math.abs(n[0]) > 0.45 ? 1 : 0;
  let seams = 0;
  for (const door of doors) seams = Math.max(seams, onSide * line(door(z, y)));
  const onTop = n[1] > 0.5 ? 1 : 0;
  seams = Math.max(
    seams,
    onTop *
      (z > 0 ? line(x - 0.7 + 0.05 * (z - 1)) * smoothstep(0.98, 1.0, z) : line(x - 0.66) * smoothstep(-1.58, -1.6, z)),
  );
  seams = Math.max(
    seams,
    onTop *
      (z > 0 ? line(z - 1.99 + 0.12 * x * x) : line(z + 1.63 - 0.05 * x * x)) *
      smoothstep(0.7, 0.69, x) *
      (y < 1 ? 1 : 0),
  );
  // Handles and the filler cap.
  for (const at of [-0.16, -0.8])
    seams = Math.max(seams, onSide * 0.7 * line(Math.hypot(Math.max(Math.abs(z - at) - 0.06, 0), y - 0.86) - 0.02));
  if (p[0] < 0) seams = Math.max(seams, onSide * line(Math.hypot(z + 1.5, y - 0.82) - 0.07));
  c = mixColour(c, rgb('#23282d'), seams * 0.9);
  return lit(c, 0.97 + 0.05 * fractal(scale(p, 30)));
};

const headlightShade: Shade = (p) => {
  let c = rgb('#5d6a74');
  for (const [x, y, r] of [
    [0.57, 0.66, 0.042],
    [0.69, 0.685, 0.042],
  ] as const) {
    const d = Math.hypot(Math.abs(p[0]) - x, p[1] - y);
    c = mixColour(c, rgb('#20262b'), smoothstep(r + 0.012, r + 0.006, d));
    c = mixColour(c, rgb('#fbf8ea'), smoothstep(r, r - 0.012, d));
  }
  return c;
};
const taillightShade: Shade = (p) => {
  const lens = mixColour(rgb('#a80f16'), rgb('#f2efe8'), smoothstep(0.008, 0.006, Math.abs(p[1] - 0.72) - 0.012));
  return lit(lens, 0.85 + 0.15 * smoothstep(0.3, 0.7, Math.sin(p[1] * 400) * 0.5 + 0.5));
};

// ---- paints ----

type Stroke = readonly (readonly [number, number])[];
/** Digits as strokes in a box one high and 0.6 wide. */
const digits: Record<string, Stroke[]> = {
  '2': [
    [
      [0.06, 0.76],
      [0.12, 0.9],
      [0.3, 0.97],
      [0.48, 0.9],
      [0.54, 0.74],
      [0.48, 0.56],
      [0.06, 0.05],
      [0.56, 0.05],
    ],
  ],
  '7': [
    [
      [0.04, 0.95],
      [0.56, 0.95],
      [0.24, 0.03],
    ],
  ],
  '4': [
    [
      [0.44, 0.03],
      [0.44, 0.97],
      [0.04, 0.32],
      [0.58, 0.32],
    ],
  ],
};
const strokeDistance = (stroke: Stroke, u: number, v: number): number => {
  let d = Infinity;
  for (let i = 0; i + 1 < stroke.length; i++) {
    const [a, b] = [stroke[i]!, stroke[i + 1]!];
    const [ex, ey] = [b[0] - a[0], b[1] - a[1]];
    const t = Math.min(Math.max(((u - a[0]) * ex + (v - a[1]) * ey) / (ex * ex + ey * ey), 0), 1);
    d = Math.min(d, Math.hypot(u - a[0] - t * ex, v - a[1] - t * ey));
  }
  return d;
};
/** How much of a number's ink lies at (u, v), which count from its middle in units of its height. */
const ink = (number: string, u: number, v: number): number => {
  const width = 0.72;
  let d = Infinity;
  [...number].forEach((digit, i) => {
    const left = (i - number.length / 2) * width + (width - 0.6) / 2;
    for (const stroke of digits[digit]!) d = Math.min(d, strokeDistance(stroke, u - left, v + 0.5));
  });
  return smoothstep(0.1, 0.085, d);
};
/** A white roundel with a number, at (u, v) from its middle. */
const roundel = (under: Rgba, number: string, u: number, v: number, radius: number): Rgba => {
  const r = Math.hypot(u, v);
  let c = over(under, rgb('#101216'), smoothstep(radius + 0.015, radius + 0.008, r));
  c = over(c, rgb('#f6f4ee'), smoothstep(radius, radius - 0.008, r));
  return over(c, rgb('#101216'), ink(number, u / radius, v / radius) * smoothstep(radius, radius - 0.01, r));
};
/** Puts a number on both doors, the bonnet and the roof, each to be read from its side. */
const numbered = (c: Rgba, p: Vec3, n: Vec3, number: string): Rgba => {
  const side = Math.abs(n[0]) > 0.6 && Math.abs(p[0]) > 0.5;
  if (side) return roundel(c, number, (p[0] > 0 ? -1 : 1) * (p[2] - 0.12), p[1] - 0.62, 0.235);
  if (n[1] > 0.5 && p[2] > 0.9) return roundel(c, number, p[0], -(p[2] - 1.5), 0.29);
  if (n[1] > 0.5 && p[1] > 1.3) return roundel(c, number, p[0], -(p[2] + 0.3), 0.33);
  return c;
};
const racing: Shade = (p, n) => {
  let c = rgb('#c4161c');
  const x = Math.abs(p[0]);
  const stripes = smoothstep(0.035, 0.03, Math.abs(x - 0.34)) + smoothstep(0.205, 0.2, x);
  if (Math.abs(n[0]) < 0.6 || x < 0.5) c = mixColour(c, rgb('#f6f4ee'), Math.min(stripes, 1));
  else {
    // A band that rises towards the back, and a chequered one along the sill.
    const band = p[1] - 0.5 + 0.07 * p[2];
    c = mixColour(c, rgb('#f6f4ee'), smoothstep(0.1, 0.095, Math.abs(band - 0.1)));
    c = mixColour(c, rgb('#101216'), smoothstep(0.012, 0.009, Math.abs(Math.abs(band - 0.1) - 0.125)));
    const check = (Math.floor(p[2] / 0.055 + 1000) + Math.floor(p[1] / 0.055)) % 2;
    c = mixColour(c, check ? rgb('#f6f4ee') : rgb('#101216'), smoothstep(0.345, 0.335, p[1]));
  }
  return numbered(c, p, n, '27');
};
const rally: Shade = (p, n) => {
  const sweep = p[2] * 0.55 + p[1] * 0.9 + 0.06 * Math.sin(p[2] * 5);
  let c = mixColour(rgb('#0d3b8c'), rgb('#f3c316'), smoothstep(0.5, 0.508, sweep));
  c = mixColour(c, rgb('#f6f4ee'), smoothstep(0.05, 0.044, Math.abs(sweep - 0.5)));
  c = mixColour(c, rgb('#e4572e'), smoothstep(0.03, 0.024, Math.abs(sweep - 0.36)));
  const dust = fractal(scale(p, 3.5), 4) + 0.45 - p[1] * 1.3;
  c = mixColour(c, rgb('#9b7d55'), 0.75 * smoothstep(0.42, 0.62, dust + 0.25 * fractal(scale(p, 22))));
  return numbered(c, p, n, '4');
};
const camouflage: Shade = (p) => {
  const q = scale(p, 2.4);
  let c = rgb('#6f6b45');
  c = mixColour(c, rgb('#3c4a2c'), smoothstep(0.5, 0.51, fractal(q, 11)));
  c = mixColour(c, rgb('#2a2a22'), smoothstep(0.57, 0.58, fractal(scale(q, 1.3), 23)));
  return mixColour(c, rgb('#a89b6c'), smoothstep(0.6, 0.61, fractal(scale(q, 1.1), 37)));
};

// ---- template ----

/** The car's cage as a template: corners, roof, bumpers, mirrors and wheels to find again on another car. */
const templateOf = (unwrapped: Mesh, skin: Mesh): Template => {
  const cage = symmetric(unwrapped);
  const { from, furthest } = finderOn(skin);
  const side = (p: Vec3): Vec3 => from([1, 0, 0], p);
  const landmarks = {
    ...inMiddle({
      bumper_front: from([0, 0, 1], [0, 0.37, 0]), // below the grille
      bumper_rear: from([0, 0, -1], [0, 0.5, 0]),
      bonnet_front: from([0, 1, 0], [0, 0, 1.95]),
      windscreen_bottom: from([0, 1, 0], [0, 0, 1.03]),
      windscreen_top: from([0, 1, 0], [0, 0, 0.18]),
      roof: from([0, 1, 0], [0, 0, -0.3]),
      rear_window_top: from([0, 1, 0], [0, 0, -0.88]),
      rear_window_bottom: from([0, 1, 0], [0, 0, -1.62]),
      boot_rear: from([0, 1, 0], [0, 0, -1.95]),
    }),
    ...bothSides({
      wheel_front_centre: [kWheel.x, kWheel.radius, kAxles[0]],
      wheel_rear_centre: [kWheel.x, kWheel.radius, kAxles[1]],
      corner_front: furthest([0.7, 0, 0.7], [0.8, 0.5, 2], 0.25),
      corner_rear: furthest([0.7, 0, -0.7], [0.8, 0.5, -2], 0.25),
      roof_corner_front: furthest([0.5, 0.6, 0.6], [0.55, 1.36, 0.1], 0.2),
      roof_corner_rear: furthest([0.5, 0.6, -0.6], [0.52, 1.34, -0.85], 0.2),
      sill_front: side([0, 0.33, 0.8]),
      sill_rear: side([0, 0.33, -0.82]),
      belt_front: side([0, 0.9, 0.9]),
      belt_rear: side([0, 0.92, -1.3]),
      mirror: furthest([1, 0, 0], [0.98, 0.99, 0.71], 0.2),
    }),
  };
  const holes = namedHoles(cage, {
    window_front: [0, 1.17, 0.6],
    window_rear: [0, 1.17, -1.3],
    grille: [0, 0.5, 2.2],
    underside: [0, 0.3, 0],
    ...bothSides({
      window_side_front: [0.75, 1.12, 0.1],
      window_side_rear: [0.75, 1.13, -0.7],
      light_front: [0.62, 0.67, 2.1],
      light_rear: [0.65, 0.72, -2.1],
    }),
  });
  // The arches are no loops of their own: each is the run of the underside's border that follows it.
  for (const [end, z] of [
    ['front', kAxles[0]],
    ['rear', kAxles[1]],
  ] as const)
    for (const [name, sign] of [
      ['left', 1],
      ['right', -1],
    ] as const)
      holes[`wheel_${end}_${name}`] = runOf(holes['underside']!, (v) => {
        const [x, y, z0] = point(cage, v);
        return x * sign > 0 && y > kSill && Math.abs(z0 - z) < 0.5;
      });
  return { name: 'car', kind: 'prop', cage, landmarks, holes, skin };
};

/** The longest run of a closed loop whose vertices satisfy a condition. */
const runOf = (loop: readonly number[], holds: (v: number) => boolean): number[] => {
  const start = loop.findIndex((v) => !holds(v));
  const turned = [...loop.slice(start), ...loop.slice(0, start)];
  const runs: number[][] = [[]];
  for (const v of turned) {
    if (holds(v)) runs.at(-1)!.push(v);
    else runs.push([]);
  }
  return runs.reduce((a, b) => (b.length > a.length ? b : a));
};

/** A small saloon car. */
export const car = (): Model => {
  const half = clip(surface(shell, bounds, 0.026), (p) => p[0]);
  const onBody = (p: Vec3): number => Math.min(p[1] - kSill, arch(0)(...p), ...openings.map((o) => o.field(...p)));
  const body = panel(half, (p) => Math.min(onBody(p), -bumperLine(p)), 3500);
  const inCabin = (p: Vec3): number => Math.min(p[1] - 0.45, p[2] + 1.75, 1.1 - p[2]);
  const lining = turned(panel(half, (p) => Math.min(onBody(p), inCabin(p)), 900, 0.02));
  const bumpers = panel(half, (p) => Math.min(onBody(p), bumperLine(p)), 900);
  const opening = (name: string, triangles: number, inset = 0.008): Mesh => {
    const { field } = openings.find((o) => o.name === name)!;
    return panel(half, (p) => -field(...p) + 0.004, triangles, inset);
  };
  const solid = (s: Sdf, min: Vec3, max: Vec3, edge: number, triangles: number): Mesh =>
    withFieldNormals(symmetricSurface(s, { bounds: { min, max }, edge, triangles }), s);
  const wheels = kAxles.flatMap((z, i) => {
    const centre: Vec3 = [kWheel.x, kWheel.radius, z];
    const rim = spokedRim(centre, rimProfile, 25, 5, 0.075, 0.178);
    const tyre = lathe(centre, tyreProfile, 25);
    const end = i === 0 ? 'front' : 'rear';
    return [
      { name: `${end}-left`, tyre, rim },
      { name: `${end}-right`, tyre: reflected(tyre), rim: reflected(rim) },
    ];
  });
  const settled = settleOn(mirrorHousing);
  const housing = simplify(surface(mirrorHousing, { min: [0.74, 0.88, 0.62], max: [1.12, 1.09, 0.8] }, 0.016), 180);
  const oneMirror = withFieldNormals(
    {
      ...housing,
      positions: Float32Array.from(
        Array.from({ length: vertexCount(housing) }, (_, v) => settled(point(housing, v))).flat(),
      ),
    },
    mirrorHousing,
  );

  const plain = (
    name: string,
    mesh: Mesh,
    colour: Rgba,
    roughness: number,
    ncz: boolean,
    more: Partial<Part> = {},
  ): Part => {
    return { name, mesh: boxAtlas(mesh), colour, roughness, ncz, ...more };
  };
  const glass = (name: string, triangles: number): Part =>
    plain(name, opening(name, triangles), rgb('#10161c', 0.55), 0.05, true, { doubleSided: true });
  const parts: Part[] = [
    { ...textured('body', boxAtlas(body), bodyShade, 1024, 0.35, false), metallic: 0.2 },
    plain('bumpers', bumpers, rgb('#2b2f33'), 0.7, false, { doubleSided: true }),
    plain('mirrors', join(oneMirror, reflected(oneMirror)), rgb('#2b2f33'), 0.5, false),
    textured('headlights', boxAtlas(opening('headlights', 120)), headlightShade, 128, 0.1, true),
    textured('taillights', boxAtlas(opening('taillights', 120)), taillightShade, 128, 0.15, true),
    plain('grille', opening('grille', 80), rgb('#101214'), 0.6, true),
    ...wheels.flatMap(({ name, tyre, rim }) => [
      plain(`${name}-tyre`, tyre, rgb('#17181a'), 0.9, true),
      plain(`${name}-rim`, rim, rgb('#c3c7cb'), 0.35, true, { metallic: 0.6 }),
    ]),
    plain('lining', lining, rgb('#2a2d30'), 0.95, true),
    plain('floor', solid(floorSolid, [-0.05, 0.15, -2.2], [0.95, 0.75, 2.2], 0.05, 700), rgb('#1c1e20'), 0.95, true),
    plain('seats', solid(seatsSolid, [-0.05, 0.25, -1.5], [0.75, 1.35, 0.5], 0.028, 900), rgb('#4a3a30'), 0.8, true),
    plain(
      'dashboard',
      solid(dashboardSolid, [-0.05, 0.3, 0.5], [0.75, 1.0, 1.1], 0.03, 160),
      rgb('#26282b'),
      0.8,
      true,
    ),
    plain('steering-wheel', steeringWheel(), rgb('#121315'), 0.6, true),
    // Glass comes last: what is behind it is then drawn first.
    glass('windscreen', 80),
    glass('rear-window', 80),
    glass('front-windows', 80),
    glass('rear-windows', 80),
  ];

  const wrap = join(...['body', 'bumpers', 'mirrors'].map((name) => parts.find((p) => p.name === name)!.mesh));
  const beneath = settleOn(shell);
  const cagedSolid: Sdf = mirrored(smoothUnion(0.1, shell, ellipsoid([0.96, 0.985, 0.71], [0.13, 0.07, 0.075])));
  const cage = makeCage({
    solid: cagedSolid,
    bounds: { min: [-0.15, -0.1, -2.4], max: [1.3, 1.7, 2.42] },
    edge: 0.055,
    distance: 0.07,
    triangles: 880,
    wrap,
    seen: () => true,
    // An opening's edge is above its edge in the shell, wherever the offset has carried it.
    keep: (p) => {
      const q = beneath(p);
      const light = (o: Opening): number => (o.name.endsWith('lights') ? 0.01 : 0);
      return Math.min(p[1] - (kSill - 0.05), arch(0.015)(...p), ...openings.map((o) => o.field(...q) - light(o)));
    },
  });
  const unwrapped = pelt(cage, () => false);
  return {
    name: 'car',
    title: 'Saloon car',
    parts,
    cage: unwrapped,
    template: templateOf(unwrapped, wrap),
    inside: () => false,
    paints: [
      { name: 'racing', title: 'Racing livery, number 27', shade: racing, far: rgb('#c4161c') },
      { name: 'rally', title: 'Rally livery, number 4', shade: rally, far: rgb('#0d3b8c') },
      { name: 'camouflage', title: 'Camouflage', shade: camouflage, far: rgb('#6f6b45') },
    ],
  };
};
