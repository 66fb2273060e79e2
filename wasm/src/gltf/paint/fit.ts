import {
  type CageCallOptions,
  type Fit,
  fitCage,
  type Landmarks,
  loadTemplate,
  type TemplateName,
} from '../../cages/index.js';
import type { Template } from '../../cages/types.js';
import type { Vector } from '../../inspect/geometry.js';
import { landmarksMoved, moved } from '../../parts/origin.js';
import { FileModel } from '../bake/bake-file.js';
import { baseColorsOf } from '../bake/base-colors.js';
import type { ImageCodec } from '../bake/plan.js';
import { cageModelOf, templateOf } from '../cage-file.js';
import { extract } from '../extract-file.js';
import { hostDecode } from '../host-decode.js';
import { openGltf } from '../open-gltf.js';
import { type ReadModel, withUvs } from '../read-model.js';

interface FitCall extends Pick<CageCallOptions, 'signal' | 'onProgress'> {
  landmarks?: Landmarks | undefined;
  decode?: ImageCodec['decode'] | undefined;
}

/** Of the progress, the share at which a fit ends. */
const kFitted = 0.9;

/** Fits a template to a model. @returns the fit in the space of the model's scene. @throws {InputError}, {CagecastError} */
export async function fitTo(
  model: ReadModel,
  template: TemplateName | Uint8Array | Template,
  { landmarks, decode = hostDecode(), signal, onProgress }: FitCall,
): Promise<Fit> {
  const from = await readTemplate(template);
  const { origin } = model.extracted;
  const given = landmarks && landmarksMoved(landmarks, origin, -1);
  const calling = {
    signal,
    onProgress: (share: number, stage: string) => onProgress?.(kFitted * share, stage),
  };
  const { file, extracted } = model;
  const colors = decode && (await baseColorsOf(new FileModel(file, extracted.parts), decode));
  const fit = await fitCage(from, { ...cageModelOf(file, extracted), ...colors }, given, calling);
  const back = origin.map((x) => -x) as unknown as Vector;
  return {
    ...fit,
    used: landmarksMoved(fit.used, origin, 1),
    cage: { ...moved(fit.cage, back), landmarks: landmarksMoved(fit.cage.landmarks, origin, 1) },
  };
}

async function readTemplate(template: TemplateName | Uint8Array | Template): Promise<Template> {
  if (typeof template === 'string') return loadTemplate(template);
  if (!(template instanceof Uint8Array)) return template;
  const file = await openGltf('template', template);
  const { extracted } = withUvs({ file, extracted: extract(file, undefined, 'cage') });
  return templateOf(file, extracted);
}
