import { makeCage } from '../cage.ts';
import { type Part, textured } from '../glb.ts';
import { lit, mixColour, over, type Rgba, rgb, type Shade } from '../image.ts';
import { join, type Mesh, point, reflected, symmetricSurface, triangleCount, withFieldNormals } from '../mesh.ts';
import type { Model } from '../model.ts';
import { cells, fractal } from '../noise.ts';
import {
  ellipsoid,
  halfSpace,
  lens,
  mirrored,
  offset,
  roundCone,
  type Sdf,
  smoothIntersect,
  smoothSubtract,
  smoothUnion,
  sphere,
  tube,
  turnedX,
  union,
} from '../sdf.ts';
import { alongLine, eyeball, spike } from '../shapes.ts';
import { boxAtlas, pelt } from '../unwrap.ts';
import { add, clamp, frame, length, scale, smoothstep, sub, unit, type Vec3 } from '../vec.ts';

const kTriangles = 4782; // of the whole target: the size of the lizard's head that the method was measured with
const kNeck = -0.6; // the head ends at this z

// Where things are. The snout points to +z, +y is up, the lizard's left is +x.
const kEye: Vec3 = [0.178, 0.135, 0.1];
const kLook: Vec3 = unit([0.88, 0.16, 0.36]);
const kEyeRadius = 0.07;
const kHinge: Vec3 = [0, -0.06, -0.2];
const kGape = 0.36; // how far the jaw is open, in radians
const kNostril: Vec3 = [0.055, 0.09, 0.478];

/** The edge of the upper lip, by z; the lower lip follows it in the closed jaw. */
const lip = (z: number): number => -0.045 + 0.018 * Math.sin(7 * z + 0.4);

const swing = (p: Vec3): Vec3 => {
  const [y, z] = [p[1] - kHinge[1], p[2] - kHinge[2]];
  return [
    p[0],
    y * Math.cos(kGape) - z * Math.sin(kGape) + kHinge[1],
    y * Math.sin(kGape) + z * Math.cos(kGape) + kHinge[2],
  ];
};
const inJaw = (s: Sdf): Sdf => turnedX(s, kHinge, kGape);

// The snout as one solid above, the chin as one below; both are cut along the lips.
const snout = smoothUnion(
  0.1,
  ellipsoid([0, 0.03, 0.0], [0.225, 0.13, 0.26]),
  roundCone([0, 0.03, 0.1], [0, 0.012, 0.475], 0.175, 0.083),
  roundCone([0, 0.085, 0.1], [0, 0.058, 0.43], 0.115, 0.07),
);
const chin = smoothUnion(
  0.08,
  ellipsoid([0, -0.07, 0.02], [0.215, 0.085, 0.25]),
  roundCone([0, -0.055, 0.1], [0, -0.05, 0.445], 0.15, 0.088),
);
const belowLip: Sdf = (_x, y, z) => (y - lip(z)) * 0.95;
const aboveLip: Sdf = (_x, y, z) => (lip(z) - 0.006 - y) * 0.95;

// Mouth: what is deeper than the gums is hollow.
const palate = smoothIntersect(0.04, offset(snout, -0.052), (_x, y, z) => y - lip(z) - 0.05);
const floor = smoothIntersect(0.04, offset(chin, -0.05), (_x, y, z) => lip(z) - 0.055 - y);
const pharynx = smoothUnion(
  0.05,
  ellipsoid([0, -0.06, -0.12], [0.1, 0.05, 0.2]),
  ellipsoid([0, -0.09, -0.0], [0.11, 0.05, 0.14]),
);

const upperJaw = smoothIntersect(0.02, snout, (x, y, z) => -belowLip(x, y, z));
const lowerJaw = inJaw(smoothIntersect(0.02, chin, (x, y, z) => -aboveLip(x, y, z)));

const skull = smoothUnion(
  0.07,
  ellipsoid([0, 0.1, -0.2], [0.235, 0.165, 0.27]),
  ellipsoid([0.1, 0.13, 0.1], [0.1, 0.085, 0.17]),
);
const brow = tube([
  [0.085, 0.185, 0.29, 0.018],
  [0.145, 0.222, 0.18, 0.03],
  [0.19, 0.235, 0.07, 0.035],
  [0.205, 0.22, -0.05, 0.034],
  [0.195, 0.18, -0.16, 0.022],
]);
const cheek = smoothUnion(
  0.08,
  ellipsoid([0.165, -0.06, -0.22], [0.1, 0.15, 0.17]),
  ellipsoid([0.19, -0.075, -0.1], [0.045, 0.095, 0.085]),
);
const neck = smoothUnion(
  0.12,
  roundCone([0, 0.0, -0.3], [0, -0.06, -0.8], 0.21, 0.25),
  ellipsoid([0, -0.2, -0.22], [0.13, 0.12, 0.22]),
);
const lids = lens(add(kEye, scale(kLook, -0.012)), [0.099, 0.091, 0.09], kLook);
const outerSolid = (mouthShut: boolean): Sdf => {
  const jaws = mouthShut
    ? smoothUnion(0.03, snout, inJaw(chin), turnedX(smoothUnion(0.08, chin, snout), kHinge, kGape / 2))
    : union(upperJaw, lowerJaw);
  const head = smoothUnion(0.06, smoothUnion(0.09, skull, neck), jaws, cheek);
  return smoothUnion(0.03, smoothUnion(0.05, head, brow), lids);
};

const crest: Sdf[] = Array.from({ length: 7 }, (_, i) => {
  const t = i / 6;
  const z = -0.14 - 0.4 * t;
  const y = 0.262 - 0.085 * t * t;
  const h = 0.075 * (0.75 + 0.5 * Math.sin(Math.PI * (0.15 + 0.75 * t)));
  return roundCone([0, y - 0.03, z], [0, y + h * 0.7, z - h * 0.75], 0.028, 0.006);
});
const cheekSpikes: { from: Vec3; to: Vec3; r: number }[] = [
  { from: [0.235, 0.09, -0.29], to: [0.315, 0.125, -0.38], r: 0.026 },
  { from: [0.245, 0.0, -0.32], to: [0.345, 0.005, -0.415], r: 0.03 },
  { from: [0.235, -0.09, -0.32], to: [0.33, -0.12, -0.41], r: 0.028 },
  { from: [0.2, -0.165, -0.28], to: [0.275, -0.22, -0.36], r: 0.024 },
];
const kEar: Vec3 = [0.243, 0.035, -0.2];
const ear = lens(kEar, [0.034, 0.045, 0.016], [1, 0.05, -0.2]);

const withHorns = (s: Sdf, k: number, grow = 0): Sdf =>
  smoothUnion(
    k,
    s,
    ...crest.map((c) => offset(c, grow)),
    ...cheekSpikes.map(({ from, to, r }) => roundCone(from, to, r + grow, 0.006 + grow)),
  );

const openingAxes = frame(kLook);
const skinSolid: Sdf = mirrored(
  smoothSubtract(
    0.014,
    smoothSubtract(0.03, withHorns(outerSolid(false), 0.025), palate, inJaw(floor), pharynx, ear),
    sphere(kEye, kEyeRadius + 0.005),
    ellipsoid(add(kEye, scale(kLook, 0.078)), [0.058, 0.046, 0.07], openingAxes),
    lens(kNostril, [0.016, 0.011, 0.04], [0.75, 0.35, 0.55]),
  ),
);

/** The head without its openings: what lies beneath its surface is the inside. */
const closedSolid: Sdf = mirrored(withHorns(outerSolid(true), 0.025, 0.004));
/** The same with the horns sunk into swellings: a cage follows no horn. */
const cagedSolid: Sdf = mirrored(withHorns(outerSolid(true), 0.14, 0.004));

// ---- parts ----

/** The line on which a jaw's teeth stand, from the left mouth corner to the middle, `inset` within the jaw's outline. */
const dentalLine = (jaw: Sdf, height: (z: number) => number, inset: number): Vec3[] => {
  const centre = 0.08;
  return Array.from({ length: 40 }, (_, i) => {
    const a = (((1 - i / 39) * Math.PI) / 2) * 1.12;
    let [low, high] = [0, 0.7];
    for (let k = 0; k < 40; k++) {
      const r = (low + high) / 2;
      const [x, z] = [r * Math.sin(a), centre + r * Math.cos(a)];
      if (jaw(x, height(z), z) < -inset) low = r;
      else high = r;
    }
    const [x, z] = [low * Math.sin(a), centre + low * Math.cos(a)];
    return [x, height(z), z];
  });
};

const teeth = (jaw: Sdf, inset: number, count: number, up: 1 | -1, place: (p: Vec3) => Vec3): Mesh => {
  const row = alongLine(
    dentalLine(jaw, (z) => lip(z), inset),
    count,
  );
  const half = row.map(({ at, ahead }, i) => {
    const size = (0.85 + 0.3 * Math.sin(2.1 * i + 1)) * (i < 3 ? 0.6 + 0.13 * i : 1);
    const inward = unit([-at[0], 0, 0.08 - at[2]]);
    const root: Vec3 = [at[0], at[1] - up * 0.018, at[2]];
    const tip = add(add(root, [0, up * 0.07 * size, 0]), scale(inward, 0.014));
    const neckRing = add(root, [0, up * 0.034 * size, 0]);
    return spike(
      [
        { centre: root, width: 0.0145 * size, depth: 0.012 * size },
        { centre: neckRing, width: 0.012 * size, depth: 0.01 * size },
      ].map((r) => ({ ...r, centre: place(r.centre) })),
      place(tip),
      unit(sub(place(add(at, ahead)), place(at))),
      5,
    );
  });
  return join(...half, ...half.map(reflected));
};

const tongueSolid: Sdf = mirrored(
  inJaw(
    smoothSubtract(
      0.02,
      smoothUnion(
        0.03,
        ellipsoid([0, -0.09, 0.06], [0.085, 0.032, 0.2]),
        tube([
          [0, -0.085, 0.1, 0.03],
          [0.02, -0.07, 0.26, 0.026],
          [0.03, -0.048, 0.34, 0.018],
          [0.036, -0.035, 0.385, 0.008],
        ]),
      ),
      roundCone([0, -0.045, 0.0], [0, -0.03, 0.5], 0.012, 0.016),
    ),
  ),
);

// ---- looks ----

const scales = (p: Vec3, size: number): { border: number; id: number } =>
  cells([p[0] / size, p[1] / size, p[2] / size]);

const skinShade: Shade = (p, n) => {
  const depth = -closedSolid(...p);
  const q: Vec3 = [Math.abs(p[0]), p[1], p[2]];
  const back = smoothstep(-0.25, 0.75, n[1]);
  const mottle = fractal(scale(q, 9));
  let c = mixColour(rgb('#b9b074'), rgb('#4f7a3a'), smoothstep(-0.2, 0.05, p[1] + 0.12 * back - 0.03));
  c = mixColour(c, rgb('#2f5a38'), back * smoothstep(0.4, 0.65, mottle));
  c = mixColour(c, rgb('#c9b25a'), 0.55 * smoothstep(0.6, 0.75, fractal(scale(q, 14), 7)) * back);
  // Horns pale towards their tips, lids warm, lips light.
  for (const { from, to } of cheekSpikes) {
    const t = length(sub(q, from)) / length(sub(to, from));
    if (length(sub(q, to)) < 0.09)
      c = mixColour(c, rgb('#e2cf9a'), smoothstep(0.45, 1, t) * smoothstep(0.1, 0.04, length(sub(q, to))));
  }
  const lidDistance = length(sub(q, add(kEye, scale(kLook, 0.05))));
  c = mixColour(c, rgb('#caa24c'), 0.8 * smoothstep(0.09, 0.06, lidDistance));
  const size = lidDistance < 0.1 ? 0.016 : 0.03;
  const s = scales(q, size);
  c = lit(c, 0.86 + 0.28 * s.id);
  c = lit(c, 0.62 + 0.38 * smoothstep(0.02, 0.16, s.border));
  // The inside of the mouth is wet and pink, dark towards the throat.
  const lining = mixColour(rgb('#c4606a'), rgb('#5a1824'), smoothstep(0.2, -0.15, p[2]));
  const inMouth =
    smoothstep(0.012, 0.03, depth) *
    (length(sub(q, kEye)) < 0.1 ? 0 : 1) *
    smoothstep(0.04, 0.07, length(sub(q, kEar)));
  c = lit(c, 1 - 0.55 * smoothstep(0.042, 0.026, length(sub(q, kEar))));
  c = mixColour(c, lit(lining, 0.9 + 0.2 * mottle), inMouth);
  const inNostril = smoothstep(0.03, 0.018, length(sub(q, kNostril)));
  return lit(c, 1 - 0.8 * inNostril);
};

const eyeShade: Shade = (p) => {
  const q: Vec3 = [Math.abs(p[0]), p[1], p[2]];
  const [right, up, front] = frame(kLook);
  const d = unit(sub(q, kEye));
  const along = (a: Vec3): number => d[0] * a[0] + d[1] * a[1] + d[2] * a[2];
  const angle = Math.acos(clamp(along(front), -1, 1));
  const turn = Math.atan2(along(up), along(right));
  const streaks = fractal([Math.cos(turn) * 9, Math.sin(turn) * 9, angle * 3]);
  let c = mixColour(rgb('#f0a818'), rgb('#a33f0c'), smoothstep(0.25, 0.85, angle + 0.5 * (streaks - 0.5)));
  c = mixColour(c, rgb('#2a1408'), smoothstep(0.82, 0.95, angle));
  const slit = Math.hypot(along(right) / 0.1, along(up) / 0.5);
  return mixColour(c, rgb('#0a0705'), smoothstep(1.12, 0.95, slit));
};

const toothShade: Shade = (p) => mixColour(rgb('#f3ead2'), rgb('#cdb98a'), fractal(scale(p, 60)));
const tongueShade: Shade = (p) =>
  mixColour(rgb('#d9707c'), rgb('#8e2c48'), smoothstep(0.1, 0.25, p[2]) * 0.7 + 0.3 * fractal(scale(p, 40)));

// ---- paints ----

const tiger: Shade = (p, n) => {
  const q: Vec3 = [Math.abs(p[0]), p[1], p[2]];
  const belly = smoothstep(-0.05, -0.22, p[1] + 0.15 * n[1]);
  let c = mixColour(rgb('#e8791c'), rgb('#f6e9cf'), belly);
  c = mixColour(c, rgb('#c95208'), 0.6 * smoothstep(0.1, 0.9, n[1]));
  const wobble = 0.05 * fractal(scale(q, 7)) + 0.16 * q[0];
  const wave = Math.sin((p[2] + wobble - 0.35 * p[1]) * 46);
  const width = 0.1 + 0.55 * fractal(scale(q, 5), 3) + 0.5 * belly;
  c = mixColour(c, rgb('#1c120c'), smoothstep(width - 0.08, width + 0.08, wave));
  const s = scales(q, 0.028);
  return lit(c, (0.92 + 0.14 * s.id) * (0.8 + 0.2 * smoothstep(0.02, 0.14, s.border)));
};

const warPaint: Shade = (p, n) => {
  const q: Vec3 = [Math.abs(p[0]), p[1], p[2]];
  const rough = 0.75 + 0.4 * (fractal(scale(p, 60)) - 0.5);
  let c: Rgba = rgb('#3d5c33', 0);
  const eye = sub(q, kEye);
  // A dark mask around the eyes that runs out backwards.
  const mask = Math.hypot(eye[1] * 1.15, (eye[2] + 0.02) * (eye[2] < 0 ? 0.55 : 0.8));
  c = over(c, rgb('#14110f'), smoothstep(0.135, 0.12, mask + 0.02 * rough) * smoothstep(0.05, 0.09, q[0]));
  // Three claw marks down the cheek, a red stripe over the snout, white dots along the brow.
  for (let k = 0; k < 3; k++) {
    const line = p[1] + 0.07 + 0.075 * k + 0.25 * (p[2] + 0.2);
    const ends = smoothstep(-0.42, -0.36, p[2]) * smoothstep(-0.02 - 0.04 * k, -0.09 - 0.04 * k, p[2]);
    c = over(c, rgb('#c7201a'), smoothstep(0.022, 0.016, Math.abs(line) * rough) * ends * smoothstep(0.1, 0.14, q[0]));
  }
  c = over(c, rgb('#c7201a'), smoothstep(0.034, 0.028, Math.abs(p[2] - 0.33) * rough) * smoothstep(-0.06, -0.03, p[1]));
  c = over(c, rgb('#f3efe4'), smoothstep(0.014, 0.01, Math.abs(p[2] - 0.275) * rough) * smoothstep(-0.06, -0.03, p[1]));
  c = over(
    c,
    rgb('#f3efe4'),
    smoothstep(0.03, 0.024, q[0] * rough) * smoothstep(0.2, 0.5, n[1]) * smoothstep(0.26, 0.2, p[2]),
  );
  for (let k = 0; k < 5; k++) {
    const at: Vec3 = [0.13 + 0.02 * k, 0.25, 0.2 - 0.075 * k];
    c = over(
      c,
      rgb('#f2c230'),
      smoothstep(0.021, 0.016, Math.hypot(q[0] - at[0], q[2] - at[2]) * rough) * smoothstep(0.1, 0.3, n[1]),
    );
  }
  return c;
};

/** A lizard's head with an open mouth. */
export const lizard = (): Model => {
  const eye = eyeball(kEye, kEyeRadius, kLook, 8, 14);
  const upper = teeth(snout, 0.026, 15, -1, (p) => p);
  const lower = teeth(chin, 0.03, 13, 1, swing);
  const tongue = symmetricSurface(tongueSolid, {
    bounds: { min: [-0.02, -0.42, -0.2], max: [0.14, 0.05, 0.4] },
    edge: 0.012,
    triangles: 260,
  });
  const others = 2 * triangleCount(eye) + triangleCount(upper) + triangleCount(lower) + triangleCount(tongue);
  const bounds = { min: [-0.03, -0.52, kNeck - 0.05] as Vec3, max: [0.42, 0.42, 0.64] as Vec3 };
  const skin = symmetricSurface(skinSolid, {
    bounds,
    edge: 0.0125,
    triangles: kTriangles - others,
    keep: (p) => p[2] - kNeck,
  });

  const parts: Part[] = [
    {
      ...textured('skin', boxAtlas(withFieldNormals(skin, skinSolid)), skinShade, 1024, 0.75, false),
      doubleSided: true,
    },
    textured('l-eye', eye, eyeShade, 512, 0.15, true),
    textured('r-eye', reflected(eye), eyeShade, 512, 0.15, true),
    textured('upper-teeth', boxAtlas(upper), toothShade, 64, 0.4, true),
    textured('lower-teeth', boxAtlas(lower), toothShade, 64, 0.4, true),
    textured('tongue', boxAtlas(withFieldNormals(tongue, tongueSolid)), tongueShade, 256, 0.35, true),
  ];

  const mouth = mouthHole();
  const eyeAxes = frame(kLook);
  const cage = makeCage({
    solid: cagedSolid,
    bounds: { min: [-0.08, -0.62, kNeck - 0.1], max: [0.5, 0.5, 0.72] },
    edge: 0.028,
    distance: 0.036,
    triangles: 620,
    wrap: skin,
    seen: (v) => Math.abs(closedSolid(...point(skin, v))) < 0.012,
    keep: (p) => {
      const e = sub(p, kEye);
      const [u, w, d] = eyeAxes.map((a) => e[0] * a[0] + e[1] * a[1] + e[2] * a[2]) as [number, number, number];
      const eyeHole = d < 0 ? 1 : (Math.hypot(u / 0.077, w / 0.069) - 1) * 0.05;
      return Math.min(p[2] - (kNeck - 0.03), eyeHole, mouth(...p));
    },
  });
  const seam = (a: Vec3, b: Vec3): boolean => a[0] === 0 && b[0] === 0 && (a[1] + b[1]) / 2 < -0.16;
  return {
    name: 'lizard',
    title: 'Lizard head',
    parts,
    cage: pelt(cage, seam),
    inside: (p) => closedSolid(...p) < -0.02,
    paints: [
      { name: 'tiger', title: 'Tiger stripes', shade: tiger, far: rgb('#c95208') },
      { name: 'war-paint', title: 'War paint', shade: warPaint, far: rgb('#3d5c33', 0) },
    ],
  };
};

/** The wedge between the lips, out to beyond the cage: negative inside it, so that `keep` can use it as it is. */
const mouthHole = (): Sdf => {
  const margin = -0.008; // the hole is a little larger than the mouth: what sticks out of it shall find no cage
  const upper: Sdf = (_x, y, z) => y - lip(z) + margin;
  const lower = inJaw((_x, y, z) => lip(z) + margin - y);
  return smoothIntersect(0.03, upper, lower, halfSpace([0, 0, -0.02], [0, 0, -1]));
};
