import { add, clamp, dot, frame, length, type Mesh, neighbours, scale, smoothstep, sub, unit, type Vec3 } from './mesh';

/** A joint, named as in VRM. */
export interface Joint {
  name: string;
  /** The joint above it, by place. */
  parent: number;
  at: Vec3;
  /** How far its weight fades around its borders, in metres. */
  fade: number;
}

// Metres. The figure stands on y = 0 and looks to +z; its left is +x. Joints of the limbs are the left ones.
const kWrist: Vec3 = [0.538, 0.998, 0.004];
const kShoulder: Vec3 = [0.17, 1.365, -0.02];
export const kElbow: Vec3 = [0.366, 1.17, -0.028];
const kKnee = 0.49;
const kAnkle = 0.085;
export const kToes: Vec3 = [0.132, 0.02, 0.085];

const [thumbwards, palmwards, along] = (() => {
  const [thumb, palm, front] = frame(sub([0.645, 0.886, 0.022], kWrist), [-0.72, -0.66, -0.1]);
  return [thumb[2] > 0 ? thumb : scale(thumb, -1), palm, front] as const;
})();
/** A point of the hand: along it from the wrist, towards the thumb, and to the palm's side. */
const handAt = ([a, t, m]: Vec3): Vec3 =>
  add(kWrist, add(scale(along, a), add(scale(thumbwards, t), scale(palmwards, m))));

/** The fingers' joints from the knuckle to the tip: along the hand, towards the thumb, and to the palm's side. */
const kFingers: Record<string, readonly Vec3[]> = {
  Index: [
    [0.088, 0.029, 0],
    [0.126, 0.034, 0.004],
    [0.15, 0.036, 0.01],
    [0.167, 0.037, 0.016],
  ],
  Middle: [
    [0.091, 0.0085, -0.002],
    [0.133, 0.01, 0.003],
    [0.16, 0.0105, 0.0095],
    [0.179, 0.0105, 0.016],
  ],
  Ring: [
    [0.087, -0.0125, -0.001],
    [0.126, -0.0145, 0.004],
    [0.151, -0.0155, 0.011],
    [0.168, -0.016, 0.0175],
  ],
  Little: [
    [0.08, -0.0325, 0.002],
    [0.109, -0.037, 0.006],
    [0.127, -0.039, 0.011],
    [0.141, -0.04, 0.016],
  ],
  Thumb: [
    [0.026, 0.026, 0.012],
    [0.062, 0.049, 0.021],
    [0.088, 0.06, 0.024],
    [0.108, 0.066, 0.025],
  ],
};
const kPhalanges = ['Proximal', 'Intermediate', 'Distal'];
const kThumb = ['Metacarpal', 'Proximal', 'Distal'];

const limb: [name: string, parent: string, at: Vec3, fade: number][] = [
  ['Shoulder', 'chest', [0.023, 1.38, 0], 0.04],
  ['UpperArm', 'Shoulder', kShoulder, 0.035],
  ['LowerArm', 'UpperArm', kElbow, 0.024],
  ['Hand', 'LowerArm', kWrist, 0.016],
  ...Object.entries(kFingers).flatMap(([finger, points]) =>
    (finger === 'Thumb' ? kThumb : kPhalanges).map((bone, i, bones): (typeof limb)[number] => [
      finger + bone,
      i === 0 ? 'Hand' : finger + bones[i - 1]!,
      handAt(points[i]!),
      0.005,
    ]),
  ),
  ['UpperLeg', 'hips', [0.09, 0.905, -0.005], 0.05],
  ['LowerLeg', 'UpperLeg', [0.107, kKnee, -0.002], 0.03],
  ['Foot', 'LowerLeg', [0.116, kAnkle, -0.03], 0.02],
  ['Toes', 'Foot', kToes, 0.014],
];
const middle: [name: string, parent: string, at: Vec3, fade: number][] = [
  ['hips', '', [0, 0.925, -0.015], 0.05],
  ['spine', 'hips', [0, 0.995, -0.02], 0.05],
  ['chest', 'spine', [0, 1.145, -0.025], 0.05],
  ['neck', 'chest', [0, 1.415, -0.035], 0.022],
  ['head', 'neck', [0, 1.54, -0.01], 0.022],
];

/** The skeleton; parents come first. */
export const joints: readonly Joint[] = (() => {
  const all = [
    ...middle,
    ...([1, -1] as const).flatMap((side) =>
      limb.map(([name, parent, [x, y, z], fade]): (typeof limb)[number] => {
        const called = (one: string): string => (/^[a-z]/.test(one) ? one : `${side > 0 ? 'left' : 'right'}${one}`);
        return [called(name), called(parent), [side * x, y, z], fade];
      }),
    ),
  ];
  const places = new Map(all.map(([name], i) => [name, i]));
  return all.map(([name, parent, at, fade]) => ({ name, parent: places.get(parent) ?? -1, at, fade }));
})();
export const jointNamed = (name: string): number => joints.findIndex((joint) => joint.name === name);

// ---- what each joint moves ----

const armAxis = unit(sub(kWrist, kShoulder));
const fromArm = (p: Vec3): number => {
  const q = sub(p, kShoulder);
  return length(sub(q, scale(armAxis, dot(q, armAxis))));
};
/** Positive on neck and head. */
const neckSide = ([x, y, z]: Vec3): number => y - (1.425 - 0.35 * (z + 0.03) + 0.6 * Math.max(x - 0.02, 0));
/** Positive on the arm. */
export const armSide = (p: Vec3): number =>
  Math.min(p[0] - (0.178 + 0.05 * (p[1] - 1.3)), 0.11 - fromArm(p), p[1] - 0.7);
/** Positive on the leg. */
const legSide = ([x, y, z]: Vec3): number => Math.min(0.8 + (0.55 + 0.2 * clamp(z / 0.06, -1, 1)) * x - y, 0.3 - x);

/** How far a point is from a line between two others. */
const toLine = (p: Vec3, a: Vec3, b: Vec3): number => {
  const [q, line] = [sub(p, a), sub(b, a)];
  return length(sub(q, scale(line, clamp(dot(q, line) / dot(line, line)))));
};

function fingerOf(p: Vec3): string {
  let [best, nearest] = ['Hand', Infinity];
  for (const [finger, points] of Object.entries(kFingers)) {
    const isThumb = finger === 'Thumb';
    // A knuckle bends in its own plane: behind it is the palm.
    const [first, second] = [handAt(points[0]!), handAt(points[1]!)];
    const start = dot(sub(p, first), unit(sub(second, first)));
    if (start < (isThumb ? 0.012 : 0.004)) continue;
    points.slice(1).forEach((_, i) => {
      const far = toLine(p, handAt(points[i]!), handAt(points[i + 1]!)) + (isThumb && i === 0 ? 0.006 : 0);
      if (far < nearest && far < 0.022) [best, nearest] = [finger + (isThumb ? kThumb : kPhalanges)[i]!, far];
    });
  }
  return best;
}

/** The joint that moves a point most, without its side. @param p  With x >= 0. */
function mover(p: Vec3): string {
  const [x, y, z] = p;
  if (neckSide(p) > 0) return y > 1.52 - 0.3 * z ? 'head' : 'neck';
  if (armSide(p) > 0) {
    const bend = unit(add(unit(sub(kElbow, kShoulder)), unit(sub(kWrist, kElbow))));
    if (dot(sub(p, kElbow), bend) < 0) return 'UpperArm';
    return dot(sub(p, kWrist), along) < 0 ? 'LowerArm' : fingerOf(p);
  }
  if (legSide(p) > 0) {
    if (y > kKnee) return 'UpperLeg';
    if (y > kAnkle - 0.4 * (z + 0.03)) return 'LowerLeg';
    return z > kToes[2] ? 'Toes' : 'Foot';
  }
  if (y > 1.28 && x > 0.085) return 'Shoulder';
  return y > 1.13 ? 'chest' : y > 0.985 ? 'spine' : 'hips';
}

const kRounds = 300;
const kMost = 4; // joints per vertex

/** The joint that moves a point most, by place. */
function moverOf([x, y, z]: Vec3): number {
  const name = mover([Math.abs(x), y, z]);
  return jointNamed(/^[a-z]/.test(name) ? name : (x < 0 ? 'right' : 'left') + name);
}

/** Gives each vertex the weights of joints: those of the joint that moves it, faded along the surface. */
export function weigh(mesh: Mesh): void {
  const around = neighbours(mesh);
  const movers = mesh.vertices.map(({ at }) => moverOf(at));
  const fades = movers.map((joint) => joints[joint]!.fade);
  const links = around.map((near, v) =>
    near.map((w) => {
      const far = Math.max(length(sub(mesh.vertices[v]!.at, mesh.vertices[w]!.at)), 1e-3);
      return ((2 / 3) * fades[v]! * fades[w]!) / far ** 2;
    }),
  );
  const weights = movers.map((joint) => joints.map((_, j) => (j === joint ? 1 : 0)));
  for (let round = 0; round < kRounds; round++)
    for (let v = 0; v < weights.length; v++) {
      const total = 1 + links[v]!.reduce((sum, link) => sum + link, 0);
      const row = weights[v]!;
      for (let j = 0; j < row.length; j++) {
        let sum = movers[v] === j ? 1 : 0;
        for (let i = 0; i < around[v]!.length; i++) sum += links[v]![i]! * weights[around[v]![i]!]![j]!;
        row[j] = sum / total;
      }
    }
  mesh.vertices.forEach((vertex, v) => {
    vertex.weights = weights[v]!;
  });
}

/** The strongest joints of a vertex, whose weights add up to 1. */
export function strongest(weights: readonly number[]): { joint: number; weight: number }[] {
  const best = weights
    .map((weight, joint) => ({ joint, weight }))
    .sort((a, b) => b.weight - a.weight)
    .slice(0, kMost)
    .map((one) => ({ ...one, weight: one.weight * smoothstep(0, 0.03, one.weight) }));
  const total = best.reduce((sum, { weight }) => sum + weight, 0);
  return best.map(({ joint, weight }) => ({ joint, weight: weight / total }));
}
