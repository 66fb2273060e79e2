/** The decoder of meshopt, as `MeshoptDecoder` of the package `meshoptimizer` is. */
export interface MeshoptDecoder {
  supported: boolean;
  ready: Promise<void>;
  decodeGltfBuffer(
    target: Uint8Array,
    count: number,
    size: number,
    source: Uint8Array,
    mode: string,
    filter?: string,
  ): void;
}

/** Decoders of compressed geometry, each started when it is needed. */
export interface Decoders {
  meshopt?: () => Promise<MeshoptDecoder>;
  /** A module of Draco, as `createDecoderModule` of `draco3dgltf` makes it. */
  draco?: () => Promise<unknown>;
}
