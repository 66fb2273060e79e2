import { enlarged, makeCage } from '../cage.ts';
import type { Part } from '../glb.ts';
import { rgb } from '../image.ts';
import { bothSides, finderOn, inMiddle, type Landmarks } from '../landmarks.ts';
import {
  clip,
  join,
  type Mesh,
  mirror,
  point,
  reflected,
  simplify,
  surface,
  withFieldNormals,
  withMeshNormals,
} from '../mesh.ts';
import type { Model } from '../model.ts';
import { mirrored, type Sdf } from '../sdf.ts';
import type { Slit } from '../slit.ts';
import { namedHoles, symmetric, type Template } from '../template.ts';
import { mirroredAtlas, splitAlong } from '../unwrap.ts';
import { add, clamp, dot, length, scale, sub, type Vec3 } from '../vec.ts';
import { bodyCaged, bodyClosed, handAt, handAxes, inHead, kFingers, kHead, kJoints, kToes, onHead } from './body.ts';
import {
  bend,
  closedSolid,
  faceFocus,
  headLandmarks,
  headSkin,
  isHeadSeam,
  kEye,
  kMouth,
  kMouthRim,
  kNoseTip,
  leftEye,
  lidOpening,
  lipGap,
  others,
} from './human.ts';

const kFold = 0.004; // m: rounds the middle, where the two halves meet
const solid: Sdf = mirrored(bodyClosed, kFold);
const caged: Sdf = mirrored(bodyCaged, kFold);
const kDistance = 0.01; // m, of the cage from the skin

// ---- the model ----

const kCut = 1.494; // m: above it the skin is that of the head's sample, below it the figure's

/** Half of a mesh symmetric in x, with fewer triangles, and its mirror image. */
const fewer = (mesh: Mesh, keep: (p: Vec3) => number, triangles: number): Mesh =>
  mirror(
    simplify(
      clip(
        clip(mesh, (p) => p[0]),
        keep,
      ),
      triangles / 2,
    ),
  );

const scaled = (mesh: Mesh): Mesh => {
  const positions = mesh.positions.slice();
  for (let i = 0; i < positions.length; i += 3)
    positions.set(onHead([positions[i]!, positions[i + 1]!, positions[i + 2]!]), i);
  return { ...mesh, positions };
};

let sampleMade: Mesh | undefined;
/** The skin of the head's sample, in its own units. */
const sample = (): Mesh => (sampleMade ??= headSkin(6000, 0.0125));

const skinOf = (): { head: Mesh; figure: Mesh } => {
  const fine = surface(solid, { min: [-0.02, -0.02, -0.19], max: [0.72, kCut + 0.02, 0.24] }, 0.009);
  const head = scaled(sample());
  return {
    head: withMeshNormals(clip({ positions: head.positions, indices: head.indices }, (p) => p[1] - kCut)),
    figure: withFieldNormals(
      fewer(fine, (p) => kCut - p[1], 8000),
      solid,
    ),
  };
};

// ---- where the cage is slit for its layout: head, front, back, an arm and a leg with a sole ----

const { shoulder, wrist } = kJoints;
const armAxis = scale(sub(wrist, shoulder), 1 / length(sub(wrist, shoulder)));
const fromArm = (p: Vec3): number => {
  const q = sub(p, shoulder);
  return length(sub(q, scale(armAxis, dot(q, armAxis))));
};
const neckSide = (p: Vec3): number => p[1] - (1.425 - 0.35 * (p[2] + 0.03) + 0.6 * Math.max(p[0] - 0.02, 0));
const armSide = (p: Vec3): number => Math.min(p[0] - (0.178 + 0.05 * (p[1] - 1.3)), 0.11 - fromArm(p), p[1] - 0.7);
const legSide = (p: Vec3): number =>
  Math.min(0.765 + (0.5 + 0.25 * clamp(p[2] / 0.06, -1, 1)) * p[0] - p[1], 0.3 - p[0]);
const isTrunk = (p: Vec3): boolean => neckSide(p) < 0 && armSide(p) < 0 && legSide(p) < 0;

const kSide = -0.014; // z of the seam between front and back
const kSole = 0.004; // y of the sole's edge
const legMiddle = (p: Vec3): Vec3 => {
  const t = clamp((0.9 - p[1]) / 0.82);
  return [0.09 + 0.027 * t, p[1], -0.004 - 0.024 * t * t];
};
/** Along the hand, towards the thumb, to the palm's side; along is negative on the arm. */
const onArm = (p: Vec3): Vec3 => {
  const q = sub(p, wrist);
  return [dot(q, handAxes.along), dot(q, handAxes.thumb), dot(q, handAxes.palm)];
};
const [reach, , rise] = onArm(shoulder);
const seams: Slit[] = [
  { field: neckSide, within: () => true },
  { field: armSide, within: () => true },
  { field: legSide, within: () => true },
  { field: (p) => p[2] - kSide, within: isTrunk },
  { field: (p) => p[1] - kSole, within: (p) => legSide(p) > 0 && p[2] > -0.058 },
  {
    field: (p) => p[2] - legMiddle(p)[2],
    within: (p) => legSide(p) > 0 && p[1] > kSole && p[0] < legMiddle(p)[0],
  },
  {
    field: (p) => {
      const [a, t, m] = onArm(p);
      return m - (a < 0 ? (rise * a) / reach : 0) - 0.003 - 0.55 * Math.max(t - 0.02, 0) * clamp(a / 0.03);
    },
    within: (p) => {
      const [a, t] = onArm(p);
      return armSide(p) > 0 && (t < 0 || a > 0.02);
    },
  },
];

// ---- the cage ----

/** Looks twice as closely at the face as at the rest. */
const faceLens = (p: Vec3): Vec3 => [bend(p[0], -1, 0.1), bend(p[1], 1.48, 2), bend(p[2], 0.03, 0.16)];

/** Enlarges the face, the hands and the feet, so that they keep more of their triangles. */
const focus = (p: Vec3): Vec3 => {
  const inHeadFocus = scale(
    sub(onHead(faceFocus(inHead(p))), p),
    Math.exp(-((length(sub(p, kHead.centre)) / 0.2) ** 4)),
  );
  return enlarged(
    p,
    [
      [kHead.centre, 0.2, 1.3],
      [handAt(0.09, 0.005, 0), 0.11, 0.9],
      [handAt(0.09, 0.06, 0.02), 0.045, 1.2],
      [onHead(kNoseTip), 0.035, 0.8],
      [[0.13, 0.02, 0.06], 0.13, 0.5],
    ],
    add(p, inHeadFocus),
  );
};

const cageOf = (skin: Mesh): Mesh => {
  const cage = makeCage({
    solid: caged,
    bounds: { min: [-0.03, 0.72, -0.09], max: [0.42, 1.77, 0.21] },
    edge: 0.0055,
    lens: faceLens,
    distance: kDistance,
    triangles: 1500,
    focus,
    seams,
    wrap: skin,
    seen: (v) => {
      const p = point(skin, v);
      return p[1] > kCut ? Math.abs(closedSolid(...inHead(p))) < 0.006 : Math.abs(solid(...p)) < 0.002;
    },
    keep: (p) => {
      const q = inHead(p);
      return Math.min(lidOpening(0.006)(...q), lipGap(kMouthRim)(q[0], q[1], Math.min(q[2], 0.37)) * 0.5);
    },
  });
  const behind = (p: Vec3): boolean => neckSide(p) > -1e-3 && isHeadSeam(inHead(p));
  const { mesh } = splitAlong(cage, (a, b) => !(behind(point(cage, a)) && behind(point(cage, b))));
  const face = onHead([0, -0.13, 0.38]);
  return symmetric(
    mirroredAtlas(
      mesh,
      [
        { near: [0, 1.6, 0], up: [0, 1, 0] },
        { near: [0, 1.15, 0.1], up: [0, 1, 0] },
        { near: [0, 1.15, -0.1], up: [0, 1, 0] },
        { near: [0.45, 1.1, 0], up: scale(armAxis, -1) },
        { near: [0.11, 0.4, 0], up: [0, 1, 0] },
      ],
      (p) => (neckSide(p) > 0 ? 1.5 : 1) + 1.1 * Math.exp(-((length(sub(p, face)) / 0.09) ** 2)),
    ),
  );
};

// ---- landmarks ----

const spotsOf = (skin: Mesh): Landmarks => {
  const { near, from, furthest } = finderOn(skin);
  const face = headLandmarks(sample());
  const { hips, spine, chest, neck, head: skull, jaw, ...limbs } = kJoints;
  const tip = (name: string): Vec3 => {
    const [a, t, m, radius] = kFingers[name]!.at(-1)!;
    return near(handAt(a + radius, t, m + 0.2 * radius));
  };
  const toe = (i: number): Vec3 => {
    const [x, y, z, radius] = kToes[i]!;
    return near([x, y, z + radius]);
  };
  return {
    ...Object.fromEntries(Object.entries(face).map(([name, p]) => [name, onHead(p)])),
    ...inMiddle({
      collar_front: from([0, 0, 1], [0, 1.378, 0]),
      collar_back: from([0, 0, -1], [0, 1.415, 0]),
      joint_hips: hips,
      joint_spine: spine,
      joint_chest: chest,
      joint_neck: neck,
      joint_head: skull,
      joint_jaw: jaw,
    }),
    ...bothSides({
      shoulder: from([0, 1, 0], add(shoulder, [0.015, 0, 0])),
      elbow: from([0, 0, -1], kJoints.elbow),
      wrist,
      finger_thumb: tip('thumb'),
      finger_index: tip('index'),
      finger_middle: tip('middle'),
      finger_ring: tip('ring'),
      finger_pinky: tip('pinky'),
      hip: near([0.2, 0.868, 0]),
      knee: from([0, 0, 1], add(kJoints.knee, [0, 0.022, 0])),
      ankle: furthest([1, 0, 0], [0.135, 0.08, -0.034], 0.03),
      heel: furthest([0, 0, -1], [0.115, 0.016, -0.08], 0.02),
      toe_big: toe(0),
      toe_small: toe(4),
      joint_eye: onHead(kEye),
      ...Object.fromEntries(Object.entries(limbs).map(([name, p]) => [`joint_${name}`, p])),
    }),
  };
};

const templateOf = (skin: Mesh): Template => {
  const cage = cageOf(skin);
  const holes = namedHoles(cage, { ...bothSides({ eye: onHead(add(kEye, [0, 0, 0.07])) }), mouth: onHead(kMouth) });
  return { name: 'human-body', kind: 'body', cage, landmarks: spotsOf(skin), holes, skin };
};

/** A neutral figure with the head of the sample, arms half lowered: the model of the body's template, no sample itself. */
export const humanBody = (): Model => {
  const { head, figure } = skinOf();
  const skin = join(head, figure);
  const eye = withMeshNormals(scaled(leftEye()));
  const plain = (name: string, mesh: Mesh, ncz: boolean): Part => ({
    name,
    mesh,
    colour: rgb('#c9a58c'),
    roughness: 0.7,
    ncz,
  });
  const template = templateOf(skin);
  return {
    name: 'human-body',
    title: 'Human figure',
    parts: [
      plain('skin', skin, false),
      plain('l-eye', eye, true),
      plain('r-eye', reflected(eye), true),
      ...others().map(({ name, mesh }) => plain(name, withMeshNormals(scaled(mesh)), true)),
    ],
    cage: template.cage,
    template,
    inside: (p) => p[1] > kCut && closedSolid(...inHead(p)) < -0.012,
    paints: [],
  };
};
