import { CagecastError, show } from '../core/error.js';
import type { CheckedMesh } from '../core/module.js';
import { type ArrayKind, plainArray, showArray } from '../core/typed-arrays.js';
import type { PartNames } from './parts.js';

/** A triangle mesh. Its arrays are copied and never changed. */
export interface Mesh {
  /**
   * 3 numbers per vertex (x, y, z), within ±4.2e37 and ±5e7 diagonals of the target; cage and target are in the same space and unit.
   */
  positions: Float32Array;
  /** 3 per triangle, counter-clockwise seen from outside. */
  indices: Uint32Array | Uint16Array | Uint8Array;
  /** 2 numbers per vertex, finite. Required for a cage, optional for a target. */
  uvs?: Float32Array | undefined;
  /** 1 per vertex, usually the number of its mesh or material: vertices of different groups are never welded. Default: all 0. */
  groups?: Uint32Array | undefined;
  /** Names by the number of a group, one or several, for patterns of `parts` and for messages. Default: none. */
  names?: PartNames | undefined;
  /**
   * Of a target: other positions of its vertices, as `positions` has them, one pose after the other. What is hidden at rest and seen in
   * one of them is painted as well, with the option `motion`. Default: none.
   */
  poses?: Float32Array | undefined;
  /**
   * Of a cage that was read from a file: the numbers of other UV sets in it that the texture may be drawn in as well as in `uvs`, as nothing
   * tells. `inspect` asks which it is. Default: none.
   */
  otherUvSets?: readonly number[] | undefined;
}

const noFloats = new Float32Array(0);
const noGroups = new Uint32Array(0);

/** What a loaded model is instead of arrays, and how it is read; `undefined` if something is none. */
function readerOf(name: string, model: object): string | undefined {
  const { isObject3D, isBufferGeometry, scene, getRoot } = model as Record<string, unknown>;
  if (isObject3D || isBufferGeometry || (scene as { isObject3D?: boolean } | undefined)?.isObject3D)
    return `a model of three.js; give extract(${name}, '${name}').mesh, by extract of cagecast/three`;
  if (typeof getRoot !== 'function') return undefined;
  const read = name === 'cage' || name === 'template' ? 'cageTemplate' : 'cageModel';
  return `a document of glTF-Transform; give ${read}(${name}), by ${read} of cagecast/gltf`;
}

/**
 * Checks the types of a mesh's arrays and adds empty ones for those that are missing. The core checks the values.
 * @throws {CagecastError} `badArgument`
 */
export function checkMesh(fn: string, name: 'cage' | 'target' | 'model' | 'template', mesh: unknown): CheckedMesh {
  const details = { argument: name };
  if (typeof mesh !== 'object' || mesh === null) {
    throw new CagecastError(
      'badArgument',
      fn,
      `${name} is ${show(mesh)}, not a mesh { positions, indices, … }`,
      details,
    );
  }
  const reader = readerOf(name, mesh);
  if (reader) throw new CagecastError('badArgument', fn, `${name} is ${reader}`, details);
  const given = mesh as Partial<Mesh>;
  const arrayOf = <Kind extends ArrayKind>(field: keyof Mesh, type: string, ...kinds: Kind[]) => {
    const value: unknown = given[field];
    const array = plainArray(value, ...kinds);
    if (array) return array;
    if (field !== 'positions' && field !== 'indices' && (value === undefined || value === null)) return undefined;
    throw new CagecastError(
      'badArgument',
      fn,
      `${name}.${field} is ${showArray(value, ...kinds)}, not a ${type}`,
      details,
    );
  };
  const positions = arrayOf('positions', 'Float32Array', 'Float32Array')!;
  const indices = arrayOf(
    'indices',
    'Uint32Array, Uint16Array or Uint8Array',
    'Uint32Array',
    'Uint16Array',
    'Uint8Array',
  )!;
  const uvs = arrayOf('uvs', 'Float32Array', 'Float32Array');
  const groups = arrayOf('groups', 'Uint32Array', 'Uint32Array');
  const poses = arrayOf('poses', 'Float32Array', 'Float32Array');
  checkNames(fn, `${name}.names`, given.names);
  // With vertices, an empty array of groups is a mistake of the caller, which the core would take for "no groups".
  if (groups?.length === 0 && positions.length > 0) {
    throw new CagecastError(
      'groupCountMismatch',
      fn,
      `${name}.groups has 0 entries, not 1 for each of ${count(positions.length / 3, 'vertex')}`,
      details,
    );
  }
  return { positions, indices, uvs: uvs ?? noFloats, groups: groups ?? noGroups, poses: poses ?? noFloats };
}

/** @param place  Where they are, such as `target.names`. @throws {CagecastError} `badArgument` */
export function checkNames(fn: string, place: string, names: unknown): void {
  if (names === undefined || names === null) return;
  const wrong = (text: string) => new CagecastError('badArgument', fn, place + text, { argument: place.split('.')[0] });
  if (!Array.isArray(names)) throw wrong(` is ${show(names)}, not an array`);
  const isName = (one: unknown) => typeof one === 'string';
  const bad = names.findIndex((own) => !isName(own) && !(Array.isArray(own) && own.every(isName)));
  if (bad >= 0) throw wrong(`[${bad}] is ${show(names[bad])}, not a name or an array of names`);
}

/** "1 vertex", "900 vertices". */
export function count(n: number, one: 'vertex' | 'triangle'): string {
  const many = one === 'vertex' ? 'vertices' : 'triangles';
  return `${Math.floor(n)} ${Math.floor(n) === 1 ? one : many}`;
}
