import type { Mesh } from '../api/index.js';
import { faceFrameOf, type Spots } from './face.js';
import type { Finding } from './finding.js';
import { firstSeen } from './first-seen.js';
import { partsOf, type Scene } from './scene.js';
import { placeOfSegment, type Segment } from './segments.js';

/** Where an eye is looked at beside its centre, in distances of the eyes: within an iris. */
const kIris = 0.06;
/** The share of these spots from which on an eye counts as painted. */
const kPainted = 0.5;
/** A part of less area, in squares of the distance of the eyes, is an eye or both, and no skin. */
const kEyeArea = 4;
/** Landmarks that only figures and heads have. */
const kOfFigures = ['joint_head', 'nose_tip', 'chin'];

/** Words in names of parts: of wheels, and of what is looked through. */
const kWheel = /(?<![a-z])(wheel|tyre|tire)/i;
const kWindow = /window|windscreen|windshield|glass/i;
/** Bicycles and carts have fewer wheels, and no windows. */
const kMinWheels = 4;

/**
 * Reports eyes of which nothing tells where they are, and eyes that are painted.
 * @param landmarks  Of the target. Without any of a figure nothing is reported.
 */
export function checkEyes(scene: Scene, segments: readonly Segment[], landmarks: Spots = {}): Finding[] {
  const frame = faceFrameOf(landmarks);
  if (!frame) return kOfFigures.some((name) => landmarks[name]) ? [kUnknown] : [];
  const { target, result, parts, areas } = scene;
  const { left, right, size } = frame;
  const reach = 1.5 * kIris * size;
  const grid = {
    axes: [frame.across, frame.up, frame.front] as const,
    low: [-reach, -reach],
    high: [reach, reach],
  } as const;
  const seen = [left, right].map((middle) =>
    firstSeen(target, { ...grid, middle, cells: 3 }).filter((triangle) => triangle >= 0),
  );
  const painted = seen.map((all) => all.filter((t) => result.cosmeticTriangles[t] === 1));
  const shares = seen.map((all, e) => painted[e]!.length / (all.length || 1));
  if (Math.max(...shares) < kPainted) return [];
  const vertices = painted.flatMap((all) => [...all]).map((t) => target.indices[3 * t]!);
  const own = [...new Set(vertices.map((v) => result.segments[v]!))];
  const part = parts[partsOf(parts, areas.length)[vertices[0]!]!]?.name ?? '';
  const groups = own.map((s) => segments[s]!.group);
  const ofThem = segments.reduce((sum, { group, area }) => (groups.includes(group) ? sum + area : sum), 0);
  const isSmall = ofThem < kEyeArea * size ** 2;
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

/** Reports a car of which no part is called a window: its windows are painted then. */
export function checkWindows({ groups, names = [] }: Mesh): Finding[] {
  const used = new Set(groups ?? [0]); // others have no vertices
  const parts = [...names.entries()].filter(([group]) => used.has(group)).map(([, own]) => [own].flat());
  const count = (word: RegExp): number => parts.filter((own) => own.some((name) => word.test(name))).length;
  const wheels = count(kWheel);
  if (wheels < kMinWheels || count(kWindow) > 0) return [];
  return [
    {
      code: 'windowsUnknown',
      weight: 0.3,
      sentence: `Nothing tells where the windows are: ${wheels} parts are called wheels, and none a window`,
      advice: 'If it has windows, give them a part of their own, or mark their triangles, to keep them bare.',
      numbers: { wheels },
    },
  ];
}
