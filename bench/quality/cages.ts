import { inspect, transfer } from 'cagecast';
import { type Cage, fitCage, type Landmarks, makeCage, terminate } from 'cagecast/cages';
import { type FitScore, FitScorer } from './fit-score.js';
import { type Figure, loadFigure, loadFigures } from './models.js';
import { type Score, score } from './score.js';

/** What is measured of any cage. Suppressed and kept are of the preset `default`. */
export interface CageQuality extends Score {
  kind: Figure['kind'];
  isNamed: boolean;
  triangles: number;
  charts: number;
  /** Of the texture's used area, what belongs to more than one triangle. */
  overlap: number;
  verdict: 'good' | 'usable' | 'unfit';
  /** What it took to make. */
  seconds: number;
}

/** What is found out about cages, by model. */
export interface CageResults {
  made: Record<string, CageQuality>;
  /** By hand, for the same models. */
  byHand: Record<string, CageQuality>;
  /** With landmarks found by the package. */
  fitted: Record<string, CageQuality & FitScore>;
  /** Heads with 23 given landmarks. */
  given: Record<string, CageQuality & FitScore>;
  /** What could not be made or fitted, and why. */
  failed: string[];
}

type CageMesh = Pick<Cage, 'positions' | 'indices' | 'uvs'>;

function qualityOf({ kind, isNamed, target, truth }: Figure, cage: CageMesh, seconds: number): CageQuality {
  const { positions, indices, groups } = target;
  const mesh = { positions, indices, groups };
  const { verdict, uv } = inspect(cage, mesh);
  return {
    kind,
    isNamed,
    ...score(mesh, truth, transfer(cage, mesh).zones),
    triangles: cage.indices.length / 3,
    charts: uv.charts,
    overlap: uv.overlap.share,
    verdict,
    seconds,
  };
}

async function timed<T>(work: Promise<T>): Promise<[result: T, seconds: number]> {
  const began = performance.now();
  return [await work, (performance.now() - began) / 1000];
}

/**
 * Makes a cage for every model, and fits the templates to the people. `init` the package before.
 * @param only  Names of models; all if undefined.
 * @param say   Is given what is done.
 */
export async function measureCages(
  only: readonly string[] | undefined,
  say: (what: string) => void,
): Promise<CageResults> {
  const results: CageResults = { made: {}, byHand: {}, fitted: {}, given: {}, failed: [] };
  const scorers = new Map<string, FitScorer>();
  for (const figure of await loadFigures(only)) {
    const { name, cage, template } = figure;
    const attempt = async (what: string, work: () => Promise<void>): Promise<void> => {
      say(`${what} ${name}`);
      await work().catch((error: Error) => results.failed.push(`${what} ${name}: ${error.message}`));
    };
    await attempt('make a cage for', async () => {
      results.made[name] = qualityOf(figure, ...(await timed(makeCage(figure.target))));
    });
    if (cage !== undefined) results.byHand[name] = qualityOf(figure, cage as CageMesh, 0);
    if (template === undefined) continue;
    const scorer = scorers.get(template) ?? new FitScorer(await loadFigure(template));
    scorers.set(template, scorer);
    const fitTo = async (landmarks: Landmarks): Promise<CageQuality & FitScore> => {
      const from = { ...scorer.cage, landmarks: scorer.template.landmarks };
      const [fit, seconds] = await timed(fitCage(from, figure.target, landmarks));
      return {
        ...qualityOf(figure, fit.cage, seconds),
        ...scorer.score(fit.cage.positions, figure, Object.keys(fit.used)),
      };
    };
    await attempt('fit a cage to', async () => void (results.fitted[name] = await fitTo({})));
    if (figure.kind !== 'head' || !figure.isNamed) continue;
    const onSkin = Object.entries(figure.landmarks).filter(([spot]) => !/^joint_|^eye_centre/.test(spot));
    await attempt('with 23 landmarks, fit a cage to', async () => {
      results.given[name] = await fitTo(Object.fromEntries(onSkin));
    });
  }
  terminate();
  return results;
}
