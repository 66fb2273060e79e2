import transcoder from 'three/addons/libs/basis/basis_transcoder.js?url';
import wasm from 'three/addons/libs/basis/basis_transcoder.wasm?url';
import { importAmd } from '../amd';

/** The part of the transcoder that is used here. */
interface Basis {
  initializeBasis(): void;
  KTX2File: new (
    bytes: Uint8Array,
  ) => {
    isValid(): boolean;
    getWidth(): number;
    getHeight(): number;
    startTranscoding(): boolean;
    getImageTranscodedSizeInBytes(level: number, layer: number, face: number, format: number): number;
    transcodeImage(
      out: Uint8Array,
      level: number,
      layer: number,
      face: number,
      format: number,
      alpha: number,
      channel0: number,
      channel1: number,
    ): number;
    close(): void;
    delete(): void;
  };
}

const kRgba = 13; // the transcoder's constant for uncompressed 8-bit RGBA

let started: Promise<Basis> | undefined;

async function start(): Promise<Basis> {
  const makeModule = await importAmd<(settings: { wasmBinary: ArrayBuffer }) => Promise<Basis>>(transcoder);
  const module = await makeModule({ wasmBinary: await (await fetch(wasm)).arrayBuffer() });
  module.initializeBasis();
  return module;
}

/** Decodes the first image of a KTX2 file. @throws Error without a file name. */
export async function readKtx2(bytes: ArrayBuffer): Promise<ImageData> {
  const { KTX2File } = await (started ??= start());
  const file = new KTX2File(new Uint8Array(bytes));
  try {
    if (!file.isValid() || !file.startTranscoding()) throw new Error('a KTX2 image cannot be decoded');
    const image = new ImageData(file.getWidth(), file.getHeight());
    const data = new Uint8Array(file.getImageTranscodedSizeInBytes(0, 0, 0, kRgba));
    if (!file.transcodeImage(data, 0, 0, 0, kRgba, 0, -1, -1)) throw new Error('a KTX2 image cannot be decoded');
    image.data.set(data);
    return image;
  } finally {
    file.close();
    file.delete();
  }
}
