import type { Mesh } from 'cagecast';
import type { Rules } from '../state/choices';
import type { ExtractedMesh, Model } from '../state/model';
import type { Session } from '../state/session';
import type { Baked, ExportReply, ExportRequest, PaintInto } from './export-messages';

/** What is exported. */
interface Exported {
  target: Pick<Model, 'name' | 'files'>;
  cage: Pick<Model, 'mesh'>;
  rules: Readonly<Rules>;
  choices: Session['choices'];
}

/**
 * Writes the target as a GLB with the new UV set, its zones and the paint, as `cagecast transfer` does: undeformed, with the
 * current options and locks. Runs in a temporary worker.
 * @param texture A PNG in the cage's UVs.
 * @param into    Paint as an overlay, or in the model's own textures where it has some.
 * @returns The file, with a summary if paint was baked into textures.
 * @throws Error that begins with the file's name.
 */
export async function exportGlb(
  { target, cage, rules, choices }: Exported,
  texture: Blob,
  into: PaintInto,
): Promise<{ glb: Blob; baked?: Baked }> {
  const files = await Promise.all(target.files.map(async (file) => ({ name: file.name, bytes: await read(file) })));
  const request: ExportRequest = {
    files,
    cage: cageOf(cage.mesh),
    texture: new Uint8Array(await texture.arrayBuffer()),
    into,
    options: { ...rules, ...choices },
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
    throw new Error(`${file.name}: the file was changed or deleted after it was opened; open it again`, { cause });
  });
}

/** The cage undeformed, like the target. */
const cageOf = ({ positions, rest = positions, indices, uvs }: ExtractedMesh): Mesh => ({
  positions: rest,
  indices,
  uvs,
});
