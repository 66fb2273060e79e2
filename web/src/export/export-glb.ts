import type { Mesh } from 'cagecast';
import { readGltfHead } from '../loading/gltf-file';
import { askWorker } from '../platform/ask-worker';
import { type Embedded, embed } from '../platform/embedded';
import type { Rules } from '../state/choices';
import { choicesWithout } from '../state/left-out';
import type { ExtractedMesh, Model } from '../state/model';
import type { Session } from '../state/session';
import type { SplitProjection } from '../state/transfers';
import type { Baked, ExportAnswer, ExportRequest, PaintInto } from './export-messages';

/** What is exported. */
interface Exported {
  target: Pick<Model, 'name' | 'files'> & Partial<Pick<Model, 'mesh'>>;
  cage: Pick<Model, 'mesh' | 'files'>;
  rules: Readonly<Rules>;
  choices: Session['choices'];
  /** Says which parts are left out. */
  projection?: SplitProjection | undefined;
}

/**
 * Writes the target as a GLB with the new UV set, its zones and the paint, as `cagecast transfer` does: undeformed, with the
 * current options and locks. The file has cage and paint with it, so that the page goes on with them. Runs in a temporary worker.
 * @param texture A PNG in the cage's UVs.
 * @param into    Paint as an overlay, or in the model's own textures where it has some.
 * @param signal  Ends it.
 * @returns The file, with a summary if paint was baked into textures.
 * @throws Error that begins with the file's name.
 */
export async function exportGlb(
  { target, cage, rules, choices, projection }: Exported,
  texture: Blob,
  into: PaintInto,
  signal?: AbortSignal,
): Promise<{ glb: Blob; baked?: Baked }> {
  const files = await Promise.all(target.files.map(async (file) => ({ name: file.name, bytes: await read(file) })));
  const request: ExportRequest = {
    files,
    cage: cage.files[0] === target.files[0] ? undefined : cageOf(cage.mesh),
    texture: new Uint8Array(await texture.arrayBuffer()),
    into,
    options: { ...rules, ...(target.mesh && projection ? choicesWithout(choices, target.mesh, projection) : choices) },
  };
  const worker = new Worker(new URL('./export-worker.ts', import.meta.url), { type: 'module' });
  const transfer = files.map(({ bytes }) => bytes);
  const { glb, baked } = await askWorker<ExportAnswer>(worker, request, transfer, signal).catch((cause: Error) => {
    // What fails in one way may do in the other.
    const advice = into === 'texture' ? '. Save it with the paint as an overlay, or by “cagecast bake”' : '';
    throw new Error(`${target.name}: ${cause.message}${advice}`, { cause });
  });
  const paint = { name: 'paint.png', type: 'image/png', bytes: new Uint8Array(await texture.arrayBuffer()) };
  const whole = embed(glb, { paint, ...(request.cage && (await carriedCage(cage.files))) });
  return { glb: new Blob([whole], { type: 'model/gltf-binary' }), ...(baked && { baked }) };
}

/** The cage to put into the file; nothing if it is not one GLB. */
async function carriedCage([file, ...others]: readonly File[]): Promise<{ cage?: Embedded }> {
  if (!file || others.length > 0) return {};
  const bytes = new Uint8Array(await read(file));
  return readGltfHead(bytes.buffer).binary ? { cage: { name: file.name, type: 'model/gltf-binary', bytes } } : {};
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
