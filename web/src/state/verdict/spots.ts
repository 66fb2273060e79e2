import type { Finding, FindingCode, Inspection } from 'cagecast';
import { Vector3 } from 'three';
import type { CageMaker } from '../cage-maker';
import type { Shown } from '../scene';
import type { Session } from '../session';
import { bareParts, plainNameOf } from './part-names';
import { type Remedy, remedyFor, topicOf, worthSaying } from './verdict';

/** A line of the list behind the verdict in Play. */
export interface Spot {
  text: string;
  /** The segments that it is about, if any. */
  segments: readonly number[];
  /** Whether it is about the face. */
  isOfFace: boolean;
  /** The one thing that helps, where there is one. */
  remedy: Remedy | undefined;
}

/** The facts for the list. */
interface Looked {
  session: Session;
  maker: CageMaker;
  /** Undefined while the cage was not inspected. */
  inspection: Inspection | undefined;
  /** Inspects it. */
  inspect(): void;
}

const kPlace = 'The paint does not lie well on the model';
const kTorn = 'The paint may be torn or doubled in places';

/** Findings for people who know nothing of cages. */
const kWords: Record<FindingCode, string> = {
  cageElsewhere: kPlace,
  cageBackward: 'The paint is on back to front',
  cageMisplaced: kPlace,
  cageTooSmall: kPlace,
  targetPokesOut: kPlace,
  cageTooFar: kPlace,
  targetTooLarge: kPlace,
  cageInsideTarget: kPlace,
  normalsInward: kPlace,
  degenerateTriangles: kTorn,
  doubledTriangles: kTorn,
  nonManifoldEdges: kTorn,
  cracks: kTorn,
  uvsOutside: kTorn,
  uvsWithoutArea: kTorn,
  uvsOverlap: kTorn,
  uvsInPieces: kTorn,
  uvsUnknown: 'The paint may be laid out for other UVs',
  nothingToPaint: 'Hardly anything is painted',
  faceBare: 'The face stays bare',
  eyesUnknown: 'Nothing tells where the eyes are',
  windowsUnknown: 'Nothing tells where the windows are',
  eyesPainted: 'The eyes are painted',
  faceSeam: 'A seam runs across the face',
  skinBare: 'A patch of skin stays bare',
  limbsBare: 'An arm or a leg stays bare',
  holeUnexplained: 'A spot stays bare without a reason',
  segmentInDoubt: 'in doubt',
  muchCulled: 'Much stays bare',
  muchHidden: 'Much lies behind other parts',
  piecesApart: 'The model is in loose pieces',
};

const kFace = /^(eyes|face)/;
/** Findings that another fit does not mend. */
const kOfModel = /^(eyes|windows|uvsUnknown|segmentInDoubt|much|piecesApart)/;

/** The spots to look at, the worst first, then the bare parts. */
export function spotsOf(looked: Looked): Spot[] {
  const { session, maker, inspection, inspect } = looked;
  const { shown, classification } = session;
  if (!shown || !classification) return [];
  const line = (text: string, remedy: Remedy): Spot => ({ text, segments: [], isOfFace: false, remedy });
  if (!inspection && maker.isOthers)
    return [line('Painted for another model', { title: 'Fit it to this one', run: () => void maker.make() })];
  const spots = new Map<unknown, Spot>();
  if (!inspection) spots.set('', line('Not looked at closely yet', { title: 'Look closer', run: inspect }));
  for (const finding of worthSaying(inspection?.findings ?? [])) {
    const { code, places = [] } = finding;
    const known = spots.get(topicOf(finding));
    spots.set(topicOf(finding), {
      text: code === 'segmentInDoubt' ? inDoubt(finding, shown) : kWords[code],
      segments: [...(known?.segments ?? []), ...places.map(({ segment }) => segment)],
      isOfFace: kFace.test(code),
      remedy: known?.remedy ?? helpFor(finding, inspection!, session, maker),
    });
  }
  return [...spots.values(), ...bareSpots(session, shown, classification.segmentStats)];
}

function inDoubt({ places = [], locks = {} }: Finding, { target }: Shown): string {
  const name = plainNameOf(target.mesh.primitives[places[0]!.group]!);
  return `${name}: ${Object.values(locks)[0] === 'keep' ? 'bare' : 'painted'}, but only just`;
}

function bareSpots(session: Session, shown: Shown, stats: Parameters<typeof bareParts>[1]): Spot[] {
  const { primitives } = shown.target.mesh;
  return bareParts(shown, stats).map((name) => {
    const segments = stats.flatMap(({ group, area, exposedArea, coveredArea, culled }, segment) => {
      const isBare = area > 0 && (culled || coveredArea < exposedArea / 2);
      return isBare && plainNameOf(primitives[group]!) === name ? [segment] : [];
    });
    const run = (): void => session.lock(segments, 'always');
    const remedy = segments.length > 0 ? { title: 'Paint anyway', run } : undefined;
    return { text: `${name}: bare`, segments, isOfFace: false, remedy };
  });
}

/** What helps with a finding. */
function helpFor(finding: Finding, of: Inspection, session: Session, maker: CageMaker): Remedy | undefined {
  const { code, locks, ignore } = finding;
  const chosen = Object.entries(locks ?? {});
  if (chosen.length > 0) {
    const [[, lock]] = chosen as [[string, 'keep' | 'exclude']];
    const segments = chosen.flatMap(([segment, other]) => (other === lock ? [Number(segment)] : []));
    const title = lock === 'keep' ? 'Paint anyway' : 'Keep it bare';
    return { title, run: () => session.lock(segments, lock) };
  }
  if (ignore || code === 'piecesApart') return remedyFor(finding, of, session, maker);
  const { markBare } = maker;
  if (markBare && code === 'windowsUnknown') return { title: 'Mark the windows', run: markBare };
  if (markBare && code.startsWith('eyes')) return { title: 'Mark the eyes', run: markBare };
  if (kOfModel.test(code)) return undefined;
  // A made cage would be made the same again. A template may know faces better.
  const run = !maker.isMade ? () => maker.make() : code.startsWith('face') ? () => maker.fitLikely() : undefined;
  return run && { title: 'Try another fit', run: () => void run() };
}

/** Where segments are, in the model's space, and from where most of them is seen. */
interface Whereabouts {
  /** Two corners of a box around them. */
  box: [Vector3, Vector3];
  /** As `frontOf`; undefined if they look to all sides. */
  front: number | undefined;
}

const kOneSided = 0.3; // share of the area: more of it looks to a side than away from it

/** Where segments are; undefined without any triangle. */
export function whereAre({ target, projection }: Shown, segments: readonly number[]): Whereabouts | undefined {
  const { indices, positions } = target.mesh;
  const box = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)] as const;
  const [a, b, c, normal] = [new Vector3(), new Vector3(), new Vector3(), new Vector3()];
  const sum = new Vector3();
  const wanted = new Set(segments);
  let area = 0;
  for (let t = 0; t < indices.length; t += 3) {
    if (!wanted.has(projection.segments[indices[t]!]!)) continue;
    [a, b, c].forEach((corner, i) => {
      corner.fromArray(positions, 3 * indices[t + i]!);
      box[0].min(corner);
      box[1].max(corner);
    });
    normal.crossVectors(b.sub(a), c.sub(a));
    sum.add(normal);
    area += normal.length();
  }
  if (area === 0) return undefined;
  const isOneSided = Math.hypot(sum.x, sum.z) > kOneSided * area;
  return { box: [...box], front: isOneSided ? Math.atan2(sum.x, sum.z) : undefined };
}
