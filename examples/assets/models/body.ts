import { ellipsoid, local, roundCone, type Sdf, smoothUnion, sphere, tube } from '../sdf.ts';
import { add, frame, scale, sub, type Vec3 } from '../vec.ts';
import { cagedSolid as headCaged, closedSolid as headClosed } from './human.ts';

// Metres. The figure stands on y = 0 and looks to +z; its left is +x. Every solid here is the left half, for x >= 0.

/** Height of the head, from chin to crown, and where the middle of it is. */
export const kHead = { size: 0.228, centre: [0, 1.612, 0.022] as Vec3 };
export const onHead = (p: Vec3): Vec3 => add(kHead.centre, scale(p, kHead.size));
export const inHead = (p: Vec3): Vec3 => scale(sub(p, kHead.centre), 1 / kHead.size);

/** A field of the head's sample, in its place on the body. */
export const placed =
  (head: Sdf): Sdf =>
  (x, y, z) =>
    kHead.size *
    head((x - kHead.centre[0]) / kHead.size, (y - kHead.centre[1]) / kHead.size, (z - kHead.centre[2]) / kHead.size);

// ---- the skeleton ----

/** Joint centres, named as in the landmark list; those of the limbs are the left ones. */
export const kJoints = {
  hips: [0, 0.925, -0.015],
  spine: [0, 0.995, -0.02],
  chest: [0, 1.145, -0.025],
  neck: [0, 1.415, -0.035],
  head: [0, 1.575, 0.008],
  jaw: [0, 1.576, 0.025],
  clavicle: [0.023, 1.38, 0.0],
  shoulder: [0.17, 1.365, -0.02],
  elbow: [0.366, 1.17, -0.028],
  wrist: [0.538, 0.998, 0.004],
  hip: [0.09, 0.905, -0.005],
  knee: [0.107, 0.49, -0.002],
  ankle: [0.116, 0.085, -0.03],
} satisfies Record<string, Vec3>;
const { shoulder, elbow, wrist, knee, ankle } = kJoints;

/** A point of the arm: along it from the wrist to the fingertips, towards the thumb, and to the palm's side. */
export const handAxes = (() => {
  const [thumb, palm, along] = frame(sub([0.645, 0.886, 0.022], wrist), [-0.72, -0.66, -0.1]);
  return { along, thumb: thumb[2] > 0 ? thumb : scale(thumb, -1), palm };
})();
export const handAt = (a: number, t: number, m: number): Vec3 =>
  add(wrist, add(scale(handAxes.along, a), add(scale(handAxes.thumb, t), scale(handAxes.palm, m))));

// ---- trunk ----

const trunk = smoothUnion(
  0.06,
  ellipsoid([0, 1.245, -0.008], [0.15, 0.185, 0.102]),
  ellipsoid([0, 1.085, -0.006], [0.129, 0.17, 0.09]),
  ellipsoid([0, 0.945, -0.01], [0.146, 0.115, 0.096]),
  ellipsoid([0, 1.01, 0.022], [0.1, 0.1, 0.068]),
);
const flesh = smoothUnion(
  0.05,
  ellipsoid([0.07, 1.285, 0.058], [0.076, 0.058, 0.034]), // breast
  ellipsoid([0.1, 1.215, -0.042], [0.05, 0.13, 0.055]), // back's side
  ellipsoid([0.068, 1.31, -0.085], [0.062, 0.075, 0.026]), // shoulder blade
  ellipsoid([0.072, 0.895, -0.062], [0.07, 0.085, 0.06]), // buttock
  ellipsoid([0.105, 0.905, 0.0], [0.05, 0.1, 0.07]), // hip
);
const girdle = smoothUnion(
  0.05,
  roundCone([0.02, 1.36, -0.03], [0.158, 1.368, -0.024], 0.068, 0.05),
  roundCone([0.03, 1.42, -0.045], [0.15, 1.39, -0.03], 0.042, 0.034), // trapezius
);

// ---- arm ----

const between = (a: Vec3, b: Vec3, t: number, shift: Vec3 = [0, 0, 0]): Vec3 =>
  add(add(scale(a, 1 - t), scale(b, t)), shift);
const along = (a: Vec3, b: Vec3): readonly [Vec3, Vec3, Vec3] => frame(sub(b, a), [0, 0, 1]);
/** A muscle: an ellipsoid drawn out along a bone. */
const muscle = (a: Vec3, b: Vec3, t: number, shift: Vec3, r: Vec3): Sdf =>
  ellipsoid(between(a, b, t, shift), r, along(a, b));

const upperArm = smoothUnion(
  0.03,
  roundCone(between(shoulder, elbow, 0.05), elbow, 0.046, 0.034),
  ellipsoid([0.183, 1.362, -0.02], [0.056, 0.062, 0.056]), // deltoid
  muscle(shoulder, elbow, 0.24, [0.01, 0.008, 0], [0.044, 0.046, 0.085]),
  muscle(shoulder, elbow, 0.58, [-0.004, -0.004, 0.013], [0.036, 0.036, 0.085]), // biceps
  muscle(shoulder, elbow, 0.5, [0.002, 0.004, -0.018], [0.034, 0.034, 0.1]), // triceps
);
const forearm = smoothUnion(
  0.025,
  roundCone(elbow, wrist, 0.033, 0.021),
  sphere(add(elbow, [0.006, 0.004, -0.01]), 0.027),
  muscle(elbow, wrist, 0.24, [0.004, 0.006, 0.008], [0.037, 0.035, 0.085]),
  muscle(elbow, wrist, 0.3, [-0.008, -0.006, -0.004], [0.034, 0.033, 0.09]),
  ellipsoid(between(elbow, wrist, 0.97), [0.029, 0.021, 0.03], [handAxes.thumb, handAxes.palm, handAxes.along]),
);

// ---- hand: how far along, towards the thumb, to the palm's side, and the radius ----

type Spot = readonly [number, number, number, number];
const finger = (points: readonly Spot[]): Sdf =>
  tube(points.map(([a, t, m, r]) => [...handAt(a, t, m), r] as [number, number, number, number]));
/** The fingers' bones from the knuckle to the tip. */
export const kFingers: Record<string, readonly Spot[]> = {
  index: [
    [0.088, 0.029, 0.0, 0.0108],
    [0.126, 0.034, 0.004, 0.0096],
    [0.15, 0.036, 0.01, 0.0088],
    [0.167, 0.037, 0.016, 0.0075],
  ],
  middle: [
    [0.091, 0.0085, -0.002, 0.011],
    [0.133, 0.01, 0.003, 0.0099],
    [0.16, 0.0105, 0.0095, 0.009],
    [0.179, 0.0105, 0.016, 0.0076],
  ],
  ring: [
    [0.087, -0.0125, -0.001, 0.0105],
    [0.126, -0.0145, 0.004, 0.0094],
    [0.151, -0.0155, 0.011, 0.0086],
    [0.168, -0.016, 0.0175, 0.0073],
  ],
  pinky: [
    [0.08, -0.0325, 0.002, 0.0094],
    [0.109, -0.037, 0.006, 0.0082],
    [0.127, -0.039, 0.011, 0.0076],
    [0.141, -0.04, 0.016, 0.0066],
  ],
  thumb: [
    [0.026, 0.026, 0.012, 0.0145],
    [0.062, 0.049, 0.021, 0.012],
    [0.088, 0.06, 0.024, 0.0108],
    [0.108, 0.066, 0.025, 0.0085],
  ],
};
const axesOfHand: [Vec3, Vec3, Vec3] = [handAxes.along, handAxes.thumb, handAxes.palm];
const palm = smoothUnion(
  0.02,
  ...(['index', 'middle', 'ring', 'pinky'] as const).map((name, i) => {
    const [a, t, m, r] = kFingers[name]![0]!;
    return roundCone(handAt(0.012, t * 0.55, 0.002), handAt(a, t, m), 0.014, r + 0.001 * (i === 3 ? 0 : 1));
  }),
  ellipsoid(handAt(0.05, 0.0, 0.004), [0.05, 0.034, 0.0145], axesOfHand),
  ellipsoid(handAt(0.042, 0.026, 0.013), [0.034, 0.017, 0.014], axesOfHand), // ball of the thumb
  ellipsoid(handAt(0.045, -0.024, 0.01), [0.036, 0.013, 0.0125], axesOfHand),
);
const kHandBall = { centre: handAt(0.085, 0, 0.005), radius: 0.125 };
const inHand = (s: Sdf): Sdf => local(kHandBall.centre, kHandBall.radius, 0.08, s);
const hand = inHand(smoothUnion(0.012, palm, smoothUnion(0.003, ...Object.values(kFingers).map(finger))));
/** The hand with its four fingers in one. */
const mitten = inHand(
  smoothUnion(
    0.014,
    smoothUnion(0.03, palm, ...['index', 'middle', 'ring', 'pinky'].map((n) => finger(kFingers[n]!))),
    finger(kFingers['thumb']!),
  ),
);

// ---- leg ----

const thigh = smoothUnion(
  0.045,
  tube([
    [0.09, 0.885, -0.005, 0.08],
    [0.097, 0.76, 0.0, 0.073],
    [0.104, 0.6, 0.002, 0.058],
    [0.107, 0.5, 0.004, 0.047],
  ]),
  ellipsoid([0.104, 0.69, 0.032], [0.056, 0.15, 0.045]),
  ellipsoid([0.098, 0.69, -0.032], [0.054, 0.14, 0.042]),
  ellipsoid([0.083, 0.55, 0.02], [0.026, 0.05, 0.03]),
);
const shin = smoothUnion(
  0.028,
  tube([
    [...knee, 0.045],
    [0.111, 0.36, -0.012, 0.045],
    [0.115, 0.2, -0.022, 0.033],
    [ankle[0], ankle[1] + 0.02, ankle[2], 0.029],
  ] as [number, number, number, number][]),
  ellipsoid([0.107, 0.488, 0.026], [0.032, 0.044, 0.026]), // kneecap
  ellipsoid([0.098, 0.362, -0.036], [0.033, 0.092, 0.035]), // calf, inside
  ellipsoid([0.129, 0.372, -0.031], [0.03, 0.085, 0.031]), // calf, outside
  roundCone([0.116, 0.25, -0.052], [0.117, 0.07, -0.062], 0.012, 0.014), // tendon
  sphere([0.098, 0.088, -0.025], 0.015),
  sphere([0.135, 0.08, -0.034], 0.0145),
);
const toe = (root: Vec3, tip: Vec3, ra: number, rb: number): Sdf => roundCone(root, tip, ra, rb);
/** Tips of the five toes, and their radius. */
export const kToes: readonly (readonly [number, number, number, number])[] = [
  [0.108, 0.0155, 0.158, 0.0155],
  [0.1315, 0.0125, 0.158, 0.0115],
  [0.149, 0.0115, 0.149, 0.0105],
  [0.1645, 0.011, 0.137, 0.01],
  [0.178, 0.0105, 0.121, 0.0098],
];
const foot = local(
  [0.125, 0.04, 0.04],
  0.17,
  0.08,
  smoothUnion(
    0.022,
    ellipsoid([0.115, 0.034, -0.058], [0.031, 0.034, 0.036]), // heel
    roundCone([0.117, 0.07, -0.022], [0.128, 0.034, 0.07], 0.036, 0.026),
    roundCone([0.13, 0.024, -0.04], [0.154, 0.021, 0.07], 0.024, 0.021),
    ellipsoid([0.132, 0.021, 0.092], [0.044, 0.021, 0.038], frame([0.12, 0, 1])),
    smoothUnion(
      0.006,
      ...kToes.map(([x, y, z, r], i) => toe([0.112 + 0.0145 * i, 0.02, 0.1 - 0.009 * i], [x, y, z], r + 0.002, r)),
    ),
  ),
);
const floor: Sdf = (_x, y) => -y;
const onFloor =
  (s: Sdf): Sdf =>
  (x, y, z) => {
    const [a, b] = [s(x, y, z), floor(x, y, z)];
    const h = Math.max(0.008 - Math.abs(a - b), 0);
    return Math.max(a, b) + (h * h) / 0.032;
  };

const kBlend = 0.06; // beyond the widest blend of two pieces

/** All but the head. */
const figure = (withHand: Sdf): Sdf => {
  const body = local([0, 1.13, -0.01], 0.36, kBlend, smoothUnion(0.045, smoothUnion(0.045, trunk, flesh), girdle));
  const arm = local([0.4, 1.13, 0], 0.38, kBlend, smoothUnion(0.018, smoothUnion(0.025, upperArm, forearm), withHand));
  const leg = local([0.11, 0.48, 0], 0.53, kBlend, smoothUnion(0.028, smoothUnion(0.03, thigh, shin), onFloor(foot)));
  return smoothUnion(0.035, smoothUnion(0.04, body, arm), leg);
};

const nearHead = (head: Sdf): Sdf => local(onHead([0, -0.2, 0]), 0.26, 0.1, placed(head));

/** The figure's outer skin, lips closed and lids shut; only x >= 0. */
export const bodyClosed: Sdf = smoothUnion(0.03, figure(hand), nearHead(headClosed));
const gusset = ellipsoid([0, 0.832, -0.012], [0.055, 0.032, 0.075]); // between the thighs, where a cage would fold
/** The skin as a cage sees it: fingers in one, ears as mere swellings. */
export const bodyCaged: Sdf = smoothUnion(0.03, smoothUnion(0.03, figure(mitten), gusset), nearHead(headCaged));
