/** @property size Of what is packed in `bytes`; without it they are to be packed. */
export interface PackRequest {
  bytes: Uint8Array<ArrayBuffer> | Blob;
  size?: number;
}

/** What was packed or unpacked, or an error message. */
export type PackReply = Blob | Uint8Array<ArrayBuffer> | { message: string };

/** Compresses bytes by gzip, in a temporary worker: the page must not stop for it. Takes the buffer. */
export const pack = async (bytes: Uint8Array<ArrayBuffer>): Promise<Blob> =>
  (await ask({ bytes }, [bytes.buffer])) as Blob;

/** Restores bytes that `pack` compressed. @param size Their number. @throws Error if they are damaged, or have another number. */
export const unpack = async (packed: Blob, size: number): Promise<Uint8Array<ArrayBuffer>> =>
  (await ask({ bytes: packed, size })) as Uint8Array<ArrayBuffer>;

async function ask(request: PackRequest, transfer: Transferable[] = []): Promise<PackReply> {
  const worker = new Worker(new URL('./pack-worker.ts', import.meta.url), { type: 'module' });
  try {
    const reply = await new Promise<PackReply>((resolve, reject) => {
      worker.onmessage = ({ data }: MessageEvent<PackReply>) => resolve(data);
      worker.onerror = () => reject(new Error('the worker that packs paintings could not be started'));
      worker.postMessage(request, transfer);
    });
    if ('message' in reply) throw new Error(reply.message);
    return reply;
  } finally {
    worker.terminate();
  }
}
