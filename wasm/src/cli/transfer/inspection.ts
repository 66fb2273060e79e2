import { landmarksIn } from '../../gltf/read-model.js';
import { percent } from '../../inspect/finding.js';
import { vertexAreas } from '../../inspect/geometry.js';
import {
  type Finding,
  type Hole,
  type Inspection,
  inspect,
  type Segment,
  type Verdict,
  verdictOf,
} from '../../inspect/index.js';
import type { Sources } from '../model/sources.js';
import { integer, short } from '../model/text.js';
import { boundsAround, type UvBounds } from '../model/uv-bounds.js';
import type { PerZone } from '../model/zones.js';
import { withinBounds } from './cage-area.js';
import {
  type CageReport,
  cageReport,
  effectiveOptions,
  perZone,
  type TargetReport,
  targetReport,
  versions,
} from './report-parts.js';
import type { Run } from './run-transfer.js';

/** The JSON output of `inspect`: the inspection, and its inputs. */
export interface InspectionReport extends Inspection {
  versions: ReturnType<typeof versions>;
  target: TargetReport & { points: number };
  cage: CageReport;
  options: ReturnType<typeof effectiveOptions>;
  /** Vertices of the target in each zone. */
  counts: PerZone;
  /** Share of the target's area in each zone. */
  coverage: PerZone;
}

/** Inspects the cage of a run. @param textures  Where its UVs have textures, besides 0..1. */
export function inspectionReport(
  command: Omit<Sources, 'reading'>,
  run: Run,
  textures: readonly UvBounds[],
): InspectionReport {
  const { target, wholeCage, options, result } = run;
  const cage = withinBounds(wholeCage, textures.length > 0 ? boundsAround(textures) : undefined);
  const { mesh } = target.extracted;
  const areas = perZone(result.zones, vertexAreas(mesh));
  const total = areas.cosmetic + areas.occluded + areas.uncovered + areas.culled || 1;
  return {
    ...inspect(cage.extracted.mesh, mesh, { ...options, result, landmarks: landmarksIn(cage) }),
    versions: versions(),
    target: {
      ...targetReport(command.target, run),
      points: result.segmentStats.reduce((sum, { points }) => sum + points, 0),
    },
    cage: cageReport(command.cage, cage, run),
    options: effectiveOptions(command),
    counts: perZone(result.zones),
    coverage: {
      cosmetic: areas.cosmetic / total,
      occluded: areas.occluded / total,
      uncovered: areas.uncovered / total,
      culled: areas.culled / total,
    },
  };
}

const kConclusions: Record<Verdict, string> = {
  good: 'GOOD: the cage fits.',
  usable: 'USABLE: the cage fits, with reservations.',
  unfit: 'UNFIT: the cage does not fit.',
};

/** Of a finding, by the verdict on it alone. */
const kMarks: Record<Verdict, string> = { good: '·', usable: '!', unfit: '✗' };

/** The verdict and the findings, for people. */
export function conclusionOf({ verdict, findings }: Inspection): string[] {
  return [
    kConclusions[verdict],
    ...findings.flatMap((finding) => [
      `${kMarks[verdictOf([finding])]} ${finding.sentence}.`,
      `  → ${adviceOn(finding)}`,
    ]),
  ];
}

/** What to do about a finding, with the flags that reverse its verdicts, if there are any. */
export function adviceOn({ code, advice, places = [], locks, ignore = [], numbers }: Finding): string {
  const { weldTolerance, others } = numbers;
  if (weldTolerance !== undefined) return `${advice} By: --set weldTolerance=${weldTolerance}`;
  if (code === 'uvsUnknown') return `${advice} By: --set cageUvs=${[others].flat()[0]}`;
  if (ignore.length > 0) return `${advice} By: ${ignore.map((name) => `--ignore "${name}"`).join(' ')}`;
  const locked = places.filter(({ segment }) => locks?.[segment] !== undefined);
  const flags = new Set(locked.map(({ segment, part }) => `--${locks![segment]} "${part}"`));
  return flags.size === 0 ? advice : `${advice} To override: ${[...flags].join(' ')}`;
}

/** Why a segment is not painted, if it is not. */
const kFates: Record<Segment['culledBy'], string> = {
  none: '',
  coverage: 'culled',
  hole: 'culled (hole)',
  lock: 'culled (lock)',
  ignore: 'ignored',
};

/** The segments with the largest exposed areas, as a table. @param most  How many. */
export function segmentTable(segments: readonly Segment[], most: number): string[][] {
  const largest = [...segments].sort((a, b) => b.exposedArea - a.exposedArea || a.segment - b.segment);
  return [
    ['part', 'segment', 'points', 'exposed E', 'covered C', 'F = C/E', 'score', 'confidence', ''],
    ...largest.slice(0, most).map((segment) => [
      segment.part,
      String(segment.segment),
      integer(segment.points),
      short(segment.exposedArea),
      short(segment.coveredArea),
      segment.coverage.toFixed(3),
      segment.score === null ? '∞' : Number(segment.score.toPrecision(2)).toString(), // endless if it needs no area
      segment.confidence.toFixed(2),
      kFates[segment.culledBy],
    ]),
  ];
}

/** The holes of a cage as a table. */
export const holeTable = (holes: readonly Hole[], most: number): string[][] => [
  ['beneath', 'kind', 'size', 'perimeter', 'cut off'],
  ...holes.slice(0, most).map(({ beneath, kind, diagonal, perimeter, cutOff }) => {
    const parts = beneath.slice(0, 3).map(({ part, share }) => `${part} ${Math.round(100 * share)} %`);
    return [parts.join(', ') || 'nothing', kind, ...[diagonal, perimeter, cutOff].map(percent)];
  }),
];
