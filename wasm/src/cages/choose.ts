// Chooses the cage of a model that came alone.

import type { Mesh } from '../api/mesh.js';
import { CagecastError } from '../core/error.js';
import { type Finding, isDoubtful, kVerdicts, type Verdict } from '../inspect/finding.js';
import { boxOf } from '../inspect/geometry.js';
import type { Inspection, InspectOptions } from '../inspect/index.js';
import { accessoriesAmong, groupsNamed } from '../parts/drawn.js';
import type { OnProgress } from '../worker/queue.js';
import { likelyTemplate } from './likely-template.js';
import type { TemplateName } from './template-names.js';
import { loadTemplate } from './templates.js';
import type { Cage, CageModel, Fit, FitOptions, Landmarks, MakeOptions, Template } from './types.js';

/** Options of `chooseCage`: for a made cage those of `makeCage`, and templates and landmarks for fits. */
export interface ChooseOptions extends MakeOptions {
  /** Templates to try, in this order. Default: those that the model likely needs, by its names and shape. */
  templates?: readonly TemplateName[] | undefined;
  /** Spots of the model for fits; they override those that are found. Default: none. */
  landmarks?: Landmarks | undefined;
}

/** A cage that was tried. */
export interface Tried {
  /** What was fitted; `made` for a cage that was made for the model. */
  template: TemplateName | 'made';
  /** Missing if there was no cage to inspect. */
  verdict?: Verdict | undefined;
  /** Why it is not better: its worst finding, or why there was no cage; empty if it is good. */
  reason: string;
}

/** The cage that was chosen for a model. */
export interface Choice extends Pick<Inspection, 'verdict' | 'findings'> {
  /** With landmarks of the model, so it is a template itself. */
  cage: Cage;
  /** What was fitted: all models with the same one can wear the same paint. `made` if the cage was made for this model alone. */
  template: TemplateName | 'made';
  /** What the fit found, if there was one. */
  fit: Fit | undefined;
  /** All cages that were tried, in that order. */
  tried: Tried[];
}

/** Progress and end of a call. */
interface Calling {
  signal?: AbortSignal | undefined;
  onProgress?: OnProgress | undefined;
}

/** The functions that a choice needs, on this thread or another. */
export interface ChoiceEngine {
  fitCage(
    template: Template,
    model: CageModel,
    landmarks: Landmarks | undefined,
    options: FitOptions & Calling,
  ): Fit | Promise<Fit>;
  makeCage(model: CageModel, options: MakeOptions & Calling): Cage | Promise<Cage>;
  inspect(cage: Mesh, target: Mesh, options: InspectOptions): Inspection | Promise<Inspection>;
}

/** How many landmarks are asked for. */
const kMaxAsked = 4;

/**
 * Fits templates, one after another, until one is good; if none is, makes a cage, too. The best verdict counts, then whether it is in
 * doubt, then the order: what is fitted shares its paint with others.
 * @throws {CagecastError} as `makeCage`, if there is no cage at all.
 */
export async function choose(
  engine: ChoiceEngine,
  model: CageModel,
  { templates = likelyTemplates(model), landmarks, signal, onProgress, ...options }: ChooseOptions & Calling,
): Promise<Choice> {
  const tried: Tried[] = [];
  const candidates: Omit<Choice, 'tried'>[] = [];
  const { parts } = options;
  // Cages are judged with the face at rest, which takes less time.
  const { joints, marks, hints, vertexJoints, baseColors, poses, ...mesh } = model;
  const names = (model.names ?? []).map((own) => [own].flat());
  const used = new Set(model.groups ?? [0]); // others have no vertices
  const step = (): Calling => ({
    signal,
    onProgress: onProgress && ((share, stage) => onProgress((tried.length + share) / (templates.length + 1), stage)),
  });

  const judge = async (template: Tried['template'], cage: Cage, fit?: Fit): Promise<boolean> => {
    onProgress?.((tried.length + 1) / (templates.length + 1), 'inspect');
    const bare = [...accessoriesAmong(names), ...groupsNamed(cage.bare ?? [], names)].filter((p) => used.has(p));
    const { verdict, findings } = await engine.inspect(cage, mesh, {
      landmarks: cage.landmarks,
      parts: { ...parts, exclude: [...(parts?.exclude ?? []), ...bare] },
    });
    signal?.throwIfAborted();
    tried.push({ template, verdict, reason: reasonOf(verdict, findings) });
    candidates.push({ cage, template, fit, verdict, findings });
    return verdict === 'good';
  };

  for (const template of templates) {
    try {
      const fit = await engine.fitCage(await loadTemplate(template), model, landmarks, { parts, ...step() });
      const isGuess = fit.guessed.length > 0;
      if (isGuess)
        tried.push({
          template,
          reason: `too little was found to fit it by; give ${fit.guessed.slice(0, kMaxAsked).join(', ')}`,
        });
      else if (await judge(template, fit.cage, fit)) break;
    } catch (error) {
      if ((error as CagecastError).code !== 'badModel') throw error;
      tried.push({ template, reason: (error as CagecastError).reason });
    }
  }
  if (!candidates.some(({ verdict }) => verdict === 'good')) {
    try {
      const cage = await engine.makeCage(model, { ...options, ...step() });
      await judge('made', { ...cage, landmarks: { ...cage.landmarks, ...landmarks } });
    } catch (error) {
      if (!(error instanceof CagecastError) || error.code !== 'badModel' || candidates.length === 0) throw error;
      tried.push({ template: 'made', reason: error.reason });
    }
  }
  const rank = ({ verdict, findings }: (typeof candidates)[number]): number =>
    kVerdicts.indexOf(verdict) - (isDoubtful(findings) ? 0.5 : 0);
  candidates.sort((a, b) => rank(b) - rank(a));
  onProgress?.(1, 'inspect');
  return { ...candidates[0]!, tried };
}

/**
 * A figure that the body does not fit, such as a toy, gets a cage of its own: a head's would leave the rest bare. A bust may have the
 * joints of a whole figure: those beside the mesh tell nothing.
 */
function likelyTemplates({ positions, joints = [], names = [] }: CageModel): TemplateName[] {
  const { min, max } = boxOf(positions);
  const own = joints.filter(({ position }) => position.every((x, k) => x >= min[k]! && x <= max[k]!));
  const named = likelyTemplate(positions, { joints: own.map(({ name }) => name), parts: names.flat() });
  return named === 'human-body' ? [named] : [...new Set([named, likelyTemplate(positions)])];
}

function reasonOf(verdict: Verdict, [worst]: readonly Finding[]): string {
  return verdict === 'good' || !worst ? '' : worst.sentence;
}
