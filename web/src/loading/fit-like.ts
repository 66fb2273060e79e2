import type { Cage, CageModel, Template, TemplateName } from 'cagecast/cages';
import { cageModel } from '#three';
import { placeAround } from '../state/cage-maker';
import { type Fitting, noteMade } from '../state/made-cages';
import { type Model, originOf } from '../state/model';
import { haveSameUvs } from '../state/same-uvs';
import type { FitProgress } from '../state/wardrobe/surroundings';

const kReach = 0.2; // of the diagonal of the model

/**
 * Fits the cage of one model to another, with the same triangles and UVs, so that one paint fits both. A template is fitted by
 * landmarks; any other cage is moved, scaled and bent.
 * @param model As its file has it.
 * @returns The cage as a file.
 */
export async function fitLike(cage: Model, model: Model, progress: FitProgress): Promise<File> {
  const engine = await import('cagecast/cages');
  const target = await cageModel(model.loaded);
  const found = await templateOf(cage, engine);
  const fileOf = (fitted: Cage): File =>
    new File([engine.cageGlb({ ...fitted, origin: originOf(model) })], model.name.replace(/(\.\w+)?$/, '-cage.glb'));
  if (!found) return fileOf(await bend(cage, target, engine, progress));
  const { cage: fitted, ...fit } = await engine.fitCage(found.template, target, undefined, progress);
  const fitting: Fitting = { ...fit, template: found.name, given: {} };
  const file = fileOf(fitted);
  noteMade(file, { target: model.files[0]!, fitting });
  return file;
}

/** The template that a cage was made from; undefined if it is none. */
async function templateOf(
  cage: Model,
  engine: typeof import('cagecast/cages'),
): Promise<{ name: TemplateName; template: Template } | undefined> {
  for (const name of engine.templateNames) {
    const template = await engine.loadTemplate(name);
    if (haveSameUvs(cage, { mesh: template as Template & { indices: Uint32Array } })) return { name, template };
  }
  return undefined;
}

async function bend(
  { mesh: { positions, rest = positions, indices, uvs } }: Model,
  target: CageModel,
  engine: typeof import('cagecast/cages'),
  progress: FitProgress,
): Promise<Cage> {
  const old = {
    positions: rest.slice(),
    indices: indices.slice(),
    uvs: (uvs ?? new Float32Array()).slice(),
    landmarks: {},
    holes: {},
    kind: 'automatic',
  } as Cage;
  const placed = placeAround(old, target.positions);
  const bent = await engine.refineCage(placed, target, { ...progress, reach: kReach }).catch((error: Error) => {
    if (progress.signal.aborted) throw error;
    return placed; // the verdict says how it fits
  });
  return { ...bent, uvs: old.uvs };
}
