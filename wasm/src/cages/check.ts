import { CagecastError, show } from '../api/error.js';
import { checkMesh } from '../api/mesh.js';
import { type EnumValue, namesOf } from '../core/module.js';
import type { CagesModule, CoreLandmark, CoreModel, CoreOptions, CoreTemplate } from './module.js';
import type { CageModel, Landmarks, Template } from './types.js';

const wrong = (fn: string, text: string) => new CagecastError('badArgument', `${fn}: ${text}`);

const isPosition = (value: unknown): value is [number, number, number] =>
  Array.isArray(value) && value.length === 3 && value.every((x) => Number.isFinite(x));

/**
 * Checks the types of a model, as far as C++ does not.
 * @throws {CagecastError} `badArgument`
 */
export function checkModel(fn: string, model: unknown): CoreModel {
  const mesh = checkMesh(fn, 'model', model);
  const { parts = [], joints = [], marks = new Uint8Array(0) } = model as CageModel;
  const bad = (field: string, value: unknown, type: string) =>
    wrong(fn, `model.${field} is ${show(value)}, not ${type}`);
  if (!Array.isArray(joints)) throw bad('joints', joints, 'an array of joints { name, position, parent }');
  if (!(marks instanceof Uint8Array)) throw bad('marks', marks, 'a Uint8Array');
  return {
    mesh,
    marks,
    parts: checkParts(fn, 'model.parts', parts),
    joints: joints.map((joint, j) => {
      if (typeof joint?.name !== 'string') throw bad(`joints[${j}].name`, joint?.name, 'a name');
      if (!isPosition(joint.position)) throw bad(`joints[${j}].position`, joint.position, '3 finite numbers');
      const { parent = -1 } = joint;
      if (!Number.isInteger(parent)) throw bad(`joints[${j}].parent`, parent, 'a whole number');
      return { name: joint.name, position: joint.position, parent };
    }),
  };
}

/** Checks the names of parts. @returns one name for each. @throws {CagecastError} `badArgument` */
export function checkParts(fn: string, argument: string, parts: unknown): string[] {
  if (!Array.isArray(parts)) throw wrong(fn, `${argument} is ${show(parts)}, not an array of names`);
  return parts.map((part: unknown, p) => {
    const names = Array.isArray(part) ? part : [part];
    for (const name of names)
      if (typeof name !== 'string')
        throw wrong(fn, `${argument}[${p}] is ${show(name)}, not a name, or an array of names`);
    return names.join('/');
  });
}

/** Checks patterns of names. @param bad  Makes the error. */
export function checkPatterns(patterns: unknown, bad: (type: string) => CagecastError): string[] {
  if (!Array.isArray(patterns) || !patterns.every((pattern) => typeof pattern === 'string'))
    throw bad('an array of patterns');
  return patterns;
}

/** Checks the types of a cage. @throws {CagecastError} `badArgument`, `missingUvs` */
export function checkCage(fn: string, name: 'cage' | 'template', cage: unknown) {
  const mesh = checkMesh(fn, name, cage);
  if (mesh.uvs.length === 0)
    throw new CagecastError('missingUvs', `${fn}: ${name}.uvs is missing: the texture is drawn in the cage's UVs`);
  return mesh;
}

/** Checks the types of a template. @throws {CagecastError} `badArgument`, `missingUvs` */
export function checkTemplate(fn: string, module: CagesModule, template: unknown): CoreTemplate {
  const mesh = checkCage(fn, 'template', template);
  const { landmarks, kind = 'automatic' } = template as Template;
  return {
    mesh,
    landmarks: checkLandmarks(fn, 'template.landmarks', landmarks),
    kind: kindOf(module, kind, (kinds) => wrong(fn, `template.kind is ${show(kind)}, not one of ${kinds}`)),
  };
}

/** The value in C++ of a kind. @param bad  Makes the error from the names that there are. */
function kindOf(module: CagesModule, kind: unknown, bad: (kinds: string) => CagecastError): EnumValue {
  const kinds = namesOf({ module: module as never }, 'Kind');
  if (!kinds.includes(kind as string)) throw bad(kinds.map(show).join(', '));
  return module.Kind[kind as string]!;
}

/** Checks the types of landmarks. @throws {CagecastError} `badArgument` */
export function checkLandmarks(fn: string, argument: string, landmarks: unknown): CoreLandmark[] {
  if (landmarks === undefined) return [];
  if (typeof landmarks !== 'object' || landmarks === null || Array.isArray(landmarks))
    throw wrong(fn, `${argument} is ${show(landmarks)}, not an object of names and positions`);
  return Object.entries(landmarks as Landmarks).map(([name, position]) => {
    if (!isPosition(position))
      throw wrong(fn, `${argument}.${name} is ${show(position)}, not 3 finite numbers [x, y, z]`);
    return { name, position, confidence: 1 };
  });
}

/**
 * Puts options in the place of their defaults.
 * @throws {CagecastError} `badOption`
 */
export function checkOptions(
  fn: string,
  module: CagesModule,
  defaults: CoreOptions,
  options: Record<string, unknown>,
): CoreOptions {
  const bad = (text: string) => new CagecastError('badOption', `${fn}: options${text}`);
  const merged = { ...defaults };
  for (const [name, value] of Object.entries(options)) {
    if (value === undefined) continue;
    if (!(name in defaults)) throw bad(`.${name} is unknown; there are: ${Object.keys(defaults).join(', ')}`);
    if (name === 'kind') {
      merged[name] = kindOf(module, value, (kinds) => bad(`.kind = ${show(value)} is unknown; there are: ${kinds}`));
    } else if (name === 'exclude') {
      merged[name] = checkPatterns(value, (type) => bad(`.exclude is ${show(value)}, not ${type}`));
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
