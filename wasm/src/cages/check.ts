import { CagecastError, show } from '../api/error.js';
import { checkMesh } from '../api/mesh.js';
import { namesOf } from '../core/module.js';
import type { CagesModule, CoreLandmark, CoreModel, CoreOptions } from './module.js';
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
  if (!Array.isArray(parts)) throw bad('parts', parts, 'an array of names');
  if (!Array.isArray(joints)) throw bad('joints', joints, 'an array of joints { name, position, parent }');
  if (!(marks instanceof Uint8Array)) throw bad('marks', marks, 'a Uint8Array');
  return {
    mesh,
    marks,
    parts: parts.map((part: unknown, p) => {
      const names = Array.isArray(part) ? part : [part];
      for (const name of names)
        if (typeof name !== 'string') throw bad(`parts[${p}]`, name, 'a name, or an array of names');
      return names.join('/');
    }),
    joints: joints.map((joint, j) => {
      if (typeof joint?.name !== 'string') throw bad(`joints[${j}].name`, joint?.name, 'a name');
      if (!isPosition(joint.position)) throw bad(`joints[${j}].position`, joint.position, '3 finite numbers');
      const { parent = -1 } = joint;
      if (!Number.isInteger(parent)) throw bad(`joints[${j}].parent`, parent, 'a whole number');
      return { name: joint.name, position: joint.position, parent };
    }),
  };
}

/** Checks the types of a cage. @throws {CagecastError} `badArgument`, `missingUvs` */
export function checkCage(fn: string, name: 'cage' | 'template', cage: unknown) {
  const mesh = checkMesh(fn, name, cage);
  if (mesh.uvs.length === 0)
    throw new CagecastError('missingUvs', `${fn}: ${name}.uvs is missing: the texture is drawn in the cage's UVs`);
  return mesh;
}

/** Checks the types of a template. @throws {CagecastError} `badArgument`, `missingUvs` */
export function checkTemplate(fn: string, template: unknown) {
  const mesh = checkCage(fn, 'template', template);
  return { mesh, landmarks: checkLandmarks(fn, 'template.landmarks', (template as Template).landmarks) };
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
      const kinds = namesOf({ module: module as never }, 'Kind');
      if (!kinds.includes(value as string))
        throw bad(`.kind = ${show(value)} is unknown; there are: ${kinds.map(show).join(', ')}`);
      merged[name] = module.Kind[value as string]!;
    } else if (name === 'exclude') {
      if (!Array.isArray(value) || !value.every((pattern) => typeof pattern === 'string'))
        throw bad(`.exclude is ${show(value)}, not an array of patterns`);
      merged[name] = value;
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
