import { type FaceFrame, faceFrameOf, type Spots } from './face.js';
import { type Finding, percent } from './finding.js';
import { firstSeen } from './first-seen.js';
import { between, dot, minus, type Vector } from './geometry.js';
import type { Scene } from './scene.js';
import { placeOfSegment, type Segment } from './segments.js';

// Lengths are in distances of the eyes, across and up from the middle between them.

/** How far a face reaches to the sides and up; down, where no chin is known. */
const kAside = 0.9;
const kUp = 1.3;
const kDown = 1.4;
/** How far a neck is looked at, to the sides and below the chin; and how large the spot of the chest is, below all. */
const kNeckAside = 1.6;
const kNeckDown = 1.6;
const kChest = [0.5, 0.2] as const;
/** How far around an eye and the mouth bare skin is no patch. */
const kEye = 0.4;
const kMouth = [0.6, 0.35] as const;
/** The mouth, where no landmark says where it is. */
const kUsualMouth = [0, -1.1];
/** The cells of a picture along a side. */
const kCells = 64;
/** The share of a picture from which on bare patches are a finding. */
const kPatch = 0.003;

/** A cell of a picture: its place, and the segment that is seen first there. */
interface Cell {
  x: number;
  y: number;
  segment: number;
  isPainted: boolean;
}

/**
 * Reports patches that stay bare, in pictures from the front: of the face's skin, away from eyes and mouth; and below the chin, if the
 * chest is painted.
 * @param landmarks  Of the target. Without both `eye_centre_*` nothing is known of its face.
 */
export function checkPatches(scene: Scene, segments: readonly Segment[], landmarks: Spots = {}): Finding[] {
  const frame = faceFrameOf(landmarks);
  if (!frame) return [];
  const middle = between(frame.left, frame.right, 0.5);
  const { size, across, up } = frame;
  /** The middle of landmarks; undefined if none is known. */
  const placeOf = (...names: string[]) => {
    const known = names.flatMap((name) => (landmarks[name] ? [minus(landmarks[name] as Vector, middle)] : []));
    const mean = (axis: Vector) => known.reduce((sum, d) => sum + dot(d, axis), 0) / known.length / size;
    return known.length > 0 ? [mean(across), mean(up)] : undefined;
  };
  const [mouthX, mouthY] = placeOf('lip_upper', 'lip_lower') ?? kUsualMouth;
  const chin = placeOf('chin', 'menton')?.[1] ?? -kDown;
  const isSkin = ({ x, y }: Cell) =>
    Math.hypot(Math.abs(x) - 0.5, y) > kEye && Math.hypot((x - mouthX!) / kMouth[0], (y - mouthY!) / kMouth[1]) > 1;
  const face = pictureOf(scene, frame, [kAside, chin, kUp]).filter(isSkin);
  const skin = mostOf(face.filter(({ isPainted }) => isPainted));
  const ofSkin = face.filter(({ segment }) => segment === skin);

  const neck = pictureOf(scene, frame, [kNeckAside, chin - kNeckDown, chin]);
  const isChest = ({ x, y }: Cell) => Math.abs(x) < kChest[0] && y < chin - kNeckDown + kChest[1];
  // The cage of a head ends at the neck; hair and what else was left out by choice is to stay bare.
  const around = bareShare(neck.filter(isChest)) < 0.5 ? neck : [];
  const open = around.filter(({ segment }) => segments[segment]!.culledBy !== 'lock');
  return [
    ...findingOf(ofSkin, segments, 'Patches of the face are left bare, away from eyes and mouth'),
    ...findingOf(open, segments, 'Patches below the chin are left bare, though the chest is painted'),
  ];
}

/** The picture of a part of a target from the front. @param reach  To the sides, and from low to high. */
function pictureOf(
  { target, result }: Scene,
  { left, right, size, across, up, front }: FaceFrame,
  [aside, low, high]: readonly [aside: number, low: number, high: number],
): Cell[] {
  const first = firstSeen(target, {
    middle: between(left, right, 0.5),
    axes: [across, up, front],
    low: [-aside * size, low * size],
    high: [aside * size, high * size],
    cells: kCells,
  });
  return [...first].flatMap((t, cell) => {
    if (t < 0) return [];
    const [column, row] = [((cell % kCells) + 0.5) / kCells, (Math.floor(cell / kCells) + 0.5) / kCells];
    return {
      ...{ x: aside * (2 * column - 1), y: low + row * (high - low) },
      segment: result.segments[target.indices[3 * t]!]!,
      isPainted: result.cosmeticTriangles[t] === 1,
    };
  });
}

/** The segment that most cells show. */
function mostOf(cells: readonly Cell[]): number | undefined {
  const counts = new Map<number, number>();
  for (const { segment } of cells) counts.set(segment, (counts.get(segment) ?? 0) + 1);
  return [...counts].sort(([, a], [, b]) => b - a)[0]?.[0];
}

const bareShare = (cells: readonly Cell[]): number =>
  cells.length > 0 ? cells.filter(({ isPainted }) => !isPainted).length / cells.length : 1;

function findingOf(cells: readonly Cell[], segments: readonly Segment[], what: string): Finding[] {
  const segment = mostOf(cells.filter(({ isPainted }) => !isPainted));
  const share = bareShare(cells);
  if (segment === undefined || share < kPatch) return [];
  const place = placeOfSegment(segment, segments[segment]!);
  return [
    {
      code: 'skinBare',
      weight: Math.min(0.9, 0.3 + share),
      sentence: `${what}: ${percent(share)} of what is seen there, most of "${place.part}"`,
      advice: 'Close the holes of the cage there, or leave out what hides it.',
      numbers: { share },
      places: [place],
    },
  ];
}
