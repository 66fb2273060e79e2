import type { Mesh, TransferOptions } from 'cagecast';
import type { CagecastOptions } from 'cagecast/gltf';

/** A request to the export worker. */
export interface ExportRequest {
  /** The target's file, then those it may refer to. */
  files: { name: string; bytes: ArrayBuffer }[];
  /** Undefined if it is in the target's file. */
  cage: Mesh | undefined;
  /** A PNG in the cage's UVs. */
  texture: Uint8Array<ArrayBuffer>;
  /** Paint as an overlay, or in the model's own textures where it has some. */
  into: PaintInto;
  /** Parts are numbers among those that are drawn. */
  options: TransferOptions & Pick<CagecastOptions, 'borders'>;
}

/** Summary of the baking. */
export interface Baked {
  /** Number of painted textures. */
  textures: number;
  /** Names of the parts that have an overlay, for lack of a suitable texture. */
  overlays: string[];
  /** Share of the paint that was left out, because several parts of the surface use the same texels. */
  overlapping: number;
}

export type PaintInto = 'overlay' | 'texture';

/** The model, with a summary if paint was baked into textures. */
export interface ExportAnswer {
  glb: Uint8Array<ArrayBuffer>;
  baked?: Baked;
}
