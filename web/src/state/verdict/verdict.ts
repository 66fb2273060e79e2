import type { Finding, Inspection, SegmentStats } from 'cagecast';
import { verdictOf } from '#inspect';
import type { CageMaker } from '../cage-maker';
import { leavingOut } from '../left-out';
import { madeOf } from '../made-cages';
import type { Scene } from '../scene';
import type { Session } from '../session';

/** Whether the cage fits; empty until it was inspected. */
export type KnownVerdict = Inspection['verdict'] | '';

/** How many triangles of model and cage are inspected without being asked: a second of a worker's time. */
export const kMaxInspected = 120_000;

/** The share of the visible surface that can be painted, 0..1; with an open cage over a region, the share of the region. */
export function paintableShare(
  parts: readonly { exposedArea: number; coveredArea: number; culled: boolean }[],
): number {
  let [visible, paintable] = [0, 0];
  for (const { exposedArea, coveredArea, culled } of parts) {
    visible += exposedArea;
    if (!culled) paintable += coveredArea;
  }
  return visible > 0 ? Math.min(1, paintable / visible) : 0;
}

/** Words in names that tell which region of a model a cage covers. */
const kRegions = ['head', 'face', 'hand', 'hands', 'arm', 'arms', 'leg', 'legs', 'foot', 'feet', 'torso'];

/**
 * The region of a model that an open cage covers, for people; undefined if it is meant for the whole model.
 * @param segmentStats Of the target.
 */
export function regionOf({ target, cage }: Pick<Scene, 'target' | 'cage'>, segmentStats: Stats): string | undefined {
  if (!segmentStats.some(({ beyondArea }) => beyondArea > 0)) return undefined;
  const [most] = segmentStats.toSorted((a, b) => b.coveredArea - a.coveredArea);
  const { primitives } = cage.mesh;
  const names = [...primitives.map(({ name }) => name), madeOf(cage.files[0]!)?.fitting?.template ?? '', cage.name];
  // A part most of which lies beyond does not tell by its name what the cage is meant for.
  if (most!.beyondArea < most!.area / 2) names.unshift(target.mesh.primitives[most!.group]!.name);
  const word = names.flatMap(wordsOf).find((word) => kRegions.includes(word));
  return word ? `the ${word}` : 'a part';
}

type Stats = readonly Pick<SegmentStats, 'area' | 'beyondArea' | 'coveredArea' | 'group'>[];

const wordsOf = (name: string): string[] =>
  name
    .replace(/([a-z])([A-Z])/g, '$1 $2')
    .toLowerCase()
    .match(/[a-z]+/g) ?? [];

/** Something that can be done with one click. */
export interface Remedy {
  title: string;
  run(): void;
}

/** Findings that moving, turning, scaling and bending the cage may mend. */
const kMovable: readonly Finding['code'][] = [
  'cageElsewhere',
  'cageMisplaced',
  'cageTooSmall',
  'cageTooFar',
  'targetPokesOut',
  'cageInsideTarget',
];

/** Findings about a made cage that a template has not, or asks about. */
const kFittable: readonly Finding['code'][] = ['faceSeam', 'eyesUnknown'];

/** What can be done about a finding. */
export function remedyFor(
  { code, ignore, numbers }: Finding,
  { inward }: Pick<Inspection, 'inward'>,
  session: Session,
  maker: CageMaker,
): Remedy | undefined {
  // A cage that was moved in vain would be moved in vain again.
  if (kMovable.includes(code) && !maker.refusedToMove && !maker.isFresh)
    return { title: 'Move the cage', run: () => maker.move() };
  if (kFittable.includes(code) && maker.isMade) return { title: 'Fit a template', run: () => maker.fitLikely() };
  if (code === 'normalsInward') return { title: 'Turn its triangles', run: () => maker.flip(inward.triangles) };
  if (code === 'piecesApart')
    return { title: 'Join pieces', run: () => session.setRules({ weldTolerance: numbers['weldTolerance'] as number }) };
  return ignore && { title: `Leave out “${ignore.join('”, “')}”`, run: () => leaveOut(session, ignore) };
}

/** Leaves out the parts of these names. */
function leaveOut(session: Session, names: readonly string[]): void {
  const { target, projection } = session.shown!;
  const segments = projection.segmentStats.flatMap(({ group, area }, segment) =>
    area > 0 && names.includes(target.mesh.primitives[group]!.name) ? [segment] : [],
  );
  session.lock(segments, 'out');
}

/** Takes back each of the parts that are left out. */
export function takeBacks(session: Session): Remedy[] {
  const { target, projection } = session.shown!;
  const { leftOut, segmentStats } = projection;
  return leftOut.map((group) => {
    const others = leftOut.filter((other) => other !== group);
    return {
      title: `Take back “${target.mesh.primitives[group]!.name}”`,
      run: () => session.setLocks(leavingOut(session.locks, others, segmentStats)),
    };
  });
}

/** Findings of some weight: the others are remarks. */
export const worthSaying = (findings: readonly Finding[]): Finding[] =>
  findings.filter((finding) => verdictOf([finding]) !== 'good');

/** Play has one line for all findings of a badly placed cage, one for all of a bad surface, and one for each other finding. */
export const topicOf = (finding: Finding): string | Finding =>
  /^(cage(?!Back)|target|normals)/.test(finding.code)
    ? 'place'
    : /^(uvs(?!Unknown)|degenerate|doubled|nonManifold|cracks)/.test(finding.code)
      ? 'surface'
      : finding;

/** What there is to say of a painted model. */
interface Seen {
  /** The region that its cage covers, if not all of it. */
  region: string | undefined;
  /** The plain names of the parts that stay bare. */
  bare: readonly string[];
  /** How many things there are to look at. */
  findings: number;
  /** Whether its cage is another model's. */
  isForeign: boolean;
}

const kMaxNames = 4; // of bare parts

/** A verdict in plain words: one line. */
export function verdictWords(verdict: KnownVerdict, { region, bare, findings, isForeign }: Seen): string {
  if (verdict === 'unfit') return 'Does not look right';
  if (verdict === '' && isForeign) return 'Painted for another model';
  if (verdict === 'usable') return `Looks off? ${findings} ${findings === 1 ? 'spot' : 'spots'}`;
  const more = bare.length > kMaxNames ? [`${bare.length - kMaxNames + 1} more`] : [];
  const names = [...bare.slice(0, kMaxNames - more.length), ...more].join(', ');
  return `Painted${region ? `: ${region}` : ''}${names && ` · ${names} bare`}`;
}
