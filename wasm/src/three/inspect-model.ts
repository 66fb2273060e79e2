import type { Parts } from '../api/parts.js';
import type { Inspection, InspectOptions } from '../inspect/index.js';
import { kSceneOrigin } from '../parts/origin.js';
import { moveApart } from '../parts/own-cages.js';
import { isUvSetNumber, uvSetNumberText } from '../scene/uv-sets.js';
import { type CallOptions, inspect, transfer } from '../worker/index.js';
import { bareGroups, extract, extractNear } from './apply/extract-scene.js';
import { cageTemplate } from './apply/loaded-cages.js';
import type { Loaded, LoadedCage } from './apply/models.js';
import { ownCage } from './apply/own-cage.js';
import { notA, wrong } from './errors.js';

/** Options of `inspectModel`: those of `inspect`, with names of parts and landmarks of the models. */
export interface InspectModelOptions extends Omit<InspectOptions, 'parts' | 'landmarks'>, Pick<CallOptions, 'signal'> {
  /** The cage, as for `applyTransfer`. Default: the target's own. */
  cage?: LoadedCage | undefined;
  /** Its UV set, as for `applyTransfer`. */
  cageUvs?: number | undefined;
  /** What counts, as for `applyTransfer`. */
  parts?: Parts | undefined;
}

/**
 * As `inspect` of `cagecast/worker`, for loaded models: whether the cage fits, and if not, why, and what to do about it.
 * @throws {CagecastError} as `inspect` does; `badArgument` if a part cannot be read.
 *
 * @example
 * const { verdict, findings } = await inspectModel(head, { cage });
 * if (verdict === 'unfit') console.warn(findings[0].sentence, findings[0].advice);
 */
export async function inspectModel(target: Loaded, options: InspectModelOptions = {}): Promise<Inspection> {
  const { cage, cageUvs, parts, signal, ...given } = options;
  const extracted = extract(target, 'target', parts);
  if (cageUvs !== undefined && !isUvSetNumber(cageUvs))
    throw notA(uvSetNumberText, 'options.cageUvs', cageUvs, 'inspectModel', 'badOption');
  const outer = extractNear(cage ?? ownCage('inspectModel', target), 'cage', kSceneOrigin, { cageUvs });
  const exclude = [...bareGroups(outer, extracted), ...extracted.excluded];
  const rules = { ...given, parts: { keep: extracted.kept, exclude } };
  const apart = given.result
    ? undefined
    : moveApart(outer, extracted, (text) => wrong(`target: ${text}`, 'inspectModel'));
  const result = apart ? await transfer(apart.cage, apart.target, { ...rules, signal }) : given.result;
  if (apart && result) apart.mend(result);
  const landmarks = outer.mesh.uvs && cageTemplate(cage ?? target).landmarks;
  return inspect(outer.mesh, extracted.mesh, {
    ...rules,
    result,
    landmarks,
    signal,
  });
}
