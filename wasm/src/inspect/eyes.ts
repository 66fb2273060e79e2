import { faceFrameOf, type Spots } from './face.js';
import type { Finding } from './finding.js';
import { dot, minus, pointAt, type Vector } from './geometry.js';
import { partsOf, type Scene } from './scene.js';
import { placeOfSegment, type Segment } from './segments.js';

/** Where an eye is looked at beside its centre, in distances of the eyes: within an iris. */
const kIris = 0.06;
/** The share of these spots from which on an eye counts as painted. */
const kPainted = 0.5;
/** A segment of less area, in squares of the distance of the eyes, is an eye or a part of one, and no skin. */
const kEyeArea = 2;
/** Landmarks that only figures and heads have. */
const kOfFigures = ['joint_head', 'nose_tip', 'chin'];

/**
 * Reports eyes of which nothing tells where they are, and eyes that are painted.
 * @param landmarks  Of the target. Without any of a figure nothing is reported.
 */
export function checkEyes(scene: Scene, segments: readonly Segment[], landmarks: Spots = {}): Finding[] {
  const frame = faceFrameOf(landmarks);
  if (!frame) return kOfFigures.some((name) => landmarks[name]) ? [kUnknown] : [];
  const { target, result, parts, areas } = scene;
  const { left, right, size } = frame;
  const spots = [-1, 0, 1].flatMap((x) => [-1, 0, 1].map((y) => [x * kIris * size, y * kIris * size] as const));
  const axes = [frame.across, frame.up, frame.front] as const;
  const seen = [left, right].map((eye) => firstTriangles(target, eye, axes, spots));
  const painted = seen.map((all) => all.filter((t) => result.cosmeticTriangles[t] === 1));
  const shares = seen.map((all, e) => painted[e]!.length / (all.length || 1));
  if (Math.max(...shares) < kPainted) return [];
  const vertices = painted.flat().map((t) => target.indices[3 * t]!);
  const own = [...new Set(vertices.map((v) => result.segments[v]!))];
  const part = parts[partsOf(parts, areas.length)[vertices[0]!]!]?.name ?? '';
  const isSmall = own.every((s) => segments[s]!.area < kEyeArea * size ** 2);
  return [
    {
      code: 'eyesPainted',
      weight: 0.3,
      sentence: `Where the eyes are, "${part}" is painted`,
      advice: isSmall
        ? 'If they are not closed, keep them bare.'
        : 'If they are not closed, give them a part of their own, or correct the landmarks eye_centre_left and eye_centre_right.',
      numbers: { left: shares[0]!, right: shares[1]! },
      places: own.map((s) => placeOfSegment(s, segments[s]!)),
      ...(isSmall && { locks: Object.fromEntries(own.map((s) => [s, 'exclude' as const])) }),
    },
  ];
}

const kUnknown: Finding = {
  code: 'eyesUnknown',
  weight: 0.3,
  sentence: 'Nothing tells where the eyes are: no name, no morph target, no joint and no colour',
  advice:
    'Fit a template with the landmarks eye_centre_left and eye_centre_right, or give the eyes a part of their own.',
  numbers: {},
};

/** The triangles that are seen first from the front at spots around a middle, in a plane of axes across and up. */
function firstTriangles(
  { positions, indices }: Scene['target'],
  middle: Vector,
  axes: readonly [across: Vector, up: Vector, front: Vector],
  spots: readonly (readonly [x: number, y: number])[],
): number[] {
  const nearest = spots.map(() => ({ depth: -Infinity, triangle: -1 }));
  const flat = (v: number) => axes.map((axis) => dot(minus(pointAt(positions, v), middle), axis)) as unknown as Vector;
  const reach = Math.max(...spots.flat().map(Math.abs));
  for (let t = 0; 3 * t < indices.length; ++t) {
    const [a, b, c] = [0, 1, 2].map((k) => flat(indices[3 * t + k]!)) as [Vector, Vector, Vector];
    const isAside = (k: 0 | 1) => Math.min(a[k], b[k], c[k]) > reach || Math.max(a[k], b[k], c[k]) < -reach;
    if (isAside(0) || isAside(1)) continue;
    const whole = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    spots.forEach(([x, y], i) => {
      const [u, v, w] = [
        ((b[0] - x) * (c[1] - y) - (c[0] - x) * (b[1] - y)) / whole,
        ((c[0] - x) * (a[1] - y) - (a[0] - x) * (c[1] - y)) / whole,
        ((a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y)) / whole,
      ];
      const depth = u * a[2] + v * b[2] + w * c[2];
      if (Math.min(u, v, w) >= 0 && depth > nearest[i]!.depth) nearest[i] = { depth, triangle: t };
    });
  }
  return nearest.flatMap(({ triangle }) => (triangle < 0 ? [] : triangle));
}
