import { askWorker } from './ask-worker';

/** @property size Of what is packed in `bytes`; without it they are to be packed. */
export interface PackRequest {
  bytes: Uint8Array<ArrayBuffer> | Blob;
  size?: number;
}

const start = (): Worker => new Worker(new URL('./pack-worker.ts', import.meta.url), { type: 'module' });

/** Compresses bytes by gzip. Takes the buffer. */
export const pack = (bytes: Uint8Array<ArrayBuffer>): Promise<Blob> => askWorker(start(), { bytes }, [bytes.buffer]);

/** Restores bytes that `pack` compressed. @param size Their number. @throws Error if they are damaged, or have another number. */
export const unpack = (packed: Blob, size: number): Promise<Uint8Array<ArrayBuffer>> =>
  askWorker(start(), { bytes: packed, size });
