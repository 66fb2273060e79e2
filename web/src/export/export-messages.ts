import type { Mesh, TransferOptions } from 'cagecast';
import type { CagecastOptions } from 'cagecast/gltf';
import type { Baked } from './texture/bake';

/** What the page asks of the worker that writes models. */
export interface ExportRequest {
  /** The target's file first, then those it may refer to. */
  files: { name: string; bytes: ArrayBuffer }[];
  cage: Mesh;
  /** A PNG in the cage's UVs. */
  texture: Uint8Array<ArrayBuffer>;
  /** Where the paint goes: over the model, or into its own textures where it has some. */
  into: PaintInto;
  options: TransferOptions & Pick<CagecastOptions, 'borders'>;
}

export type PaintInto = 'overlay' | 'texture';

/** The model, and what became of the paint if it was to go into textures; or what went wrong. */
export type ExportReply = { glb: Uint8Array<ArrayBuffer>; baked?: Baked } | { message: string };
