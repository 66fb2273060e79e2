import { Quaternion, Vector3 } from 'three';
import type { Vec3 } from './mesh';
import { jointNamed, joints, kToes } from './skeleton';

/** Rotations of joints by name, about the figure's own axes at rest, and how far the hips are moved. */
interface Stance {
  turns: Map<string, Quaternion>;
  hips: Vec3;
}
export interface Clip {
  name: string;
  times: number[];
  stances: Stance[];
}

const about = (axis: Vec3, angle: number): Quaternion =>
  new Quaternion().setFromAxisAngle(new Vector3(...axis).normalize(), angle);
const both = (...turns: Quaternion[]): Quaternion => turns.reduce((all, one) => all.clone().multiply(one));
const [kX, kY, kZ]: [Vec3, Vec3, Vec3] = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];
/** Which way the left arm points at rest, and the axis about which its elbow bends. */
const kArm: Vec3 = [0.71, -0.7, 0.03];
const kElbowAxis: Vec3 = [-0.7, -0.71, 0];
/** The same of the right side: a rotation mirrored in x. */
const mirrored = ({ x, y, z, w }: Quaternion): Quaternion => new Quaternion(x, -y, -z, w);

/** Sets a turn of the left side, or its mirror image. */
const set = (stance: Stance, side: 'left' | 'right', joint: string, turn: Quaternion): unknown =>
  stance.turns.set(side + joint, side === 'left' ? turn : mirrored(turn));

/** An arm that hangs, swung forward by an angle. */
function hang(stance: Stance, side: 'left' | 'right', swing: number, bend: number): void {
  set(stance, side, 'Shoulder', about(kZ, -0.06));
  set(stance, side, 'UpperArm', both(about(kX, -swing), about(kZ, -0.5), about(kArm, 0.25)));
  set(stance, side, 'LowerArm', about(kElbowAxis, bend));
  curl(stance, side, 0.22);
}

/** Bends the fingers. */
function curl(stance: Stance, side: 'left' | 'right', bend: number): void {
  // Across the hand: towards the palm.
  const axis: Vec3 = [0.1, 0.05, -1];
  ['Index', 'Middle', 'Ring', 'Little'].forEach((finger, i) => {
    for (const bone of ['Proximal', 'Intermediate', 'Distal'])
      set(stance, side, finger + bone, about(axis, bend * (0.8 + 0.15 * i)));
  });
  set(stance, side, 'ThumbProximal', about([-0.3, 0.5, -0.4], bend * 0.4));
}

const kTurn = 2 * Math.PI;
const rest = (): Stance => ({ turns: new Map(), hips: [0, 0, 0] });

/** Breathing, and the weight that goes from leg to leg. @param phase  0 to 1; the first of two breaths and the last are alike. */
function idle(phase: number): Stance {
  const stance = rest();
  const [breath, sway] = [Math.sin(2 * kTurn * phase), Math.sin(kTurn * phase)];
  stance.turns.set('hips', both(about(kZ, 0.012 * sway), about(kY, 0.02 * sway)));
  stance.turns.set('spine', both(about(kX, 0.008 * breath), about(kZ, -0.018 * sway)));
  stance.turns.set('chest', both(about(kX, -0.022 * breath), about(kZ, -0.006 * sway)));
  stance.turns.set('neck', both(about(kX, 0.016 * breath), about(kY, 0.05 * Math.sin(kTurn * phase + 0.9))));
  stance.turns.set('head', both(about(kY, 0.06 * Math.sin(kTurn * phase + 0.6)), about(kZ, 0.02 * sway)));
  for (const side of ['left', 'right'] as const) {
    hang(stance, side, 0.03 + 0.012 * breath, 0.2 + 0.02 * breath);
    set(stance, side, 'Shoulder', about(kZ, -0.05 + 0.022 * breath));
    // The feet stay: the leg turns back as far as the hips have turned and moved.
    const lean = Math.asin((0.012 * sway) / 0.84);
    stance.turns.set(`${side}UpperLeg`, both(about(kY, -0.02 * sway), about(kZ, -0.012 * sway - lean)));
    stance.turns.set(`${side}Foot`, about(kZ, lean));
  }
  stance.hips = [0.012 * sway, -0.001, 0];
  return stance;
}

/** A raised right hand that waves. */
function wave(phase: number): Stance {
  const stance = idle(phase);
  const swing = Math.sin(2 * kTurn * phase);
  set(stance, 'right', 'Shoulder', about(kZ, 0.16));
  set(stance, 'right', 'UpperArm', both(about(kY, -0.3), about(kZ, 0.62 + 0.03 * swing), about(kArm, -0.75)));
  set(stance, 'right', 'LowerArm', both(about(kArm, -0.7), about(kElbowAxis, 1.3 + 0.28 * swing)));
  set(stance, 'right', 'Hand', both(about(kElbowAxis, 0.16 * Math.sin(2 * kTurn * phase - 0.7))));
  curl(stance, 'right', 0.06);
  stance.turns.set('head', both(about(kZ, 0.05 + 0.02 * swing), about(kY, -0.1)));
  stance.turns.set('chest', both(about(kZ, 0.03), about(kX, -0.01 * Math.sin(2 * kTurn * phase))));
  return stance;
}

/** Bends of a leg through a step, from the heel's strike to the next: thigh forward, knee, toes upwards. */
const kGait: readonly (readonly [phase: number, thigh: number, knee: number, foot: number])[] = [
  [0, 0.4, 0.08, 0.08],
  [0.12, 0.33, 0.26, -0.03],
  [0.3, 0.06, 0.12, 0.1],
  [0.48, -0.24, 0.14, 0.14],
  [0.6, -0.2, 0.55, -0.24],
  [0.73, 0.18, 0.95, -0.06],
  [0.88, 0.44, 0.4, 0.06],
];
/** A smooth periodic curve through the values of a column. */
function gait(phase: number, column: 1 | 2 | 3): number {
  const count = kGait.length;
  const at = ((phase % 1) + 1) % 1;
  const i = kGait.findLastIndex(([from]) => from <= at);
  const key = (k: number): [number, number] => {
    const turns = Math.floor(k / count);
    const row = kGait[k - turns * count]!;
    return [row[0] + turns, row[column]];
  };
  const [[t0, v0], [t1, v1], [t2, v2], [t3, v3]] = [key(i - 1), key(i), key(i + 1), key(i + 2)];
  const span = t2 - t1;
  const t = (at - t1) / span;
  const [m1, m2] = [(span * (v2 - v0)) / (t2 - t0), (span * (v3 - v1)) / (t3 - t1)];
  return (
    (2 * t ** 3 - 3 * t ** 2 + 1) * v1 +
    (t ** 3 - 2 * t ** 2 + t) * m1 +
    (-2 * t ** 3 + 3 * t ** 2) * v2 +
    (t ** 3 - t ** 2) * m2
  );
}

function walk(phase: number): Stance {
  const stance = rest();
  const swing = Math.cos(kTurn * phase); // 1 when the left leg is in front
  stance.turns.set('hips', both(about(kY, -0.1 * swing), about(kZ, -0.03 * Math.sin(kTurn * phase)), about(kX, 0.03)));
  stance.turns.set('spine', both(about(kY, 0.08 * swing), about(kZ, 0.03 * Math.sin(kTurn * phase))));
  stance.turns.set('chest', about(kY, 0.12 * swing));
  stance.turns.set('neck', about(kY, -0.05 * swing));
  stance.turns.set('head', both(about(kY, -0.05 * swing), about(kX, -0.03)));
  for (const side of ['left', 'right'] as const) {
    const own = side === 'left' ? phase : phase + 0.5;
    const [thigh, knee, foot] = [gait(own, 1), gait(own, 2), gait(own, 3)];
    set(stance, side, 'UpperLeg', about(kX, -thigh));
    set(stance, side, 'LowerLeg', about(kX, knee));
    set(stance, side, 'Foot', about(kX, -foot));
    set(
      stance,
      side,
      'Toes',
      about(kX, -0.5 * Math.max(0, Math.sin(kTurn * (own - 0.42) * 2.2)) * Number(own % 1 > 0.42 && own % 1 < 0.647)),
    );
    const forward = side === 'left' ? -swing : swing;
    hang(stance, side, 0.02 + 0.36 * forward, 0.34 + 0.16 * forward);
  }
  stance.hips = [0, -lowest(stance), 0];
  return stance;
}

/** How high the lower foot is above the floor, where it is at rest. */
function lowest(stance: Stance): number {
  const places = new Map<number, { at: Vector3; turn: Quaternion }>();
  joints.forEach(({ name, parent, at }, j) => {
    const above = places.get(parent);
    const own = stance.turns.get(name) ?? new Quaternion();
    const offset = new Vector3(...at).sub(new Vector3(...(parent < 0 ? ([0, 0, 0] as Vec3) : joints[parent]!.at)));
    places.set(j, {
      at: above ? offset.applyQuaternion(above.turn).add(above.at) : offset,
      turn: above ? above.turn.clone().multiply(own) : own,
    });
  });
  const points = (['left', 'right'] as const).flatMap((side) =>
    [
      ['Foot', [0.116, 0, -0.085]],
      ['Foot', [0.13, 0, kToes[2]]],
      ['Toes', [0.13, 0, 0.15]],
    ].map(([joint, point]) => {
      const [x, y, z] = point as unknown as Vec3;
      const j = jointNamed(side + (joint as string));
      const { at, turn } = places.get(j)!;
      const rest = new Vector3(...joints[j]!.at);
      return new Vector3(side === 'left' ? x : -x, y, z).sub(rest).applyQuaternion(turn).add(at).y;
    }),
  );
  return Math.min(...points);
}

/** A clip whose last stance is its first. */
const clip = (name: string, seconds: number, steps: number, stanceAt: (phase: number) => Stance): Clip => {
  const phases = Array.from({ length: steps + 1 }, (_, i) => i / steps);
  return { name, times: phases.map((phase) => phase * seconds), stances: phases.map((phase) => stanceAt(phase % 1)) };
};

export const clips = (): Clip[] => [
  clip('Idle', 6, 24, idle),
  clip('Wave', 2.4, 24, wave),
  clip('Walk', 1.1, 22, walk),
];
