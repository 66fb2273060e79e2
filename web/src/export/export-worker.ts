import { type Document, type JSONDocument, Logger, type Material, Primitive, WebIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { convertPrimitiveToTriangles } from '@gltf-transform/functions';
import { cagecast } from 'cagecast/gltf';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { readGltfHead } from '../scene/gltf-file';
import type { ExportReply, ExportRequest } from './export-messages';
import { paintIntoTextures } from './texture/bake';
import { readPixels } from './texture/pixels';

/** Removed on export: the overlay shares vertices with the model, so both are written uncompressed. */
const kCompressions = ['KHR_draco_mesh_compression', 'EXT_meshopt_compression', 'KHR_meshopt_compression'];

addEventListener('message', async ({ data }: MessageEvent<ExportRequest>) => {
  try {
    const reply = await paintModel(data);
    postMessage(reply satisfies ExportReply, { transfer: [reply.glb.buffer] });
  } catch (error) {
    postMessage({ message: error instanceof Error ? error.message : String(error) } satisfies ExportReply);
  }
});

/** Writes the target with the new UV set, its zones, and the paint as an overlay or in its textures. */
async function paintModel({
  files,
  cage,
  texture,
  into,
  options,
}: ExportRequest): Promise<Exclude<ExportReply, { message: string }>> {
  const io = new WebIO().setLogger(new Logger(Logger.Verbosity.SILENT)).registerExtensions(ALL_EXTENSIONS);
  const document = await read(io, files);
  const own = new Set(document.getRoot().listMaterials());
  if (into === 'texture') expandStrips(document);
  await document.transform(cagecast({ ...options, cage, texture }));
  const isOverlay = (material: Material): boolean => !own.has(material);
  const baked =
    into === 'texture'
      ? await paintIntoTextures(document, isOverlay, await readPixels(new Blob([texture])))
      : undefined;
  const left = document
    .getRoot()
    .listTextures()
    .some((texture) => texture.getMimeType() === 'image/ktx2')
    ? kCompressions
    : [...kCompressions, 'KHR_texture_basisu'];
  for (const extension of document.getRoot().listExtensionsUsed())
    if (left.includes(extension.extensionName)) extension.dispose();
  return { glb: await io.writeBinary(document), ...(baked && { baked }) };
}

/** Converts strips and fans to triangle lists, which baking needs. */
function expandStrips(document: Document): void {
  const { TRIANGLE_STRIP, TRIANGLE_FAN } = Primitive.Mode as Record<string, number>;
  for (const primitive of document
    .getRoot()
    .listMeshes()
    .flatMap((mesh) => mesh.listPrimitives())) {
    if (primitive.getMode() === TRIANGLE_STRIP || primitive.getMode() === TRIANGLE_FAN)
      convertPrimitiveToTriangles(primitive);
  }
}

async function read(io: WebIO, files: ExportRequest['files']): Promise<Document> {
  const { bytes } = files[0]!;
  const { binary, json, extensions, uris } = readGltfHead(bytes);
  if (extensions.some((name) => name.endsWith('meshopt_compression'))) {
    await MeshoptDecoder.ready;
    io.registerDependencies({ 'meshopt.decoder': MeshoptDecoder });
  }
  if (extensions.includes('KHR_draco_mesh_compression')) {
    const { makeDracoModule } = await import('./draco-module');
    io.registerDependencies({ 'draco3d.decoder': await makeDracoModule() });
  }
  if (binary) return io.readBinary(new Uint8Array(bytes));
  const resources: JSONDocument['resources'] = {};
  for (const uri of uris) {
    const found = files.find(({ name }) => name === uri.split('/').at(-1));
    if (!found) throw new Error(`the model needs the file ${uri}`);
    resources[uri] = resources[encodeURI(uri)] = new Uint8Array(found.bytes);
  }
  return io.readJSON({ json, resources } as JSONDocument);
}
