import type { Spots } from './face.js';
import type { Finding } from './finding.js';
import { between, length, minus, pointAt, type Vector } from './geometry.js';
import type { Scene } from './scene.js';
import { placeOfSegment, type Segment } from './segments.js';

/** A hand or ear is bare if less than this share of it is painted, and more than that of what is around it. */
const kPainted = 0.25;
const kAround = 0.5;
/** From a wrist to the middle of the hand, and the radius of a ball around it; in lengths of the forearm. */
const kHand = 0.45;
/** The radius of a ball around an ear, and of one for what is around it; in heights of the ear. */
const kEar = 0.6;
const kBesideEar = 1.5;

/** A limb, and what is around it, as balls. */
interface Limb {
  name: string;
  itself: Ball;
  around: Ball;
}
interface Ball {
  middle: Vector;
  radius: number;
}

/**
 * Reports hands and ears that stay bare although what is around them is painted.
 * @param landmarks  Of the target. Hands are known by `joint_elbow_*` and `joint_wrist_*`, ears by their tops and lobes.
 */
export function checkLimbs(scene: Scene, segments: readonly Segment[], landmarks: Spots = {}): Finding[] {
  const limbs = ['left', 'right'].flatMap((side) => [...handOf(landmarks, side), ...earOf(landmarks, side)]);
  const bare = limbs.flatMap(({ name, itself, around }) => {
    const { painted, segment } = paintIn(scene, segments, itself);
    const isBare = segment !== undefined && painted < kPainted;
    return isBare && paintIn(scene, segments, around).painted > kAround ? [{ name, segment }] : [];
  });
  if (bare.length === 0) return [];
  const places = [...new Set(bare.map(({ segment }) => segment))].map((s) => placeOfSegment(s, segments[s]!));
  return [
    {
      code: 'limbsBare',
      weight: 0.3,
      sentence: `Bare beside what is painted: ${bare.map(({ name }) => name).join(', ')}`,
      advice: 'If it should be painted, override this, or extend the cage over it.',
      numbers: { limbs: bare.length },
      places,
      locks: Object.fromEntries(
        places.filter(({ segment }) => segments[segment]!.culled).map(({ segment }) => [segment, 'keep' as const]),
      ),
    },
  ];
}

function handOf(landmarks: Spots, side: string): Limb[] {
  const [elbow, wrist] = [landmarks[`joint_elbow_${side}`], landmarks[`joint_wrist_${side}`]];
  if (!elbow || !wrist) return [];
  const at = (share: number): Ball => ({
    middle: between(elbow as Vector, wrist as Vector, 1 + share),
    radius: kHand * length(minus(wrist as Vector, elbow as Vector)),
  });
  return [{ name: `${side} hand`, itself: at(kHand), around: at(-kHand) }];
}

function earOf(landmarks: Spots, side: string): Limb[] {
  const [top, lobe] = [landmarks[`ear_top_${side}`], landmarks[`ear_lobe_${side}`]];
  if (!top || !lobe) return [];
  const height = length(minus(top as Vector, lobe as Vector));
  const middle = between(top as Vector, lobe as Vector, 0.5);
  const at = (radius: number): Ball => ({ middle, radius: radius * height });
  return [{ name: `${side} ear`, itself: at(kEar), around: at(kBesideEar) }];
}

/** The painted share of what is seen in a ball, and the segment that has most there, without what is bare by choice. */
function paintIn({ target, areas, result }: Scene, segments: readonly Segment[], { middle, radius }: Ball) {
  const bySegment = new Map<number, number>();
  let [painted, all] = [0, 0];
  for (let v = 0; v < areas.length; ++v) {
    const [zone, segment] = [result.zones[v]!, result.segments[v]!];
    if (zone === 1 || segments[segment]!.culledBy === 'lock') continue;
    if (length(minus(pointAt(target.positions, v), middle)) > radius) continue;
    all += areas[v]!;
    if (zone === 0) painted += areas[v]!;
    bySegment.set(segment, (bySegment.get(segment) ?? 0) + areas[v]!);
  }
  const [most] = [...bySegment].sort(([, a], [, b]) => b - a);
  return { painted: all > 0 ? painted / all : 0, segment: most?.[0] };
}
