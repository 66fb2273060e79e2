import { inspect } from 'cagecast/inspect';
import type { FigureTruth } from './figures.js';
import type { Landmarks, StoredCage, StoredModel } from './files.js';
import type { FitScore, FitScorer, Person, Spread } from './fit-score.js';
import { meshOf, type PaintScore, paintScore } from './paint-score.js';
import { diagonalOf } from './shape.js';

type CageArrays = Pick<StoredCage, 'positions' | 'indices' | 'uvs'>;

/** What is measured of any cage. */
export interface CageMeasures extends PaintScore {
  triangles: number;
  charts: number;
  /** Of the texture's used area, what belongs to more than one triangle; and the used share of the texture. */
  overlap: number;
  used: number;
  /** The share of the cage's area that lies inside of the target. */
  inside: number;
  verdict: 'good' | 'usable' | 'unfit';
  /** The code of the heaviest finding, if the verdict is not good. */
  finding?: string;
}

/** Measures a cage. `init` the package before. */
export function measureCage(cage: CageArrays, model: StoredModel, truth: FigureTruth): CageMeasures {
  const { verdict, findings, uv, inside } = inspect(meshOf(cage), meshOf(model));
  return {
    ...paintScore(cage, model, truth),
    triangles: cage.indices.length / 3,
    charts: uv.charts,
    overlap: uv.overlap.share,
    used: uv.used,
    inside: inside.area,
    verdict,
    ...(verdict !== 'good' && findings[0] && { finding: findings[0].code }),
  };
}

/** How far the landmarks of a fit are from the true ones, as shares of the diagonal. */
export interface LandmarkErrors {
  mean: number;
  most: number;
  count: number;
}

/** What is measured of a fitted cage. */
export interface FitMeasures extends FitScore, CageMeasures {
  /** The error of the template, moved by a similarity of the landmarks that the fit used. */
  similarity: Spread;
  /** The error of the template, carried by the true displacement of the skin. */
  floor: Spread;
  found: LandmarkErrors;
}

const none = { median: NaN, most: NaN };

/** Measures a fitted cage. @param used  The landmarks that the fit used. */
export function measureFit(
  scorer: FitScorer,
  person: Person & { target: StoredModel },
  cage: CageArrays,
  used: Landmarks,
): FitMeasures {
  const [bySimilarity, byTruth] = [scorer.bySimilarity(used), scorer.byTruth(person)];
  const size = diagonalOf(person.target.positions);
  const errors = Object.entries(used).flatMap(([name, at]) => {
    const truth = person.landmarks[name];
    return truth ? [Math.hypot(...at.map((x, k) => x - truth[k]!)) / size] : [];
  });
  return {
    ...scorer.score(cage.positions, person, Object.keys(used)),
    similarity: bySimilarity ? scorer.correspondence(bySimilarity, person) : none,
    floor: byTruth ? scorer.correspondence(byTruth, person) : none,
    found: { mean: mean(errors), most: Math.max(...errors), count: errors.length },
    ...measureCage(cage, person.target, person.truth),
  };
}

const five = ['eye_centre_left', 'eye_centre_right', 'nose_tip', 'lip_lower', 'chin'];
const nine = [...five, 'mouth_corner_left', 'mouth_corner_right', 'ear_lobe_left', 'ear_lobe_right'];

/**
 * Those of the true landmarks that a fit is given.
 * @param given  `auto`: none; `5`, `9`; `23`: all on the skin of a head; `all`; or names with commas between.
 */
export function givenOf(landmarks: Landmarks, given: string): Landmarks {
  const isGiven = (name: string): boolean => {
    if (given === 'auto') return false;
    if (given === 'all') return true;
    if (given === '23') return !/^joint_|^eye_centre/.test(name);
    return (given === '5' ? five : given === '9' ? nine : given.split(',')).includes(name);
  };
  return Object.fromEntries(Object.entries(landmarks).filter(([name]) => isGiven(name)));
}

/** Of the values that there are; NaN of none. */
export function mean(values: readonly number[]): number {
  const some = values.filter(Number.isFinite);
  return some.reduce((sum, value) => sum + value, 0) / some.length;
}

/** A share as a percentage with two digits; "–" for none. */
export const percent = (share: number): string => (Number.isFinite(share) ? (100 * share).toFixed(2) : '–');
