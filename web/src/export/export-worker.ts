import { type Document, type JSONDocument, Logger, WebIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { type BakeReport, bake, cagecast, type ImageCodec } from 'cagecast/gltf';
import { readGltfHead } from '../loading/gltf-file';
import { answerBy } from '../platform/ask-worker';
import { avatarExtensions } from './avatar-extensions';
import type { Baked, ExportAnswer, ExportRequest } from './export-messages';
import { readPixels, writePng } from './texture/pixels';

/** Removed on export: the overlay shares vertices with the model, so both are written uncompressed. */
const kCompressions = ['KHR_draco_mesh_compression', 'EXT_meshopt_compression', 'KHR_meshopt_compression'];

answerBy(paintModel, ({ glb }) => [glb.buffer]);

/** Writes the target with the new UV set, its zones, and the paint as an overlay or in its textures. */
async function paintModel({ files, cage, texture, into, options }: ExportRequest): Promise<ExportAnswer> {
  const io = new WebIO()
    .setLogger(new Logger(Logger.Verbosity.SILENT))
    .registerExtensions([...ALL_EXTENSIONS, ...avatarExtensions]);
  const document = await read(io, files);
  let baked: Baked | undefined;
  const all = { ...options, cage, texture };
  if (into === 'overlay') await document.transform(cagecast(all));
  else {
    const color = await readPixels(new Blob([texture]));
    const onBaked = (report: BakeReport): void => void (baked = summaryOf(report));
    await document.transform(bake({ ...all, paints: { color }, images, onBaked }));
  }
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

const kMinSide = 1024; // texels, longer side
const kMaxSide = 2048;

/** The model's own textures, in a size that holds the paint. */
const images: ImageCodec = {
  decode: (bytes, type) => readPixels(new Blob([bytes as Uint8Array<ArrayBuffer>], { type }), fitSize),
  encode: writePng,
};

function fitSize(width: number, height: number): [number, number] {
  const longer = Math.max(width, height);
  const scale = Math.max(kMinSide, Math.min(kMaxSide, longer)) / longer;
  return [Math.max(1, Math.round(scale * width)), Math.max(1, Math.round(scale * height))];
}

const summaryOf = ({ textures, left }: BakeReport): Baked => ({
  textures: textures.length,
  overlays: left.map(({ part }) => part),
  overlapping: Math.max(0, ...textures.map(({ overlap }) => overlap.lost)),
});

async function read(io: WebIO, files: ExportRequest['files']): Promise<Document> {
  const { bytes } = files[0]!;
  const { binary, json, extensions, uris } = readGltfHead(bytes);
  if (extensions.some((name) => name.endsWith('meshopt_compression'))) {
    const { MeshoptDecoder } = await import('meshoptimizer/decoder');
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
