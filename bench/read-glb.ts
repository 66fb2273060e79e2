import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import type { CageModel, Template } from 'cagecast/cages';
import { cageModel, cageTemplate } from 'cagecast/gltf';
import draco from 'draco3dgltf';
import { MeshoptDecoder } from 'meshoptimizer';
import { PNG } from 'pngjs';

async function readDocument(path: string) {
  await MeshoptDecoder.ready;
  const io = new NodeIO()
    .registerExtensions(ALL_EXTENSIONS)
    .registerDependencies({ 'meshopt.decoder': MeshoptDecoder, 'draco3d.decoder': await draco.createDecoderModule() });
  const file = await io.readAsJSON(path);
  return { document: await io.readJSON(file), extensions: file.json.extensions };
}

/** Reads a target: its mesh, the names of its parts, its joints, and base colours, as far as they are PNGs. */
export async function readTarget(path: string): Promise<CageModel> {
  const { document, extensions } = await readDocument(path);
  return cageModel(document, { extensions, decode: async (bytes) => PNG.sync.read(Buffer.from(bytes)) });
}

/** Reads a cage, and the landmarks that its file names. */
export async function readCage(path: string): Promise<Template> {
  return cageTemplate((await readDocument(path)).document);
}
