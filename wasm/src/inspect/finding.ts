import type { Locks } from '../api/index.js';

/** A segment of the target and its part. */
export interface Place {
  /** Its number in `result.segments`. */
  segment: number;
  /** The group of its first vertex, in `target.groups`. */
  group: number;
  /** The part of its first vertex. */
  part: string;
}

/** A problem of a cage, or of its result, that its author should know about. */
export interface Finding {
  /** What it is, for programs. */
  code: FindingCode;
  /** Its severity: from 1 on the cage is unfit, from 0.25 on at best usable; less is a remark. */
  weight: number;
  /** What the problem is, with numbers, for people. */
  sentence: string;
  /** What to do about it. */
  advice: string;
  /** The measured values; lengths are shares of the target's diagonal. */
  numbers: Record<string, number | number[]>;
  /** The segments concerned, if any: the largest first. */
  places?: Place[];
  /** Locks that reverse the verdicts on these segments: an option of `transfer` and `classify`. */
  locks?: Locks;
  /** The names of parts that should not count, for `parts.ignore`. */
  ignore?: string[];
}

/** The codes of all findings, by topic. */
export type FindingCode =
  // Where the cage is.
  | 'cageElsewhere'
  | 'cageBackward'
  | 'cageMisplaced'
  | 'cageTooSmall'
  | 'targetPokesOut'
  | 'cageTooFar'
  | 'targetTooLarge'
  | 'cageInsideTarget'
  // How it faces, and its surface.
  | 'normalsInward'
  | 'degenerateTriangles'
  | 'doubledTriangles'
  | 'nonManifoldEdges'
  | 'cracks'
  // Its UVs.
  | 'uvsOutside'
  | 'uvsWithoutArea'
  | 'uvsOverlap'
  | 'uvsInPieces'
  | 'uvsUnknown'
  // The result.
  | 'nothingToPaint'
  | 'faceBare'
  | 'eyesUnknown'
  | 'windowsUnknown'
  | 'eyesPainted'
  | 'faceSeam'
  | 'skinBare'
  | 'limbsBare'
  | 'holeUnexplained'
  | 'segmentInDoubt'
  | 'muchCulled'
  | 'muchHidden'
  | 'piecesApart';

/** The verdicts, the worst first. */
export const kVerdicts = ['unfit', 'usable', 'good'] as const;

/** Whether a cage fits its target: not at all, with reservations, or well. */
export type Verdict = (typeof kVerdicts)[number];

/** Whether one verdict is worse than another. */
export const isWorse = (a: Verdict, b: Verdict): boolean => kVerdicts.indexOf(a) < kVerdicts.indexOf(b);

/** A finding of this weight alone makes a cage unfit. */
const kUnfitFrom = 1;
/** A finding of this weight keeps a cage from being good. */
const kUsableFrom = 0.25;

/** The verdict that findings add up to. */
export function verdictOf(findings: readonly Finding[]): Verdict {
  const heaviest = findings.reduce((most, { weight }) => Math.max(most, weight), 0);
  return heaviest >= kUnfitFrom ? 'unfit' : heaviest >= kUsableFrom ? 'usable' : 'good';
}

/** Whether a usable cage is so only just, or has a hole beside an eye or the mouth: another one is worth a try. */
export const isDoubtful = (findings: readonly Pick<Finding, 'code' | 'weight'>[]): boolean =>
  findings.some(({ code, weight }) => code === 'holeUnexplained' || weight > kUnfitFrom / 2);

/** "12.3 %"; "0.25 %", "0.04 %" below one. */
export function percent(share: number): string {
  const value = 100 * share;
  if (value !== 0 && Math.abs(value) < 0.01) return '< 0.01 %';
  return `${Math.abs(value) >= 1 || value === 0 ? value.toFixed(1) : Number(value.toPrecision(2))} %`;
}

/** "1 hole", "3 holes", "5,316 triangles". */
export function counted(n: number, one: string, many = `${one}s`): string {
  return `${n.toLocaleString('en')} ${n === 1 ? one : many}`;
}
