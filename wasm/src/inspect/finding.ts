import type { Locks } from '../index.js';

/** A segment of the target, and where it is. */
export interface Place {
  /** Its number in `result.segments`. */
  segment: number;
  /** Of its first vertex, in `target.groups`. */
  group: number;
  /** The part that it begins in. */
  part: string;
}

/** Something about a cage, or what comes of it, that its author should know. */
export interface Finding {
  /** What it is, for programs. */
  code: FindingCode;
  /** How heavy it weighs: from `unfitFrom` on the cage is unfit, from `usableFrom` on no better than usable; less is a remark. */
  weight: number;
  /** What is the matter, with its number, for people. */
  sentence: string;
  /** What to do about it. */
  advice: string;
  /** The measures behind it; shares are of 1, lengths are shares of the target's diagonal. */
  numbers: Record<string, number | number[]>;
  /** The segments that it is about, if it is about some: the largest first. */
  places?: Place[];
  /** What decides these segments the other way, if that is what is wanted: an option of `transfer` and `classify`. */
  locks?: Locks;
}

/** Every finding there is, by what it is about. */
export type FindingCode =
  // Where the cage is.
  | 'cageElsewhere'
  | 'cageMisplaced'
  | 'cageTooSmall'
  | 'targetPokesOut'
  | 'cageTooFar'
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
  // What comes of it.
  | 'nothingToPaint'
  | 'holeUnexplained'
  | 'segmentInDoubt'
  | 'twinsDiffer'
  | 'muchCulled';

/** Whether a cage fits its target: as it should, with reservations, or not. */
export type Verdict = 'good' | 'usable' | 'unfit';

/** A finding of this weight alone makes a cage unfit. */
export const unfitFrom = 1;
/** A finding of this weight keeps a cage from being good. */
export const usableFrom = 0.25;

/** The verdict that findings add up to. */
export function verdictOf(findings: readonly Finding[]): Verdict {
  const heaviest = findings.reduce((most, { weight }) => Math.max(most, weight), 0);
  return heaviest >= unfitFrom ? 'unfit' : heaviest >= usableFrom ? 'usable' : 'good';
}

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
