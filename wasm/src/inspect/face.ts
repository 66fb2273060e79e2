import { type Finding, percent } from './finding.js';
import { cross, dot, doubleAreaNormal, minus, pointAt, type Vector } from './geometry.js';
import { partsOf, type Scene } from './scene.js';

/** Named spots of a target, x, y and z. */
export type Spots = Readonly<Record<string, readonly [x: number, y: number, z: number]>>;

/** How far a face reaches from the middle between its eyes: to the sides, up, down and back; in distances of the eyes. As in C++. */
const kAside = 1.3;
const kUp = 0.9;
const kDown = 1.7;
const kBack = 0.9;
/** The share of a face's skin from which on its bareness is a finding: more than brows and lids. */
const kBare = 0.25;

/** Both eyes, how far they are apart, and axes to the face's left, up and forward; forward is level. */
export interface FaceFrame {
  left: Vector;
  right: Vector;
  size: number;
  across: Vector;
  up: Vector;
  front: Vector;
}

/** The frame of a face; undefined without the centres of both eyes. */
export function faceFrameOf({ eye_centre_left: left, eye_centre_right: right }: Spots): FaceFrame | undefined {
  if (!left || !right) return undefined;
  const apart = minus(left, right);
  const size = Math.hypot(...apart);
  const across: Vector = [apart[0] / size, apart[1] / size, apart[2] / size];
  const front: Vector = [-across[2], 0, across[0]];
  return { left, right, size, across, up: cross(front, across), front };
}

/**
 * Reports a face that stays bare: of the segment that most of the face is of, what faces the front and is not hidden.
 * @param landmarks  Of the target. Without both `eye_centre_*` nothing is known of its face.
 */
export function checkFace({ target, areas, result, parts, isInRegion }: Scene, landmarks: Spots = {}): Finding[] {
  const frame = faceFrameOf(landmarks);
  if (!frame) return [];
  const { left, right, size, across, front } = frame;
  const isOfFace = (v: number) => {
    const d = minus(pointAt(target.positions, v), right);
    const up = (d[1] - (left[1] - right[1]) / 2) / size;
    const [aside, forward] = [dot(d, across) / size - 0.5, dot(d, front) / size];
    return Math.abs(aside) < kAside && up < kUp && up > -kDown && forward > -kBack;
  };
  const facing = new Uint8Array(areas.length);
  const { indices, positions } = target;
  for (let i = 0; i < indices.length; i += 3) {
    const corners = [indices[i]!, indices[i + 1]!, indices[i + 2]!] as const;
    const [a, b, c] = corners.map((v) => pointAt(positions, v)) as [Vector, Vector, Vector];
    if (dot(doubleAreaNormal(a, b, c), front) > 0) for (const v of corners) facing[v] = 1;
  }
  /** By segment: the area of the face in view, and its bare share. */
  const seen = new Map<number, { all: number; bare: number; first: number }>();
  for (let v = 0; v < areas.length; ++v) {
    const zone = result.zones[v]!;
    if (!facing[v] || zone === 1 || !isOfFace(v) || !isInRegion(v)) continue;
    const of = seen.get(result.segments[v]!) ?? { all: 0, bare: 0, first: v };
    of.all += areas[v]!;
    if (zone !== 0) of.bare += areas[v]!;
    seen.set(result.segments[v]!, of);
  }
  const [most] = [...seen].sort(([, a], [, b]) => b.all - a.all);
  const share = most && most[1].all > 0 ? most[1].bare / most[1].all : 0;
  if (!most || share < kBare) return [];
  const [segment, { first }] = most;
  const part = parts[partsOf(parts, areas.length)[first]!]?.name ?? '';
  return [
    {
      code: 'faceBare',
      weight: 1 + share,
      sentence: `The face is left bare: ${percent(share)} of what is seen of "${part}" there`,
      advice: 'Close the holes of the cage over it, or make a cage for this model.',
      numbers: { share },
      places: [{ segment, group: target.groups?.[first] ?? 0, part }],
      ...(result.segmentStats[segment]?.culled && { locks: { [segment]: 'keep' as const } }),
    },
  ];
}
