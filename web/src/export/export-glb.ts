import type { Mesh } from 'cagecast';
import type { ExtractedMesh } from '../scene/extract';
import type { Session } from '../scene/session';
import type { ExportReply, ExportRequest, PaintInto } from './export-messages';
import type { Baked } from './texture/bake';

/**
 * Writes the target that is shown as a GLB: all that its file has, the new UV set, its zones, and the paint, as `cagecast
 * transfer` does, in the shape of its file, by the rules and locks as they stand. A worker of its own does it, and ends with it.
 * @param texture A PNG in the cage's UVs.
 * @param into    Where the paint goes: over the model, or into its own textures where it has some.
 * @returns The file, and what became of the paint if it was to go into textures.
 * @throws Error that begins with the file's name.
 */
export async function exportGlb(
  { shown, rules, locks }: Session,
  texture: Blob,
  into: PaintInto,
): Promise<{ glb: Blob; baked?: Baked }> {
  const { target, cage } = shown!;
  const files = await Promise.all(target.files.map(async (file) => ({ name: file.name, bytes: await read(file) })));
  const request: ExportRequest = {
    files,
    cage: cageOf(cage.mesh),
    texture: new Uint8Array(await texture.arrayBuffer()),
    into,
    options: { ...rules, locks: { segments: locks } },
  };
  const worker = new Worker(new URL('./export-worker.ts', import.meta.url), { type: 'module' });
  try {
    const reply = await new Promise<ExportReply>((resolve, reject) => {
      worker.onmessage = ({ data }: MessageEvent<ExportReply>) => resolve(data);
      worker.onerror = (event) =>
        reject(
          new Error(`${target.name}: the export could not be started${event.message ? `: ${event.message}` : ''}`),
        );
      worker.postMessage(request, { transfer: files.map(({ bytes }) => bytes) });
    });
    if ('message' in reply) throw new Error(`${target.name}: ${reply.message}`);
    return { ...reply, glb: new Blob([reply.glb], { type: 'model/gltf-binary' }) };
  } finally {
    worker.terminate();
  }
}

async function read(file: File): Promise<ArrayBuffer> {
  return file.arrayBuffer().catch((cause) => {
    throw new Error(
      `${file.name}: it can no longer be read, as it has changed or is gone since it was opened; open it again`,
      { cause },
    );
  });
}

/** As in its file: so is the target. */
const cageOf = ({ positions, rest = positions, indices, uvs }: ExtractedMesh): Mesh => ({
  positions: rest,
  indices,
  uvs,
});
