import type { Mesh, TransferOptions } from '../../api/index.js';
import { plainArray } from '../../core/typed-arrays.js';
import { hash, pack, unpack } from '../../parts/pack.js';
import type { Prepared } from '../../parts/prepare.js';
import { notA, wrong } from '../errors.js';
import type { Applied, Saved } from './apply-options.js';
import { type Attribute, valuesOf } from './attributes.js';
import type { ExtractedNear } from './extract-scene.js';

const made = new WeakMap<Applied, () => Saved>();

/**
 * Turns what was applied into bytes, to be stored. `deserialize` reads them; then the same model needs no transfer and no cage.
 * They hold the result and how the geometries are split, about 100 bytes per vertex, more with cut borders, and no texture.
 * @throws {CagecastError} `badArgument` if it is nothing that `applyTransfer` returned.
 */
export function serialize(applied: Applied): Uint8Array<ArrayBuffer> {
  const saved = made.get(applied);
  if (!saved) throw wrong('applied is not what applyTransfer returned', 'serialize');
  return pack(saved());
}

/**
 * Reads what `serialize` wrote, for the option `saved`.
 * @throws {CagecastError} `badArgument` if the bytes are something else, damaged or of another version.
 */
export function deserialize(bytes: Uint8Array): Saved {
  const own = plainArray(bytes, 'Uint8Array');
  if (!own) throw notA('a Uint8Array', 'bytes', bytes, 'deserialize');
  return unpack(own) as Saved;
}

/** Remembers what was applied, for `serialize`. */
export function remember(applied: Applied, saved: () => Saved): Applied {
  made.set(applied, saved);
  return applied;
}

export const keyOf = (target: ExtractedNear, cage: Mesh | undefined, options: TransferOptions, cuts: boolean): string =>
  [shapeKey(target), hashOfMesh(target.mesh), hashOfMesh(cage), textHash(JSON.stringify([options, cuts]))].join('-');

/** The part of a key that depends on the shapes of a target's meshes, wherever these are, and however they are posed. */
const shapeKey = ({ states, parts }: ExtractedNear): string => {
  const counts = parts.map(({ vertexCount, triangleCount }) => `${vertexCount} ${triangleCount}`).join();
  return digits([...states.map((state) => valuesOf(state.getAttribute('position') as Attribute)), encode(counts)]);
};

/** @throws {CagecastError} `badArgument` if what was saved is of another target. */
export function checkSaved({ key, prepared }: Saved, target: ExtractedNear): Prepared {
  if (!key.startsWith(`${shapeKey(target)}-`))
    throw wrong(
      'options.saved is of another target, or of other parts of it; load it as it was, and give the same parts',
    );
  return prepared;
}

const encode = (text: string): Uint8Array => new TextEncoder().encode(text);

/** Two hashes of arrays, one after the other, as hexadecimal digits. */
const digits = (arrays: readonly (ArrayBufferView | undefined)[]): string =>
  [1, 2]
    .map((seed) => {
      for (const array of arrays)
        if (array) seed = hash(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), seed);
      return seed.toString(16).padStart(8, '0');
    })
    .join('');

const hashOfMesh = (mesh: Mesh | undefined): string =>
  digits([mesh?.positions, mesh?.indices, mesh?.groups, mesh?.uvs, mesh?.poses]);
const textHash = (text: string): string => digits([encode(text)]);
