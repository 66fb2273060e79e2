import { type Choice, type ChoiceEngine, choose } from '../../cages/choose.js';
import {
  type Cage,
  type CageCallOptions,
  type Fit,
  fitCage,
  type Landmarks,
  loadTemplate,
  makeCage,
  type TemplateName,
} from '../../cages/index.js';
import type { Template } from '../../cages/types.js';
import { plainArray } from '../../core/typed-arrays.js';
import type { Vector } from '../../inspect/geometry.js';
import { landmarksMoved, moved } from '../../parts/origin.js';
import { cageModelOf, templateOf } from '../../scene/cage-model.js';
import { extract } from '../../scene/extract.js';
import type { ImageCodec } from '../../scene/materials.js';
import { hostDecode } from '../host-decode.js';
import { openGltf } from '../open-gltf.js';
import { type ReadModel, withUvs } from '../read-model.js';

interface FitCall extends Pick<CageCallOptions, 'signal' | 'onProgress'> {
  /** `inspect` of `cagecast`, here or in a worker. */
  inspect: ChoiceEngine['inspect'];
  landmarks?: Landmarks | undefined;
  decode?: ImageCodec['decode'] | undefined;
}

/** What a template came to on a model, in the space of its scene. */
interface Fitted extends Pick<Choice, 'cage' | 'fit'>, Partial<Pick<Choice, 'tried'>> {
  /** What was chosen, for `auto`. */
  template?: Choice['template'] | undefined;
}

/** Of the progress, the share at which a fit ends. */
const kFitted = 0.9;

/** Fits a template to a model, or chooses its cage. @throws {InputError}, {CagecastError} */
export async function fitTo(
  model: ReadModel,
  template: TemplateName | 'auto' | Uint8Array | Template,
  { inspect, landmarks, decode = hostDecode(), signal, onProgress }: FitCall,
): Promise<Fitted> {
  const from = template === 'auto' ? undefined : await readTemplate(template);
  const { file, extracted } = model;
  const { origin, kept, excluded } = extracted;
  const given = landmarks && landmarksMoved(landmarks, origin, -1);
  const calling = {
    signal,
    onProgress: (share: number, stage: string) => onProgress?.(kFitted * share, stage),
    parts: { keep: kept, exclude: excluded },
  };
  const read = await cageModelOf(file, extracted, decode);
  const back = origin.map((x) => -x) as unknown as Vector;
  const cageBack = (cage: Cage): Cage => ({
    ...moved(cage, back),
    landmarks: landmarksMoved(cage.landmarks, origin, 1),
  });
  const fitBack = (fit: Fit): Fit => ({
    ...fit,
    used: landmarksMoved(fit.used, origin, 1),
    cage: cageBack(fit.cage),
  });
  if (from) {
    const fit = fitBack(await fitCage(from, read, given, calling));
    return { cage: fit.cage, fit };
  }
  const engine = { fitCage, makeCage, inspect };
  const { cage, fit, template: chosen, tried } = await choose(engine, read, { landmarks: given, ...calling });
  return { cage: cageBack(cage), fit: fit && fitBack(fit), template: chosen, tried };
}

async function readTemplate(template: TemplateName | Uint8Array | Template): Promise<Template> {
  if (typeof template === 'string') return loadTemplate(template);
  const bytes = plainArray(template, 'Uint8Array');
  if (!bytes) return template as Template;
  const file = await openGltf('template', bytes);
  const { extracted } = withUvs({ file, extracted: extract(file, undefined, 'cage') });
  return templateOf(file, extracted);
}
