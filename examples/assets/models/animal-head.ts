import { enlarged, makeCage } from '../cage.ts';
import type { Part } from '../glb.ts';
import { rgb } from '../image.ts';
import { bothSides, finderOn, inMiddle } from '../landmarks.ts';
import { type Mesh, point, reflected, symmetricSurface, withFieldNormals } from '../mesh.ts';
import type { Model } from '../model.ts';
import { ellipsoid, mirrored, roundCone, type Sdf, smoothSubtract, smoothUnion, sphere, tube } from '../sdf.ts';
import { eyeball } from '../shapes.ts';
import { namedHoles, symmetric, type Template } from '../template.ts';
import { boxAtlas, pelt } from '../unwrap.ts';
import { add, dot, frame, length, scale, sub, unit, type Vec3 } from '../vec.ts';

// One unit is about the length of the head. The snout points to +z, +y is up, the left is +x.
const kEye: Vec3 = [0.113, 0.083, 0.112];
const kLook: Vec3 = unit([0.6, 0.16, 0.78]);
const kEyeRadius = 0.043;
const kNoseTip: Vec3 = [0, -0.012, 0.475];
const kMouth = { y: -0.105, corner: 0.115 }; // height of the mouth, and z of its corners

// ---- the head without its openings ----

const skull = smoothUnion(
  0.1,
  ellipsoid([0, 0.07, -0.13], [0.205, 0.2, 0.24]),
  ellipsoid([0, 0.1, 0.02], [0.14, 0.125, 0.15]),
  ellipsoid([0.115, -0.045, -0.06], [0.095, 0.125, 0.15]),
);
const snout = smoothUnion(
  0.05,
  roundCone([0, -0.01, 0.06], [0, -0.048, 0.385], 0.125, 0.066),
  roundCone([0, 0.04, 0.1], [0, 0.0, 0.41], 0.06, 0.04),
  ellipsoid([0.038, -0.07, 0.365], [0.038, 0.045, 0.075]),
);
const jaw = smoothUnion(
  0.06,
  roundCone([0, -0.135, -0.06], [0, -0.135, 0.345], 0.08, 0.045),
  roundCone([0.09, -0.1, -0.06], [0.03, -0.13, 0.3], 0.06, 0.04),
);
const nose = ellipsoid([0, -0.008, 0.437], [0.042, 0.032, 0.036]);
const brow = tube([
  [0.05, 0.125, 0.135, 0.024],
  [0.1, 0.138, 0.1, 0.028],
  [0.15, 0.115, 0.04, 0.022],
]);
const lids = ellipsoid(kEye, [kEyeRadius + 0.013, kEyeRadius + 0.011, kEyeRadius + 0.011]);

const earAxes = frame(unit([0.28, 0.1, 1]), [0.2, 1, -0.12]); // outwards, up, to the front
const earAt = (u: number, v: number, w: number): Vec3 =>
  add([0.135, 0.2, -0.16], add(add(scale(earAxes[0], u), scale(earAxes[1], v)), scale(earAxes[2], w)));
const earCone: Sdf = smoothUnion(
  0.03,
  ellipsoid(earAt(0, 0.03, 0), [0.082, 0.11, 0.045], earAxes),
  ellipsoid(earAt(0.004, 0.11, -0.004), [0.058, 0.115, 0.03], earAxes),
  roundCone(earAt(0.004, 0.12, -0.004), earAt(0.008, 0.225, -0.008), 0.03, 0.012),
);
const ear = smoothSubtract(0.02, earCone, ellipsoid(earAt(0.002, 0.09, 0.04), [0.05, 0.12, 0.036], earAxes));

const kNeckFrom: Vec3 = [0, -0.06, -0.2];
const kNeckTo: Vec3 = [0, -0.3, -0.7];
const neckAxis = unit(sub(kNeckTo, kNeckFrom));
const neck = smoothUnion(
  0.1,
  roundCone(kNeckFrom, kNeckTo, 0.185, 0.215),
  ellipsoid([0, -0.16, -0.16], [0.1, 0.09, 0.14]),
);
const kNeckEnd = 0.36; // from kNeckFrom on

const shut = (ears: Sdf): Sdf => {
  const head = smoothUnion(0.07, smoothUnion(0.09, skull, neck), snout, jaw);
  return smoothUnion(0.03, smoothUnion(0.025, smoothUnion(0.04, head, brow), lids, nose), ears);
};

// ---- openings ----

const lookAxes = frame(kLook);
/** Between the lids: an almond drawn out to the front. */
const lidOpening =
  (grow: number): Sdf =>
  (x, y, z) => {
    const p = sub([x, y, z], kEye);
    const [u, v, w] = lookAxes.map((a) => dot(p, a)) as [number, number, number];
    return Math.max((Math.hypot(u / (0.04 + grow), (v - 0.15 * u) / (0.0265 + grow)) - 1) * 0.027, 0.008 - w);
  };
/** Between the lips: a wedge that opens to the front. */
const lipGap =
  (grow: number): Sdf =>
  (_x, y, z) =>
    Math.max(
      Math.abs(y - kMouth.y + 0.02 * (z - kMouth.corner)) - 0.003 - 0.05 * (z - kMouth.corner) - grow,
      kMouth.corner - grow - z,
    );
const cavity = ellipsoid([0, -0.108, 0.22], [0.062, 0.042, 0.16]);
const nostril = roundCone([0.022, -0.006, 0.48], [0.016, 0.0, 0.44], 0.011, 0.008);

const kFold = 0.01;
const closedSolid: Sdf = mirrored(shut(ear), kFold);
const cagedSolid: Sdf = mirrored(shut(earCone), kFold);
const skinSolid: Sdf = mirrored(
  smoothSubtract(
    0.006,
    smoothSubtract(0.012, shut(ear), lipGap(0), cavity, nostril),
    sphere(kEye, kEyeRadius + 0.002),
    lidOpening(0),
  ),
  kFold,
);
const tongueSolid: Sdf = mirrored(ellipsoid([0, -0.118, 0.235], [0.046, 0.018, 0.13]), 0.004);
const onNeck = (p: Vec3): number => kNeckEnd - dot(sub(p, kNeckFrom), neckAxis);

/** Enlarges eyes, nose and ears, so that they keep more of their triangles. */
const focus = (p: Vec3): Vec3 =>
  enlarged(p, [
    [kEye, 0.1, 1.2],
    [kNoseTip, 0.13, 0.8],
    [earAt(0, 0.12, 0), 0.16, 0.3],
  ]);

const templateOf = (skin: Mesh): Template => {
  const cage = symmetric(
    pelt(
      makeCage({
        solid: cagedSolid,
        bounds: { min: [-0.06, -0.68, -0.75], max: [0.45, 0.58, 0.62] },
        edge: 0.026,
        distance: 0.03,
        triangles: 700,
        focus,
        wrap: skin,
        seen: (v) => Math.abs(closedSolid(...point(skin, v))) < 0.006,
        keep: (p) => Math.min(onNeck(p) + 0.02, lidOpening(0.005)(...p), lipGap(0.006)(...p)),
      }),
      (a, b) => a[0] === 0 && b[0] === 0 && (a[1] + b[1]) / 2 < -0.17,
      (p) => 1 + 0.8 * Math.exp(-((length(sub(p, [0, 0, 0.3])) / 0.3) ** 2)),
      true,
    ),
  );
  const { near, from, furthest } = finderOn(skin);
  const corner = (side: 1 | -1): Vec3 =>
    near(add(kEye, add(scale(lookAxes[0], side * 0.04), scale(lookAxes[2], 0.02))));
  const landmarks = {
    ...inMiddle({
      nose_tip: furthest([0, 0, 1], kNoseTip, 0.06),
      nasion: from([0, 1, 0.6], [0, 0.06, 0.17]),
      forehead: from([0, 1, 1], [0, 0.18, 0.07]),
      crown: from([0, 1, 0], [0, 0, -0.13]),
      nape: from([0, 0.9, -0.44], add(kNeckFrom, scale(neckAxis, 0.2))),
      lip_upper: from([0, 0, 1], [0, kMouth.y + 0.045, 0]),
      lip_lower: from([0, 0, 1], [0, kMouth.y - 0.042, 0]),
      chin: from([0, -0.7, 0.7], [0, -0.15, 0.35]),
      throat: from([0, -1, 0], [0, 0, -0.12]),
    }),
    ...bothSides({
      eye_centre: kEye,
      eye_inner: corner(lookAxes[0][0] > 0 ? -1 : 1),
      eye_outer: corner(lookAxes[0][0] > 0 ? 1 : -1),
      mouth_corner: from([1, 0, 0], [0, kMouth.y, kMouth.corner]),
      cheek: from([1, 0, 0], [0, -0.05, -0.06]),
      ear_top: furthest([0, 1, 0], earAt(0, 0.2, 0), 0.1),
      ear_outer: furthest([1, 0, 0], earAt(0.05, 0.05, 0), 0.08),
      ear_base_front: near(earAt(-0.03, -0.01, 0.06)),
    }),
  };
  const holes = namedHoles(cage, {
    ...bothSides({ eye: add(kEye, scale(kLook, kEyeRadius)) }),
    mouth: [0, kMouth.y, 0.35],
    neck: add(kNeckFrom, scale(neckAxis, kNeckEnd)),
  });
  return { name: 'animal-head', kind: 'head', cage, landmarks, holes, skin };
};

/** The head of no animal in particular, with a snout and upright ears: the model of a template, no sample itself. */
export const animalHead = (): Model => {
  const bounds = { min: [-0.03, -0.62, -0.7] as Vec3, max: [0.4, 0.55, 0.55] as Vec3 };
  const skin = withFieldNormals(
    symmetricSurface(skinSolid, { bounds, edge: 0.0125, triangles: 7000, keep: onNeck }),
    skinSolid,
  );
  const tongue = withFieldNormals(
    symmetricSurface(tongueSolid, {
      bounds: { min: [-0.02, -0.16, 0.05], max: [0.07, -0.07, 0.4] },
      edge: 0.012,
      triangles: 200,
    }),
    tongueSolid,
  );
  const eye = eyeball(kEye, kEyeRadius, kLook, 8, 14);
  const part = (name: string, mesh: Mesh, colour: string, ncz: boolean): Part => ({
    name,
    mesh: mesh.uvs ? mesh : boxAtlas(mesh),
    colour: rgb(colour),
    roughness: 0.7,
    ncz,
  });
  const template = templateOf(skin);
  return {
    name: 'animal-head',
    title: "Animal's head",
    parts: [
      { ...part('skin', skin, '#b08a62', false), doubleSided: true },
      part('l-eye', eye, '#2a1c12', true),
      part('r-eye', reflected(eye), '#2a1c12', true),
      part('tongue', tongue, '#c0616a', true),
    ],
    cage: template.cage,
    template,
    inside: (p) => closedSolid(...p) < -0.012,
    paints: [],
  };
};
