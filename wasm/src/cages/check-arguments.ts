import { checkMesh, count } from '../api/mesh.js';
import type { PartNames } from '../api/parts.js';
import type { Image } from '../bake/image.js';
import { CagecastError, isRecord, show } from '../core/error.js';
import { type EnumValue, namesOf } from '../core/module.js';
import { plainArray, showArray } from '../core/typed-arrays.js';
import { isRegion } from '../parts/template.js';
import { isPosition } from '../parts/template-extras.js';
import type { CagesModule, CoreLandmark, CoreModel, CoreOptions, CoreTemplate } from './cages-module.js';
import type { BaseColor, CageModel, Holes, Landmarks, Regions, Template } from './types.js';

/** The error for a part of an argument. @param place  Where it is, such as `template.landmarks`. */
const wrong = (fn: string, place: string, text: string) =>
  new CagecastError('badArgument', fn, `${place}${text}`, { argument: place.split('.')[0] });

/**
 * Checks the types of a model, as far as C++ does not.
 * @throws {CagecastError} `badArgument`
 */
export function checkModel(fn: string, model: unknown): CoreModel {
  const mesh = checkMesh(fn, 'model', model);
  const { names = [], joints = [], marks, hints, vertexJoints, baseColors } = model as CageModel;
  if ('parts' in (model as object))
    throw wrong(fn, 'model.parts', ' is not there any more; give the names of parts as model.names');
  const bad = (field: string, value: unknown, type: string) =>
    wrong(fn, `model.${field}`, ` is ${show(value)}, not ${type}`);
  if (!Array.isArray(joints)) throw bad('joints', joints, 'an array of joints { name, position, parent }');
  const plainMarks = plainArray(marks, 'Uint8Array');
  if (marks !== undefined && !plainMarks)
    throw wrong(fn, 'model.marks', ` is ${showArray(marks, 'Uint8Array')}, not a Uint8Array`);
  // An array that was moved to a worker is empty, which C++ would take for "no marks".
  if (plainMarks?.length === 0 && mesh.indices.length > 0)
    throw wrong(fn, 'model.marks', ` has 0 numbers, not 1 for each of ${count(mesh.indices.length / 3, 'triangle')}`);
  const plainVertexJoints = plainArray(vertexJoints, 'Uint16Array');
  if (vertexJoints !== undefined && !plainVertexJoints)
    throw wrong(fn, 'model.vertexJoints', ` is ${showArray(vertexJoints, 'Uint16Array')}, not a Uint16Array`);
  return {
    mesh,
    vertexJoints: plainVertexJoints ?? new Uint16Array(0),
    marks: plainMarks ?? new Uint8Array(0),
    ...checkBaseColors(fn, 'model.baseColors', baseColors),
    parts: joinedNames(names ?? []),
    hints: checkLandmarks(fn, 'model.hints', hints),
    joints: joints.map((joint, j) => {
      if (typeof joint?.name !== 'string') throw bad(`joints[${j}].name`, joint?.name, 'a name');
      if (!isPosition(joint.position)) throw bad(`joints[${j}].position`, joint.position, '3 finite numbers');
      const { parent = -1 } = joint;
      if (!Number.isInteger(parent)) throw bad(`joints[${j}].parent`, parent, 'a whole number');
      return { name: joint.name, position: joint.position, parent };
    }),
  };
}

/** Checks the types of base colours. @returns them with numbers of their images. @throws {CagecastError} `badArgument` */
function checkBaseColors(fn: string, argument: string, colors: unknown): Pick<CoreModel, 'baseColors' | 'images'> {
  if (colors === undefined || colors === null) return { baseColors: [], images: [] };
  if (!Array.isArray(colors)) throw wrong(fn, argument, ` is ${show(colors)}, not an array of { factor, image }`);
  const images = new Map<unknown, number>();
  const baseColors = colors.map((color: unknown, c) => {
    if (!isRecord(color)) throw wrong(fn, argument, `[${c}] is ${show(color)}, not { factor, image }`);
    const { factor = [1, 1, 1], image, isKnown = true } = color as BaseColor;
    if (!isPosition(factor)) throw wrong(fn, argument, `[${c}].factor is ${show(factor)}, not 3 numbers within 0..1`);
    if (image !== undefined && !isImage(image))
      throw wrong(fn, argument, `[${c}].image is ${show(image)}, not an image { width, height, data } of bytes`);
    if (image !== undefined && !images.has(image)) images.set(image, images.size);
    return { factor, image: images.get(image) ?? -1, isKnown: isKnown === true };
  });
  return { baseColors, images: [...images.keys()] as Image[] };
}

function isImage(image: unknown): image is Image {
  if (!isRecord(image)) return false;
  const { width, height, data } = image as Partial<Image>;
  const isSide = (side: unknown) => Number.isInteger(side) && (side as number) > 0 && (side as number) < 2 ** 16;
  return isSide(width) && isSide(height) && plainArray(data, 'Uint8Array', 'Uint8ClampedArray') !== undefined;
}

/** One name for each part, as C++ takes them. */
export const joinedNames = (names: PartNames): string[] => names.map((own) => [own].flat().join('/'));

/** Checks the types of a cage. @throws {CagecastError} `badArgument`, `missingUvs` */
function checkCage(fn: string, name: 'cage' | 'template', cage: unknown) {
  const mesh = checkMesh(fn, name, cage);
  if (mesh.uvs.length === 0)
    throw new CagecastError('missingUvs', fn, `${name}.uvs is missing: the texture is drawn in the cage's UVs`, {
      argument: name,
    });
  return mesh;
}

/** Checks the types of a cage that may have landmarks and a kind. @throws {CagecastError} `badArgument`, `missingUvs` */
export function checkTemplate(
  fn: string,
  name: 'cage' | 'template',
  module: CagesModule,
  template: unknown,
): CoreTemplate {
  const mesh = checkCage(fn, name, template);
  const { landmarks, kind = 'automatic' } = template as Template;
  return {
    mesh,
    landmarks: checkLandmarks(fn, `${name}.landmarks`, landmarks),
    kind: kindOf(module, kind, (kinds) => wrong(fn, `${name}.kind`, ` is ${show(kind)}, not one of ${kinds}`)),
  };
}

/** Checks the types of a cage's holes. @returns copies. @throws {CagecastError} `badArgument` */
export function checkHoles(fn: string, argument: string, holes: unknown): Holes {
  if (holes === undefined || holes === null) return {};
  if (!isRecord(holes)) throw wrong(fn, argument, ` is ${show(holes)}, not an object of names and vertices`);
  return Object.fromEntries(
    Object.entries(holes).map(([name, vertices]: [string, unknown]) => {
      if (!Array.isArray(vertices) && !ArrayBuffer.isView(vertices))
        throw wrong(fn, argument, `.${name} is ${show(vertices)}, not an array of vertices`);
      return [name, Array.from(vertices as Uint32Array)];
    }),
  );
}

/** Checks the types of a cage's regions. @returns copies; undefined if there are none. @throws {CagecastError} `badArgument` */
export function checkRegions(fn: string, argument: string, regions: unknown): Regions | undefined {
  if (regions === undefined || regions === null) return undefined;
  if (!isRecord(regions)) throw wrong(fn, argument, ` is ${show(regions)}, not an object of names and outlines`);
  for (const [name, outlines] of Object.entries(regions))
    if (!isRegion(outlines))
      throw wrong(fn, argument, `.${name} is ${show(outlines)}, not outlines, each of at least 3 corners [u, v]`);
  return structuredClone(regions as Regions);
}

/** The value in C++ of a kind. @param bad  Makes the error from the names that there are. */
function kindOf(module: CagesModule, kind: unknown, bad: (kinds: string) => CagecastError): EnumValue {
  const kinds = namesOf({ module: module as never }, 'Kind');
  if (!kinds.includes(kind as string)) throw bad(kinds.map(show).join(', '));
  return module.Kind[kind as string]!;
}

/** Checks the types of landmarks. @throws {CagecastError} `badArgument` */
export function checkLandmarks(fn: string, argument: string, landmarks: unknown): CoreLandmark[] {
  if (landmarks === undefined || landmarks === null) return [];
  if (!isRecord(landmarks) || Array.isArray(landmarks))
    throw wrong(fn, argument, ` is ${show(landmarks)}, not an object of names and positions`);
  return Object.entries(landmarks as Landmarks).map(([name, position]) => {
    if (!isPosition(position))
      throw wrong(fn, argument, `.${name} is ${show(position)}, not 3 finite numbers [x, y, z]`);
    return { name, position: [...position], confidence: 1 };
  });
}

/**
 * Puts options in the place of their defaults.
 * @param takes  Other options of the function.
 * @throws {CagecastError} `badOption`
 */
export function checkOptions(
  fn: string,
  module: CagesModule,
  defaults: CoreOptions,
  options: Record<string, unknown>,
  takes: readonly string[],
): CoreOptions {
  const bad = (text: string) => new CagecastError('badOption', fn, `options${text}`);
  const merged = { ...defaults };
  for (const [name, value] of Object.entries(options)) {
    if (value === undefined) continue;
    if (!(name in defaults))
      throw bad(`.${name} is unknown; there are: ${[...Object.keys(defaults), ...takes].join(', ')}`);
    if (name === 'kind') {
      merged[name] = kindOf(module, value, (kinds) => bad(`.kind = ${show(value)} is unknown; there are: ${kinds}`));
    } else {
      if (typeof value !== 'number' || !(value >= 0) || !Number.isFinite(value))
        throw bad(`.${name} is ${show(value)}, not a number of at least 0`);
      // C++ would take a share of a triangle or voxel for none.
      if ((name === 'triangles' || name === 'voxels') && !(Number.isInteger(value) && value < 2 ** 31))
        throw bad(`.${name} is ${show(value)}, not a whole number`);
      merged[name] = value;
    }
  }
  return merged;
}

/** @throws {CagecastError} `badArgument` if options of `fitCage` are given in the place of landmarks. */
export function checkOrder(landmarks: unknown): void {
  const name = ['parts', 'signal', 'onProgress'].find((option) => isRecord(landmarks) && option in landmarks);
  if (name === undefined) return;
  const text = `landmarks.${name} is an option; options come after landmarks: fitCage(template, model, undefined, { ${name} })`;
  throw new CagecastError('badArgument', 'fitCage', text, { argument: 'landmarks' });
}
