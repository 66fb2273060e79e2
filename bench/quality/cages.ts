import { init } from 'cagecast';
import { fitCage, makeCage, terminate } from 'cagecast/cages';
import { type Figure, type Kind, listFigures, templates } from '../cages/figures.js';
import type { StoredCage, StoredModel } from '../cages/files.js';
import { FitScorer } from '../cages/fit-score.js';
import { type CageMeasures, type FitMeasures, givenOf, measureCage, measureFit } from '../cages/measure.js';
import { meshOf } from '../cages/paint-score.js';
import { readGlb } from '../read-glb.js';

/** A cage that was made for a model, and the one that was made by hand. */
export interface MadeQuality {
  kind: Kind;
  /** Whether its parts have names that say what must not be painted. */
  named: boolean;
  made: CageMeasures;
  byHand?: CageMeasures;
  seconds: number;
}

/** A template that was fitted to a model. */
export interface FitQuality extends FitMeasures {
  kind: Kind;
  named: boolean;
  /** How many landmarks of the template were neither given nor found. */
  missing: number;
  seconds: number;
}

/** What is found out about cages, by model. */
export interface CageQuality {
  made: Record<string, MadeQuality>;
  /** With landmarks found by the package. */
  fitted: Record<string, FitQuality>;
  /** Heads with 23 given landmarks. */
  given: Record<string, FitQuality>;
  /** What could not be made or fitted, and why. */
  failed: string[];
}

interface Loaded {
  figure: Figure;
  model: StoredModel;
  cage?: StoredCage;
}

async function load(figure: Figure): Promise<Loaded> {
  const { mesh, parts, joints } = await readGlb(figure.target);
  const cage = figure.cage === undefined ? undefined : (await readGlb(figure.cage)).mesh;
  const model = { positions: mesh.positions, indices: mesh.indices, groups: mesh.groups!, parts, joints };
  return { figure, model, ...(cage && { cage: { ...cage, uvs: cage.uvs!, landmarks: figure.landmarks } }) };
}

const modelOf = ({ model }: Loaded) => ({ ...meshOf(model), parts: model.parts, joints: model.joints });

async function timed<T>(work: () => Promise<T>): Promise<[result: T, seconds: number]> {
  const began = performance.now();
  const result = await work();
  return [result, (performance.now() - began) / 1000];
}

/**
 * Makes a cage for every model, and fits the templates to the people.
 * @param only  Names of models; all if undefined.
 * @param say   Told what is done.
 */
export async function measureCages(
  only: readonly string[] | undefined,
  say: (what: string) => void,
): Promise<CageQuality> {
  await init();
  const figures = listFigures().filter(({ name }) => only?.includes(name) ?? true);
  const quality: CageQuality = { made: {}, fitted: {}, given: {}, failed: [] };
  const scorers = new Map<string, FitScorer>();
  for (const figure of figures) {
    const loaded = await load(figure);
    const attempt = async (what: string, work: () => Promise<void>): Promise<void> => {
      say(`${what} ${figure.name}`);
      await work().catch((error: Error) => quality.failed.push(`${what} ${figure.name}: ${error.message}`));
    };
    await attempt('make a cage for', async () => {
      quality.made[figure.name] = await measureMake(loaded);
    });
    const { template } = figure;
    if (template === undefined) continue;
    const scorer = scorers.get(template) ?? (await scorerOf(template));
    if (scorer === undefined) continue;
    scorers.set(template, scorer);
    await attempt('fit a cage to', async () => {
      quality.fitted[figure.name] = await measureFitted(loaded, scorer, 'auto');
    });
    if (figure.kind === 'head' && figure.named) {
      await attempt('with 23 landmarks, fit a cage to', async () => {
        quality.given[figure.name] = await measureFitted(loaded, scorer, '23');
      });
    }
  }
  terminate();
  return quality;
}

/** @returns none if the template is not among the models. */
async function scorerOf(name: string): Promise<FitScorer | undefined> {
  const figure = listFigures().find((one) => one.name === name && Object.values(templates).includes(one.name));
  if (figure?.cage === undefined) return undefined;
  const { model, cage } = await load(figure);
  return new FitScorer({ target: model, truth: figure.truth, landmarks: figure.landmarks, cage: cage! });
}

async function measureMake(loaded: Loaded): Promise<MadeQuality> {
  const { figure, model, cage } = loaded;
  const [made, seconds] = await timed(() => makeCage(modelOf(loaded)));
  return {
    kind: figure.kind,
    named: figure.named,
    made: measureCage(made, model, figure.truth),
    ...(cage && { byHand: measureCage(cage, model, figure.truth) }),
    seconds,
  };
}

async function measureFitted(loaded: Loaded, scorer: FitScorer, given: string): Promise<FitQuality> {
  const { figure, model } = loaded;
  const { cage, landmarks } = scorer.template;
  const template = { ...meshOf(cage), uvs: Float32Array.from(cage.uvs), landmarks: { ...landmarks } };
  const [fit, seconds] = await timed(() => fitCage(template, modelOf(loaded), givenOf(figure.landmarks, given)));
  const person = {
    target: model,
    truth: figure.truth,
    landmarks: figure.landmarks,
    ...(figure.source && { source: figure.source.points }),
  };
  const measures = measureFit(scorer, person, fit.cage, fit.used);
  return { ...measures, kind: figure.kind, named: figure.named, missing: fit.missing.length, seconds };
}
