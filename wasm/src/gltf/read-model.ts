import { numbersNamed } from '../api/parts.js';
import { cageGlb } from '../cages/cage-glb.js';
import type { Cage, Landmarks } from '../cages/types.js';
import { CagecastError, show } from '../core/error.js';
import { turnedBack } from '../inspect/backward.js';
import { moveApart } from '../parts/own-cages.js';
import { extrasIn, partsWithout, templateOf } from '../scene/cage-model.js';
import { type Extracted, extract, namedParts, type Part, partOf, primitivePath, uvLayout } from '../scene/extract.js';
import { InputError } from '../scene/input-error.js';
import type { SceneSource } from '../scene/source.js';
import type { Regions } from './look/saved-layers.js';
import { type GltfFile, openGltf } from './open-gltf.js';

/** A file, and all triangles of its scene. */
export interface ReadModel {
  file: GltfFile;
  extracted: Extracted;
}

/** A model as it is if it has UVs, as a cage must. @throws {InputError} that names the file and the primitive. */
export function withUvs(model: ReadModel): ReadModel {
  const { file, extracted } = model;
  if (extracted.mesh.uvs !== undefined) return model;
  const setOf = (part: Part) => uvLayout(file.json, part).set;
  const part = extracted.parts.find(
    (one) => file.json.meshes![one.mesh]!.primitives[one.primitive]!.attributes[setOf(one)] === undefined,
  )!;
  throw new InputError(
    `${primitivePath(part)} (${show(part.name)}) has no ${setOf(part)}: the texture is drawn in the cage's UVs`,
  ).in(file.path);
}

/** A cage around a model, as if it was read from a file. */
export async function readBack(cage: Cage, path: string, { extracted: { origin } }: ReadModel): Promise<ReadModel> {
  const file = await openGltf(path, cageGlb({ ...cage, origin }));
  return { file, extracted: extract(file, origin, 'cage') };
}

/** The landmarks in a cage's extras: of the model that it was made for or fitted to. None if they are damaged. */
export function landmarksIn({ file, extracted }: ReadModel): Landmarks {
  try {
    return templateOf(file, extracted).landmarks;
  } catch {
    return {};
  }
}

/** The regions in a cage's extras. None if they are damaged. */
export function regionsIn({ file, extracted }: ReadModel): Regions {
  try {
    return templateOf(file, extracted).regions ?? {};
  } catch {
    return {};
  }
}

/** A cage around the origin of its target. */
export function besideOf({ extracted: { origin } }: ReadModel, cage: ReadModel): ReadModel {
  const isBeside = cage.extracted.origin.every((x, k) => x === origin[k]);
  return isBeside ? cage : { ...cage, extracted: extract(cage.file, origin, 'cage') };
}

/** The parts of a target that stay bare by name: things a figure wears, and parts excluded when the cage was made. */
export function bareParts({ file, extracted: { parts, accessories } }: ReadModel, cage: ReadModel): number[] {
  const extras = extrasIn(cage.file, cage.extracted.parts);
  return [...new Set([...accessories, ...partsWithout(file, parts, extras)])];
}

/**
 * The parts of a target apart, each with the cage of its name, if there are such.
 * @param advice  The end of the error's message.
 * @throws {InputError} that names a part without a cage.
 */
export function movedApart(
  target: ReadModel,
  wholeCage: ReadModel,
  advice = '',
): { target: ReadModel; wholeCage: ReadModel } {
  const fail = (text: string) => new InputError(`${text}${advice}`).in(target.file.path);
  const apart = moveApart(wholeCage.extracted, target.extracted, fail);
  if (!apart) return { target, wholeCage };
  const withMesh = (model: ReadModel, mesh: ReadModel['extracted']['mesh']) => ({
    ...model,
    extracted: { ...model.extracted, mesh },
  });
  return {
    target: withMesh(target, apart.target),
    wholeCage: withMesh(wholeCage, apart.cage),
  };
}

/** A cage turned by half about the vertical axis. */
export const turned = ({ file, extracted }: ReadModel): ReadModel => ({
  file,
  extracted: { ...extracted, mesh: turnedBack(extracted.mesh) },
});

/** A model whose parts have names. */
export interface Named {
  file: SceneSource;
  extracted: Pick<Extracted, 'parts'> & Partial<Extracted>;
}

/** The numbers of the parts that a pattern names. */
export const partsNamed = (pattern: string, { file, extracted: { parts } }: Named): number[] =>
  numbersNamed(pattern, namedParts(file, parts));

/** An error of the core for two models, with the file at fault and the place in it. */
export function errorInFile(error: unknown, models: { target: ReadModel; cage: ReadModel }): unknown {
  if (!(error instanceof CagecastError)) return error;
  const { reason, argument, code, at } = error;
  const { file, extracted } = models[argument === 'cage' ? 'cage' : 'target'];
  const perVertex = { nonFinitePosition: 3, tooLarge: 3, nonFiniteUv: 2 }[code as string];
  const part = perVertex === undefined ? undefined : partOf(extracted.parts, Math.floor(at / perVertex));
  const where = part ? ` (${primitivePath(part)}, ${show(part.name)})` : '';
  return new InputError(`${reason}${where}`, { cause: error }).in(file.path);
}
