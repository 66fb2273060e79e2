/**
 * Cagecast as a function for glTF-Transform: the new UV set, the Non-Cosmetic Zones and an overlay, in a pipeline of one's own.
 * @module cagecast/gltf
 */
import type { Document, Transform } from '@gltf-transform/core';
import { show } from '../api/error.js';
import {
  CagecastError,
  cutBorders,
  init,
  type Mesh,
  type TransferOptions,
  type TransferResult,
  transfer,
} from '../index.js';
import { type Borders, isCut } from '../parts/borders-option.js';
import { addTransfer, extractDocument } from './document.js';
import { InputError } from './input-error.js';
import { paintOf } from './overlay.js';

/** Where a part of a document lies in the arrays of a result. */
export interface PartRange {
  /** Its node's name, with its material's where that adds something. */
  name: string;
  firstVertex: number;
  vertexCount: number;
  firstTriangle: number;
  triangleCount: number;
}

/** Options of `cagecast`: those of `transfer`, and what to transfer. */
export interface CagecastOptions extends TransferOptions {
  /** What the texture was drawn for: a document, whose scene is taken, or a mesh; it must have UVs. */
  cage: Document | Mesh;
  /** A PNG or JPEG file's bytes, in the cage's UVs: shown as an overlay of the cosmetic triangles. Without, there is none. */
  texture?: Uint8Array | undefined;
  /**
   * Lets paint end at the target's own triangles (`triangle`, by default), or cuts these where it does, at holes and seams (`cut`):
   * straight borders, more triangles.
   */
  borders?: Borders | undefined;
  /** Is called with the result, and with what its arrays refer to, in order. */
  onResult?: ((result: TransferResult, parts: PartRange[]) => void) | undefined;
}

/**
 * A transform that carries a cage's UVs to a document's meshes, as `cagecast transfer` does to a file.
 *
 * Every primitive of triangles in the document's scene gets a new `TEXCOORD` set and `_NCZ` (0 may be painted; else the
 * `Zone`), and, with a texture, an overlay primitive of its cosmetic triangles. All else stays as it is; a mesh that several
 * nodes show becomes one for each. Vertices that cutting adds are blends of those around them in all of their attributes, skin
 * weights and morph deltas. If it throws, the document is as it was.
 * @throws {CagecastError} whose message says what is wrong with target, cage, texture or options, and where.
 *
 * @example
 * import { NodeIO } from '@gltf-transform/core';
 * import { cagecast } from 'cagecast/gltf';
 *
 * const io = new NodeIO();
 * const document = await io.read('head.glb');
 * await document.transform(cagecast({ cage: await io.read('cage.glb'), texture: await readFile('paint.png') }));
 * await io.write('painted.glb', document);
 */
export function cagecast(options: CagecastOptions): Transform {
  if (typeof options !== 'object' || options === null)
    throw new CagecastError('badArgument', `cagecast: the argument is ${show(options)}, not an object`);
  const { cage, texture, borders, onResult, ...rules } = options;
  return async function cagecast(document: Document): Promise<void> {
    const cuts = isCut('cagecast', borders);
    await init();
    const wrong = (argument: string, value: unknown, type: string) =>
      new CagecastError('badArgument', `cagecast: ${argument} is ${show(value)}, not ${type}`);
    if (typeof cage !== 'object' || cage === null) throw wrong('cage', cage, 'a document or a mesh');
    if (texture !== undefined && !(texture instanceof Uint8Array))
      throw wrong('texture', texture, "a Uint8Array of a file's bytes");
    const paint = texture && within('texture', () => paintOf(texture));
    const source = 'getRoot' in cage ? within('cage', () => extractDocument(cage).mesh) : cage;
    const target = within('target', () => extractDocument(document));
    const result = transfer(source, target.mesh, rules);
    const cut = cuts ? cutBorders(source, target.mesh, result, rules) : undefined;
    addTransfer(document, target, result, paint, cut);
    onResult?.(
      result,
      target.parts.map(({ name, firstVertex, vertexCount, firstTriangle, triangleCount }) => ({
        name,
        firstVertex,
        vertexCount,
        firstTriangle,
        triangleCount,
      })),
    );
  };
}

function within<T>(argument: string, read: () => T): T {
  try {
    return read();
  } catch (error) {
    throw error instanceof InputError
      ? new CagecastError('badArgument', `cagecast: ${argument}: ${error.message}`, 0, { cause: error })
      : error;
  }
}
