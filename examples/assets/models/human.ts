import { enlarged, makeCage } from '../cage.ts';
import { type Part, textured } from '../glb.ts';
import { lit, mixColour, over, type Rgba, rgb, type Shade } from '../image.ts';
import { bothSides, finderOn, inMiddle, type Landmarks } from '../landmarks.ts';
import { join, type Mesh, point, reflected, symmetricSurface, withFieldNormals } from '../mesh.ts';
import type { Model } from '../model.ts';
import { fractal, noise } from '../noise.ts';
import {
  ellipsoid,
  lens,
  local,
  mirrored,
  offset,
  roundCone,
  type Sdf,
  smoothIntersect,
  smoothSubtract,
  smoothUnion,
  sphere,
  tube,
  union,
} from '../sdf.ts';
import { alongLine, eyeball, spike } from '../shapes.ts';
import { namedHoles, symmetric, type Template } from '../template.ts';
import { boxAtlas, pelt } from '../unwrap.ts';
import { add, clamp, frame, length, scale, smoothstep, sub, unit, type Vec3 } from '../vec.ts';

// One unit is the height of the head: the chin is at y = -0.5, the crown at 0.5. The face looks to +z, the left is +x.
const kBottom = -0.93; // the bust ends at this y
export const kEye: Vec3 = [0.143, 0.0, 0.255];
export const kLook: Vec3 = unit([0.06, 0, 1]);
const kEyeRadius = 0.066;
export const kNoseTip: Vec3 = [0, -0.2, 0.42];
export const kMouth: Vec3 = [0, -0.305, 0.345];

// ---- the head without its openings ----

const cranium = smoothUnion(
  0.12,
  ellipsoid([0, 0.15, -0.07], [0.312, 0.35, 0.39]),
  ellipsoid([0, 0.17, 0.1], [0.255, 0.22, 0.235]),
);
const face = smoothUnion(
  0.13,
  ellipsoid([0, -0.1, 0.1], [0.235, 0.3, 0.225]),
  tube([
    [0.205, -0.1, -0.03, 0.08],
    [0.186, -0.275, -0.0, 0.075],
    [0.105, -0.395, 0.15, 0.07],
    [0, -0.435, 0.26, 0.065],
  ]),
  ellipsoid([0, -0.29, 0.21], [0.135, 0.13, 0.15]),
);
const cheekbone = ellipsoid([0.178, -0.08, 0.19], [0.085, 0.065, 0.09]);
const cheek = ellipsoid([0.125, -0.2, 0.2], [0.085, 0.11, 0.1]);
const chin = ellipsoid([0, -0.438, 0.278], [0.07, 0.058, 0.07]);
const brow = tube([
  [0.0, 0.07, 0.318, 0.028],
  [0.09, 0.088, 0.312, 0.034],
  [0.18, 0.09, 0.265, 0.031],
  [0.23, 0.045, 0.19, 0.025],
]);
const nose = local(
  [0, -0.08, 0.36],
  0.2,
  0.1,
  smoothUnion(
    0.035,
    tube([
      [0, 0.06, 0.318, 0.03],
      [0, -0.03, 0.352, 0.03],
      [0, -0.12, 0.398, 0.036],
      [0, -0.168, 0.415, 0.042],
    ]),
    ellipsoid([0.043, -0.186, 0.372], [0.034, 0.03, 0.042]),
    roundCone([0, -0.165, 0.41], [0, -0.212, 0.35], 0.03, 0.03),
  ),
);
const socket = ellipsoid([0.135, 0.012, 0.375], [0.085, 0.045, 0.075]);
const lidBall = ellipsoid(kEye, [kEyeRadius + 0.014, kEyeRadius + 0.011, kEyeRadius + 0.011]);

const upperLip = tube([
  [0, -0.291, 0.388, 0.0175],
  [0.024, -0.284, 0.385, 0.0205],
  [0.075, -0.292, 0.361, 0.0165],
  [0.13, -0.3, 0.303, 0.008],
]);
const lowerLip = tube([
  [0, -0.338, 0.382, 0.026],
  [0.05, -0.333, 0.37, 0.0235],
  [0.1, -0.316, 0.335, 0.014],
  [0.13, -0.302, 0.303, 0.008],
]);
const lips = local(kMouth, 0.16, 0.06, smoothUnion(0.012, upperLip, lowerLip));
const philtrum = roundCone([0, -0.225, 0.385], [0, -0.27, 0.39], 0.012);

export const kEar: Vec3 = [0.325, -0.045, -0.045];
const earAxes = frame(unit([1, 0.08, 0.42]), [0.05, 1, 0.12]); // backwards-in, up, outwards
export const earAt = (u: number, v: number, w: number): Vec3 =>
  add(kEar, add(add(scale(earAxes[0], u), scale(earAxes[1], v)), scale(earAxes[2], w)));
const rim = (points: readonly (readonly [number, number, number, number])[]): Sdf =>
  tube(points.map(([u, v, w, r]) => [...earAt(u, v, w), r] as [number, number, number, number]));
// u runs from the ear's back (+, earAxes[0] points away from the face) to its front.
export const back = earAxes[0][2] < 0 ? 1 : -1;
const earPlate = ellipsoid(earAt(back * 0.012, -0.005, -0.004), [0.066, 0.118, 0.022], earAxes);
const helix = rim([
  [back * -0.038, 0.0, 0.012, 0.012],
  [back * -0.047, 0.05, 0.016, 0.014],
  [back * -0.025, 0.1, 0.02, 0.0155],
  [back * 0.018, 0.121, 0.022, 0.016],
  [back * 0.06, 0.098, 0.024, 0.016],
  [back * 0.08, 0.04, 0.024, 0.0155],
  [back * 0.069, -0.03, 0.02, 0.014],
  [back * 0.036, -0.085, 0.014, 0.014],
]);
const antihelix = rim([
  [back * 0.012, 0.075, 0.016, 0.01],
  [back * 0.042, 0.035, 0.022, 0.0115],
  [back * 0.04, -0.025, 0.022, 0.011],
  [back * 0.014, -0.06, 0.02, 0.01],
]);
const lobe = ellipsoid(earAt(back * -0.002, -0.108, 0.008), [0.033, 0.036, 0.017], earAxes);
const tragus = ellipsoid(earAt(back * -0.046, -0.022, 0.014), [0.015, 0.024, 0.014], earAxes);
const concha = ellipsoid(earAt(back * -0.005, -0.012, 0.026), [0.033, 0.05, 0.03], earAxes);
const ear = local(
  kEar,
  0.17,
  0.06,
  smoothUnion(0.012, smoothSubtract(0.018, smoothUnion(0.022, earPlate, helix, antihelix, lobe), concha), tragus),
);

const neck = smoothUnion(
  0.12,
  roundCone([0, -0.3, -0.09], [0, -0.85, -0.16], 0.19, 0.205),
  roundCone([0, -0.98, -0.15], [0.5, -1.0, -0.19], 0.22, 0.14),
  ellipsoid([0, -1.05, -0.06], [0.42, 0.24, 0.22]),
  roundCone([0.1, -0.6, -0.2], [0.42, -0.9, -0.2], 0.11, 0.1),
);
const muscle = roundCone([0.175, -0.28, -0.1], [0.05, -0.83, 0.045], 0.05, 0.035);
const collarbone = tube([
  [0.05, -0.86, 0.05, 0.026],
  [0.2, -0.845, 0.04, 0.024],
  [0.34, -0.82, -0.04, 0.026],
  [0.5, -0.84, -0.13, 0.03],
]);
const throat = roundCone([0, -0.5, 0.09], [0, -0.64, 0.055], 0.03);

/** The head with eyes and mouth shut; `ears` is what it has for ears. */
const shut = (ears: Sdf): Sdf => {
  const skull = smoothUnion(0.1, cranium, face, cheekbone, cheek);
  const head = smoothUnion(0.045, skull, chin, brow);
  const bust = smoothUnion(0.06, smoothUnion(0.05, smoothUnion(0.08, head, neck), muscle, collarbone, throat), head);
  const sockets = smoothSubtract(0.05, bust, socket);
  const nosed = smoothUnion(0.035, sockets, nose);
  const lidded = smoothUnion(0.03, nosed, lidBall);
  const lipped = smoothUnion(0.016, smoothSubtract(0.03, lidded, philtrum), lips);
  return smoothUnion(0.02, lipped, ears);
};

// ---- openings ----

/** The space between the lids: two arcs that meet in the corners of the eye, drawn out to the front. */
const [eyeRight, eyeUp, eyeFront] = frame(kLook);
export const lidOpening = (grow: number): Sdf => {
  const arc = (height: number, half: number): { centre: number; radius: number } => {
    const centre = (half * half - height * height) / (2 * height);
    return { centre, radius: centre + height };
  };
  const upper = arc(0.0265 + grow, 0.0635 + grow);
  const lower = arc(0.0215 + grow, 0.0635 + grow);
  return (x, y, z) => {
    const p: Vec3 = [x - kEye[0], y - kEye[1], z - kEye[2]];
    // The outer corner sits a little higher than the inner one.
    const u = p[0] * eyeRight[0] + p[1] * eyeRight[1] + p[2] * eyeRight[2];
    const v = p[0] * eyeUp[0] + p[1] * eyeUp[1] + p[2] * eyeUp[2] - 0.07 * u;
    const w = p[0] * eyeFront[0] + p[1] * eyeFront[1] + p[2] * eyeFront[2];
    return Math.max(
      Math.hypot(u, v + upper.centre) - upper.radius,
      Math.hypot(u, v - lower.centre) - lower.radius,
      0.01 - w,
    );
  };
};
const kGap = (grow: number): Sdf => ellipsoid([0, -0.313, 0.35], [0.1 + grow, 0.0125 + grow, 0.12 + grow]);
/** The gap between the lips, its corners a little raised. */
export const lipGap =
  (grow: number): Sdf =>
  (x, y, z) =>
    kGap(grow)(x, y - 0.55 * x * x, z);

const kArch = { width: 0.098, depth: 0.13, centre: 0.195 }; // the dental arch, as a half ellipse
const archPoint = (a: number, y: number, inset: number): Vec3 => [
  (kArch.width - inset) * Math.sin(a),
  y,
  kArch.centre + (kArch.depth - inset) * Math.cos(a),
];
const archTube = (y: number, r: number): Sdf =>
  tube(
    Array.from({ length: 9 }, (_, i) => [...archPoint((i / 8) * 1.6, y, 0.008), r] as [number, number, number, number]),
  );
const gums = local([0, -0.315, 0.25], 0.18, 0.06, union(archTube(-0.256, 0.022), archTube(-0.378, 0.02)));
const cavity = smoothUnion(
  0.04,
  ellipsoid([0, -0.313, 0.225], [0.112, 0.062, 0.112]),
  ellipsoid([0, -0.33, 0.12], [0.085, 0.06, 0.12]),
);
const nostril = smoothUnion(0.01, roundCone([0.026, -0.225, 0.392], [0.02, -0.165, 0.365], 0.0145, 0.012));

const kFold = 0.012; // rounds the middle of the face, where the two halves meet
export const closedSolid: Sdf = mirrored(shut(ear), kFold);
const opened = (fused: boolean): Sdf => {
  const hollow = smoothUnion(
    0.012,
    smoothSubtract(0.006, shut(ear), cavity),
    smoothIntersect(0.01, gums, offset(shut(ear), -0.03)),
  );
  const carved = smoothSubtract(0.012, hollow, lipGap(0), nostril);
  if (fused) return union(smoothSubtract(0.008, carved, lidOpening(0)), sphere(kEye, kEyeRadius));
  return smoothSubtract(0.008, smoothSubtract(0.004, carved, sphere(kEye, kEyeRadius + 0.003)), lidOpening(0));
};
const skinSolid: Sdf = mirrored(opened(false), kFold);
const fusedSolid: Sdf = mirrored(opened(true), kFold);

/** For the cage: ears as mere swellings, lips closed, lids shut. */
export const cagedSolid: Sdf = mirrored(
  smoothUnion(
    0.05,
    shut(ellipsoid(earAt(back * 0.015, 0, 0.0), [0.085, 0.14, 0.045], earAxes)),
    lens(kMouth, [0.1, 0.05, 0.045], [0, 0, 1]),
  ),
  kFold,
);

// ---- parts ----

/** Half a row of teeth and its mirror image: seven to a side, from the incisors back. */
const teeth = (y: number, up: 1 | -1, inset: number, incisor: number): Mesh => {
  const line = Array.from({ length: 40 }, (_, i) => archPoint((i / 39) * 1.5, y, inset));
  const half = alongLine(line, 7).map(({ at, ahead }, i) => {
    const tall = [1, 0.9, 1.05, 0.85, 0.8, 0.75, 0.7][i]!;
    const deep = [0.35, 0.35, 0.5, 0.75, 0.8, 0.95, 0.95][i]!;
    const w = 0.0158 * (i === 0 ? incisor : 1);
    const ring = (h: number, s: number, d: number): { centre: Vec3; width: number; depth: number } => ({
      centre: [at[0], at[1] + up * h * tall, at[2]],
      width: w * s,
      depth: 0.0165 * d * deep,
    });
    return spike(
      [ring(0, 0.8, 1), ring(0.02, 1, 1), ring(0.042, 0.98, 0.8), ring(0.049, 0.75, 0.45)],
      [at[0], at[1] + up * 0.0505 * tall, at[2]],
      unit(ahead),
      8,
    );
  });
  return join(...half, ...half.map(reflected));
};

const tongueSolid: Sdf = mirrored(
  smoothSubtract(
    0.02,
    smoothUnion(0.05, ellipsoid([0, -0.352, 0.2], [0.068, 0.026, 0.1]), ellipsoid([0, -0.36, 0.1], [0.06, 0.04, 0.08])),
    roundCone([0, -0.318, 0.1], [0, -0.322, 0.3], 0.006),
  ),
);

/** Looks closely at the face, less so at the skull, least at the shoulders. */
const faceLens = (p: Vec3): Vec3 => [bend(p[0], -1, 0.22), bend(p[1], -0.42, 0.13), bend(p[2], 0.12, 1)];
/** A map with slope 1 within [from, to] and 2 outside. */
export const bend = (x: number, from: number, to: number): number => x + Math.min(x - from, 0) + Math.max(x - to, 0);

/** Enlarges eyes, mouth and ears, so that they keep more of their triangles. */
export const faceFocus = (p: Vec3): Vec3 =>
  enlarged(p, [
    [kEye, 0.11, 1.3],
    [kMouth, 0.13, 0.9],
    [kEar, 0.15, 0.8],
  ]);

// ---- looks ----

const near = (p: Vec3, c: Vec3, r: number, soft = 0.4): number => smoothstep(r, r * soft, length(sub(p, c)));
const folded = (p: Vec3): Vec3 => [Math.abs(p[0]), p[1], p[2]];

/** Piecewise linear: the value at `x` of the graph through `points`, which ascend. */
const graph = (points: readonly (readonly [number, number])[], x: number): number => {
  const i = clamp(
    points.findIndex((p) => p[0] > x),
    1,
    points.length - 1,
  );
  const [a, b] = [
    points[x > points.at(-1)![0] ? points.length - 2 : i - 1]!,
    points[x > points.at(-1)![0] ? points.length - 1 : i]!,
  ];
  return a[1] + clamp((x - a[0]) / (b[0] - a[0])) * (b[1] - a[1]);
};

/** Positive where hair grows: behind a line down the forehead and temples, above one from the ear to the nape. */
const hairline = (q: Vec3): number => {
  const front =
    graph(
      [
        [-0.1, 0.06],
        [0.0, 0.09],
        [0.06, 0.115],
        [0.11, 0.09],
        [0.2, 0.125],
        [0.245, 0.2],
        [0.285, 0.28],
        [0.42, 0.3],
      ],
      q[1],
    ) - q[2];
  const under =
    q[1] -
    graph(
      [
        [-0.4, -0.16],
        [-0.3, -0.17],
        [-0.15, -0.1],
        [-0.04, 0.06],
        [0.03, -0.07],
        [0.1, -0.07],
      ],
      q[2],
    );
  return Math.min(front, under);
};

const browStrength = (q: Vec3): number => {
  const t = clamp((q[0] - 0.055) / 0.165);
  const line = 0.07 + 0.034 * Math.sin(Math.PI * (0.08 + 0.72 * t));
  const thick = 0.016 * (1 - 0.7 * t * t) * smoothstep(-0.02, 0.1, (q[0] - 0.045) / 0.165);
  return (
    smoothstep(thick + 0.006, thick - 0.006, Math.abs(q[1] - line)) *
    smoothstep(0.045, 0.065, q[0]) *
    smoothstep(0.235, 0.2, q[0]) *
    smoothstep(0.1, 0.16, q[2])
  );
};

const lipStrength = (q: Vec3): number => smoothstep(0.006, -0.002, lips(...q)) * smoothstep(0.24, 0.27, q[2]);
/** How far in front of the lids' edge: 0 on it, 1 a lash's width away. */
const lidEdge = (q: Vec3): number => (q[2] > kEye[2] ? lidOpening(0)(...q) : 1);

const kSkin = rgb('#d9a27e');
const skinShade =
  (withEyes: boolean): Shade =>
  (p, n) => {
    const q = folded(p);
    if (withEyes && isEye(p)) return eyeShade(p, n);
    const depth = -closedSolid(...p);
    const mottle = fractal(scale(p, 14));
    let c = mixColour(kSkin, rgb('#c58763'), 0.5 * mottle);
    const red = rgb('#c8674f');
    c = mixColour(
      c,
      red,
      0.4 * near(q, [0.17, -0.13, 0.27], 0.14) +
        0.35 * near(q, [0, -0.18, 0.45], 0.09) +
        0.4 * near(q, kEar, 0.16, 0.6),
    );
    c = mixColour(c, rgb('#a9705a'), 0.35 * near(q, [0.135, 0.0, 0.32], 0.1, 0.5));
    c = mixColour(
      c,
      rgb('#b58a72'),
      0.25 * smoothstep(-0.38, -0.45, p[1]) * smoothstep(-0.55, -0.45, p[1]) * smoothstep(0, 0.15, p[2]),
    );
    c = mixColour(
      c,
      mixColour(rgb('#b5564f'), rgb('#9c4442'), noise([p[0] * 160, p[1] * 30, p[2] * 30])),
      0.85 * lipStrength(q),
    );
    c = mixColour(c, rgb('#8a3b35'), smoothstep(0.012, 0.002, Math.abs(p[1] + 0.309)) * lipStrength(q) * 0.4);
    // Hair, cropped: strands in the texture, denser away from the hairline.
    const strands =
      noise([p[0] * 170, p[1] * 60, p[2] * 110]) * 0.6 + noise([p[0] * 90, p[1] * 90, p[2] * 90], 5) * 0.4;
    const hair = smoothstep(-0.012, 0.05, hairline(q) + 0.03 * (strands - 0.5)) * smoothstep(0.004, 0.016, ear(...q));
    c = mixColour(c, mixColour(rgb('#2c1d15'), rgb('#57402f'), strands), 0.92 * hair);
    const browHair = browStrength(q);
    c = mixColour(
      c,
      mixColour(rgb('#2f2018'), rgb('#5a4030'), strands),
      0.85 * browHair * smoothstep(0.15, 0.5, strands + 0.35),
    );
    // Lashes.
    const edge = lidEdge(q);
    const upperSide = smoothstep(-0.01, 0.012, q[1] - kEye[1]);
    c = mixColour(
      c,
      rgb('#2a1813'),
      smoothstep(0.004 + 0.008 * upperSide, 0.002, edge) * (0.3 + 0.65 * upperSide) * (depth < 0.03 ? 1 : 0),
    );
    c = lit(
      c,
      1 -
        0.22 *
          upperSide *
          smoothstep(0.075, 0.05, Math.abs(q[0] - kEye[0])) *
          smoothstep(0.009, 0.002, Math.abs(edge - 0.024 - 0.1 * Math.max(q[0] - kEye[0], 0))) *
          (depth < 0.03 ? 1 : 0),
    );
    // The lining of the mouth, the nostrils and the ear's pit.
    const lining =
      smoothstep(0.012, 0.03, depth) *
      (length(sub(q, kEye)) < 0.075 ? 0 : 1) *
      smoothstep(0.1, 0.14, length(sub(q, kEar)));
    c = mixColour(c, mixColour(rgb('#b04a50'), rgb('#4a1218'), smoothstep(0.26, 0.12, p[2])), lining);
    const pit = near(q, [0.026, -0.21, 0.385], 0.03, 0.55);
    c = mixColour(c, rgb('#3a1510'), 0.8 * pit * smoothstep(0.2, -0.6, n[1]));
    const earPit = near(q, earAt(back * -0.02, -0.015, 0.0), 0.04, 0.4);
    c = lit(c, 1 - 0.45 * earPit);
    return lit(c, 0.97 + 0.06 * noise(scale(p, 220)));
  };

/** Whether a point lies on the ball of an eye, where the lids leave it free. */
const isEye = (p: Vec3): boolean =>
  Math.abs(length(sub(folded(p), kEye)) - kEyeRadius) < 0.0035 && lidOpening(0.004)(...folded(p)) < 0;

const eyeShade: Shade = (p) => {
  const d = unit(sub(folded(p), kEye));
  const along = (a: Vec3): number => d[0] * a[0] + d[1] * a[1] + d[2] * a[2];
  const angle = Math.acos(clamp(along(eyeFront), -1, 1));
  const turn = Math.atan2(along(eyeUp), along(eyeRight));
  const rays = noise([Math.cos(turn) * 14, Math.sin(turn) * 14, angle * 6]);
  const veins = fractal(add(scale(d, 7), [3, 1, 2]));
  let c = mixColour(rgb('#efe9e2'), rgb('#d99a8c'), smoothstep(0.7, 1.5, angle) * (0.3 + 0.6 * veins));
  const iris = mixColour(
    mixColour(rgb('#8fb7c4'), rgb('#3f7688'), smoothstep(0.22, 0.45, angle)),
    rgb('#2a4a58'),
    0.55 * rays,
  );
  c = mixColour(c, mixColour(iris, rgb('#16262c'), smoothstep(0.4, 0.48, angle)), smoothstep(0.5, 0.46, angle));
  return mixColour(c, rgb('#070505'), smoothstep(0.22, 0.19, angle));
};
const toothShade: Shade = (p) =>
  mixColour(rgb('#f4efe4'), rgb('#d9cdb0'), 0.4 * fractal(scale(p, 50)) + 0.4 * smoothstep(0.3, 0.2, p[2]));
const tongueShade: Shade = (p) => mixColour(rgb('#c9656b'), rgb('#9a3c48'), fractal(scale(p, 45)));

// ---- paints ----

/** Lipstick, eye shadow, liner, blush. */
const makeup: Shade = (p) => {
  const q = folded(p);
  const grain = 0.9 + 0.2 * noise(scale(p, 150));
  let c: Rgba = rgb('#d9a27e', 0);
  c = over(c, rgb('#e2566a'), 0.5 * near(q, [0.19, -0.13, 0.27], 0.13, 0.1) * grain);
  const eye = sub(q, kEye);
  const above = Math.hypot(eye[0] * 0.78 - 0.01, (eye[1] - 0.022) * 1.35);
  const front = smoothstep(0.15, 0.22, q[2]);
  c = over(
    c,
    mixColour(rgb('#7a2fb0'), rgb('#1f9fc4'), smoothstep(-0.05, 0.08, eye[0])),
    smoothstep(0.085, 0.045, above) * smoothstep(-0.03, 0.005, eye[1]) * front * 0.9,
  );
  const wing = Math.abs(eye[1] - 0.03 - 0.35 * Math.max(eye[0] - 0.03, 0) + 4 * eye[0] * eye[0]);
  c = over(
    c,
    rgb('#120c10'),
    smoothstep(0.014, 0.009, wing) * smoothstep(-0.065, -0.045, eye[0]) * smoothstep(0.115, 0.085, eye[0]) * front,
  );
  c = over(
    c,
    rgb('#f6e2c8'),
    0.45 * smoothstep(0.03, 0.01, Math.hypot(q[0] * 0.9, (q[1] + 0.05) * 0.16)) * smoothstep(0.3, 0.34, q[2]),
  );
  const bow = 0.012 * smoothstep(0.03, 0, q[0]); // the dip of the upper lip
  const lip = Math.hypot(q[0] / 0.152, (p[1] + 0.313 + (p[1] > -0.31 ? bow : 0)) / (p[1] > -0.31 ? 0.054 : 0.066));
  const onLips = smoothstep(1.04, 0.96, lip) * smoothstep(0.22, 0.26, q[2]);
  return over(c, rgb('#b3122f'), onLips * (0.94 + 0.06 * grain));
};

/** A painted skull: white face, black sockets, nose and stitched mouth, with petals around the eyes. */
const skull: Shade = (p) => {
  const q = folded(p);
  const rough = 0.012 * (fractal(scale(p, 40)) - 0.5);
  let c: Rgba = rgb('#f1ece2', 0);
  const oval = Math.hypot(q[0] / 0.27, (p[1] + 0.06) / 0.44);
  const front = smoothstep(0.0, 0.07, p[2] - 0.02);
  c = over(
    c,
    mixColour(rgb('#f4efe6'), rgb('#d8d0c2'), fractal(scale(p, 20))),
    smoothstep(1.02, 0.97, oval + rough) * front,
  );
  const eye = sub(q, [kEye[0], kEye[1] + 0.005, kEye[2]]);
  const r = Math.hypot(eye[0], eye[1] * 1.05);
  const turn = Math.atan2(eye[1], eye[0]);
  const petals = 0.108 + 0.016 * Math.abs(Math.cos(turn * 6));
  c = over(c, rgb('#c3193b'), smoothstep(petals + 0.004, petals - 0.004, r) * front);
  c = over(c, rgb('#12090c'), smoothstep(0.094, 0.088, r + rough) * front);
  // Nose: an upside-down heart.
  const lobe = Math.hypot(q[0] - 0.025, (p[1] + 0.185) * 0.8);
  const spire = q[0] + 0.55 * (p[1] + 0.185) - 0.045;
  const heart = Math.min(lobe - 0.034, Math.max(spire, -0.2 - p[1]));
  c = over(
    c,
    rgb('#12090c'),
    smoothstep(0.004, -0.004, heart + rough * 0.5) * smoothstep(-0.06, -0.08, p[1]) * smoothstep(0.25, 0.3, p[2]),
  );
  // Mouth: a grin with stitches.
  const smile = p[1] + 0.312 - 0.9 * Math.max(q[0] - 0.08, 0) * q[0];
  const grin = smoothstep(0.0065, 0.003, Math.abs(smile)) * smoothstep(0.2, 0.19, q[0]);
  c = over(c, rgb('#12090c'), grin * front);
  const beat = Math.abs(((q[0] + 0.0125) % 0.026) - 0.013);
  c = over(
    c,
    rgb('#12090c'),
    smoothstep(0.0042, 0.002, beat) *
      smoothstep(0.045 - 0.12 * q[0], 0.04 - 0.12 * q[0], Math.abs(smile)) *
      smoothstep(0.198, 0.19, q[0]) *
      front,
  );
  // Forehead: a flower; chin and brows: dots.
  const f = Math.hypot(p[0], p[1] - 0.23);
  const leaf = 0.062 + 0.02 * Math.cos(5 * Math.atan2(p[0], p[1] - 0.23));
  c = over(c, rgb('#1c6f8c'), smoothstep(leaf + 0.004, leaf - 0.004, f) * front);
  c = over(c, rgb('#f2b824'), smoothstep(0.03, 0.026, f) * front);
  for (let k = 0; k < 4; k++) {
    const d = Math.hypot(q[0] - 0.045 - 0.045 * k, p[1] - 0.155 + 0.012 * k * k);
    c = over(c, rgb('#1c6f8c'), smoothstep(0.014, 0.011, d) * front);
  }
  for (let k = 0; k < 3; k++) {
    const d = Math.hypot(q[0] - 0.04 * k, p[1] + 0.43 - 0.012 * k);
    c = over(c, rgb('#c3193b'), smoothstep(0.014, 0.011, d) * smoothstep(0.1, 0.16, p[2]));
  }
  return c;
};

/** Two tones of a carnival mask over the whole head, with gold diamonds: opaque, so that what it misses is seen. */
const harlequin: Shade = (p) => {
  const turn = Math.atan2(p[0], p[2] + 0.05);
  const u = turn * 2.6;
  const v = p[1] * 5.2;
  const check = Math.floor(u + v + 100) + Math.floor(u - v + 100);
  let c = check % 2 === 0 ? rgb('#1d2f6f') : rgb('#e9dfc8');
  if (((Math.floor(u + v + 100) % 4) + 4) % 4 === 1 && check % 2 === 0) c = rgb('#a3172e');
  const [a, b] = [Math.abs(((u + v + 100) % 1) - 0.5), Math.abs(((u - v + 100) % 1) - 0.5)];
  c = mixColour(c, rgb('#d8a937'), smoothstep(0.46, 0.475, Math.max(a, b)));
  return lit(c, 0.94 + 0.1 * fractal(scale(p, 60)));
};

// ---- models ----

const bounds = { min: [-0.03, -0.76, -0.22] as Vec3, max: [0.5, 0.34, 0.5] as Vec3 }; // in the lens's space
const keepBust = (p: Vec3): number => p[1] - kBottom;

const kEdge = 0.0088; // of the fine meshes, in the lens's space
const meshOf = (solid: Sdf, triangles: number, edge = kEdge): Mesh =>
  symmetricSurface(solid, { bounds, edge, triangles, lens: faceLens, focus: faceFocus, keep: keepBust });

/** A cage that ends where `keep` is negative, its hole over the mouth larger than the gap between the lips by `grow`. */
const cageOf = (skin: Mesh, triangles: number, grow: number, keep: (p: Vec3) => number): Mesh =>
  makeCage({
    solid: cagedSolid,
    bounds: { min: [-0.08, kBottom - 0.2, -0.62], max: [0.82, 0.62, 0.58] },
    edge: 0.034,
    distance: 0.04,
    triangles,
    focus: (p) => add(faceFocus(p), scale(sub(p, kNoseTip), 0.7 * Math.exp(-((length(sub(p, kNoseTip)) / 0.15) ** 2)))),
    wrap: skin,
    seen: (v) => Math.abs(closedSolid(...point(skin, v))) < 0.006,
    keep: (p) => Math.min(keep(p), lidOpening(0.006)(...p), lipGap(grow)(p[0], p[1], Math.min(p[2], 0.37)) * 0.5),
  });
/** Draws the face larger than the rest, in its middle by 1 + `by`. */
const faceZoom =
  (by: number) =>
  (p: Vec3): number =>
    1 + by * Math.exp(-((length(sub(p, [0, -0.13, 0.38])) / 0.33) ** 2));

const cageFor = (skin: Mesh): Mesh =>
  pelt(
    cageOf(skin, 800, 0.014, (p) => p[1] - (kBottom - 0.035)),
    (a, b) => a[0] === 0 && b[0] === 0 && (a[2] + b[2]) / 2 < 0 && (a[1] + b[1]) / 2 < 0.4,
    faceZoom(1.3),
  );

export const kMouthRim = 0.005; // of a template's hole, beyond the gap: its border must not reach the middle of a lip
/** The cage of the head alone, cut through the neck: a template is fitted to heads, few of which have shoulders. */
const headCage = (skin: Mesh): Mesh =>
  pelt(
    cageOf(skin, 700, kMouthRim, (p) => p[1] + 0.67 + 0.36 * p[2]),
    (a, b) => isHeadSeam(a) && isHeadSeam(b),
    faceZoom(0.7),
    true,
  );

/** Whether a point is on the seam of a head's template, from the neck over the back of the head to before the crown. */
export const isHeadSeam = (p: Vec3): boolean => p[0] === 0 && p[2] < (p[1] > -0.1 ? 0.09 : -0.1);

/** Spots of the face and skull, for the template of a head and of a whole figure; lengths in heads. */
export const headLandmarks = (skin: Mesh): Landmarks => {
  const { near, from, furthest } = finderOn(skin);
  const front = (y: number): Vec3 => from([0, 0, 1], [0, y, 0]);
  const corner = (side: 1 | -1): Vec3 => near(add(kEye, add(scale(eyeRight, side * 0.0635), scale(eyeFront, 0.03))));
  return {
    ...inMiddle({
      nose_tip: furthest([0, 0, 1], kNoseTip, 0.08),
      nasion: front(0.015),
      glabella: front(0.1),
      forehead: front(0.26),
      crown: from([0, 1, 0], [0, 0, 0.0]),
      occiput: from([0, 0, -1], [0, 0.08, 0]),
      nape: from([0, 0, -1], [0, -0.34, 0]),
      lip_upper: front(-0.288),
      lip_lower: front(-0.336),
      chin: front(-0.42),
      menton: from([0, -1, 0.6], [0, -0.47, 0.25]),
    }),
    ...bothSides({
      eye_centre: kEye,
      eye_inner: corner(eyeRight[0] > 0 ? -1 : 1),
      eye_outer: corner(eyeRight[0] > 0 ? 1 : -1),
      ear_top: furthest([0, 1, 0], kEar, 0.16),
      ear_lobe: near(earAt(0, -0.145, 0.008)),
      ear_outer: furthest([1, 0, 0], kEar, 0.16),
      mouth_corner: near([0.112, -0.306, 0.34]),
    }),
  };
};

/** The head as a template. */
const templateOf = (skin: Mesh): Template => {
  const cage = symmetric(headCage(skin));
  const holes = namedHoles(cage, {
    ...bothSides({ eye: add(kEye, scale(kLook, kEyeRadius)) }),
    mouth: kMouth,
    neck: [0, -0.6, -0.12],
  });
  return { name: 'human-head', kind: 'head', cage, landmarks: headLandmarks(skin), holes, skin };
};

export const others = (): Part[] => [
  textured('upper-teeth', boxAtlas(teeth(-0.27, -1, 0.004, 1.12)), toothShade, 64, 0.3, true),
  textured('lower-teeth', boxAtlas(teeth(-0.366, 1, 0.016, 0.9)), toothShade, 64, 0.3, true),
  textured(
    'tongue',
    boxAtlas(
      withFieldNormals(
        symmetricSurface(tongueSolid, {
          bounds: { min: [-0.02, -0.42, 0], max: [0.1, -0.28, 0.33] },
          edge: 0.01,
          triangles: 300,
        }),
        tongueSolid,
      ),
    ),
    tongueShade,
    128,
    0.4,
    true,
  ),
];
const paints = [
  { name: 'skull', title: 'Painted skull', shade: skull, far: rgb('#f1ece2', 0) },
  { name: 'makeup', title: 'Make-up', shade: makeup, far: rgb('#d9a27e', 0) },
  { name: 'harlequin', title: 'Harlequin', shade: harlequin, far: rgb('#1d2f6f') },
];
const inside = (p: Vec3): boolean => closedSolid(...p) < -0.012;

let made: Model | undefined;

/** A human head and shoulders, lips a little apart. */
export const human = (): Model => (made ??= makeHuman());

/** The skin of the head and shoulders, its mouth and eyes open; `edge` as of the mesh it is made from. */
export const headSkin = (triangles: number, edge = kEdge): Mesh => meshOf(skinSolid, triangles, edge);
/** The left eye. */
export const leftEye = (): Mesh => eyeball(kEye, kEyeRadius, kLook, 10, 18, 0.03);

const makeHuman = (): Model => {
  const skin = headSkin(9000);
  const eye = leftEye();
  return {
    name: 'human',
    title: 'Human bust',
    parts: [
      {
        ...textured('skin', boxAtlas(withFieldNormals(skin, skinSolid)), skinShade(false), 1024, 0.6, false),
        doubleSided: true,
      },
      textured('l-eye', eye, eyeShade, 512, 0.1, true),
      textured('r-eye', reflected(eye), eyeShade, 512, 0.1, true),
      ...others(),
    ],
    cage: cageFor(skin),
    template: templateOf(skin),
    inside,
    paints,
  };
};

/** The same bust as one careless export would have it: the eyes are of one piece with the skin, so no segment is theirs. */
export const humanFused = (): Model => {
  const whole = human();
  const skin = boxAtlas(withFieldNormals(meshOf(fusedSolid, 9400), fusedSolid));
  return {
    ...whole,
    name: 'human-fused',
    template: undefined,
    title: 'Human bust, eyes fused with the skin',
    parts: [
      { ...textured('skin', skin, skinShade(true), 1024, 0.6, isEye), doubleSided: true },
      ...whole.parts.filter((p) => p.name !== 'skin' && !p.name.endsWith('-eye')),
    ],
    inside: (p) => !isEye(p) && inside(p),
    paints: { of: 'human' },
  };
};

/** The bust with its cage knocked askew: turned by 14 degrees and moved by a tenth of a head. */
export const humanMisaligned = (): Model => {
  const whole = human();
  const [c, s] = [Math.cos(0.24), Math.sin(0.24)];
  const positions = whole.cage.positions.slice();
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = [positions[i]!, positions[i + 1]!, positions[i + 2]!];
    positions.set([c * x + s * z + 0.07, y - 0.06, c * z - s * x + 0.04], i);
  }
  return {
    ...whole,
    name: 'human-misaligned',
    template: undefined,
    title: 'Human bust, cage out of place',
    misfit: true,
    cage: { ...whole.cage, positions },
    paints: { of: 'human' },
  };
};
