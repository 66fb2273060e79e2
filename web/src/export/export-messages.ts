import type { Mesh, TransferOptions } from 'cagecast';
import type { CagecastOptions } from 'cagecast/gltf';
import type { Baked } from './texture/bake';

/** A request to the export worker. */
export interface ExportRequest {
  /** The target's file, then those it may refer to. */
  files: { name: string; bytes: ArrayBuffer }[];
  cage: Mesh;
  /** A PNG in the cage's UVs. */
  texture: Uint8Array<ArrayBuffer>;
  /** Paint as an overlay, or in the model's own textures where it has some. */
  into: PaintInto;
  options: TransferOptions & Pick<CagecastOptions, 'borders'>;
}

export type PaintInto = 'overlay' | 'texture';

/** The model, with a summary if paint was baked into textures; or an error message. */
export type ExportReply = { glb: Uint8Array<ArrayBuffer>; baked?: Baked } | { message: string };
