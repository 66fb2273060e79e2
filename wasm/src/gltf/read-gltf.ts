import { dirname } from 'node:path';
import { type Accessor, type GLTF, type JSONDocument, Logger, NodeIO } from '@gltf-transform/core';
import { EXTMeshoptCompression, KHRDracoMeshCompression, KHRMeshQuantization } from '@gltf-transform/extensions';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { checkGeometry, dracoOf, meshoptView } from './check-geometry.js';
import { checkRest } from './check-rest.js';
import { createDracoDecoder } from './draco.js';
import { defaultReading, type ReadOptions, readBytes, readUri } from './files.js';
import { firstLine, InputError } from './input-error.js';
import { checkLimits, exceeds } from './limits.js';
import { parseGltf } from './parse.js';

/** A glTF file as it is, and its accessors decoded. */
export interface GltfFile {
  /** As the caller named it, for messages. */
  path: string;
  /** The JSON as it stands in the file. Not to be changed. */
  json: GLTF.IGLTF;
  /** The bytes of each buffer; `undefined` for one that has none (a fallback for compressed views). */
  buffers: (Uint8Array | undefined)[];
  /** The accessors, in the file's order, decompressed and decoded. */
  accessors: Accessor[];
  /** How it was read, for what is read later. */
  reading: ReadOptions;
}

const geometryExtensions = [KHRMeshQuantization, EXTMeshoptCompression, KHRDracoMeshCompression];
const geometryExtensionNames: string[] = geometryExtensions.map((extension) => extension.EXTENSION_NAME);

/**
 * Reads a GLB or glTF file, with external or embedded buffers, quantised, sparse, or compressed by Draco or meshopt.
 * Only geometry is decoded; images and materials stay as they are.
 * @param bytes  Its content, if it is known already.
 * @throws {InputError} that names the file and what is wrong with it.
 */
export async function readGltf(
  path: string,
  reading: ReadOptions = defaultReading,
  bytes?: Uint8Array,
): Promise<GltfFile> {
  try {
    const content = bytes ?? (await readBytes(path, reading.limits));
    const { json, binary } = parseGltf(content, reading.limits);
    const buffers = await readBuffers(json, binary, dirname(path), reading);
    const sizes = buffers.map((buffer) => buffer?.byteLength);
    checkGeometry(json, sizes);
    checkRest(json);
    const all = sizes.reduce<number>((sum, size) => sum + (size ?? 0), content.byteLength - (binary?.byteLength ?? 0));
    checkLimits(json, all, reading.limits);
    return { path, json, buffers, accessors: await decode(json, buffers), reading };
  } catch (error) {
    if (error instanceof InputError) throw error.in(path);
    throw new InputError(`${path}: cannot be decoded (${firstLine(error)})`, { cause: error });
  }
}

async function readBuffers(
  { buffers: list = [] }: GLTF.IGLTF,
  binary: Uint8Array | undefined,
  folder: string,
  reading: ReadOptions,
): Promise<(Uint8Array | undefined)[]> {
  const buffers: (Uint8Array | undefined)[] = [];
  let total = 0;
  for (const [b, { uri, byteLength }] of list.entries()) {
    const name = `buffers[${b}]`;
    const bytes = uri === undefined ? (b === 0 ? binary : undefined) : await readUri(name, uri, folder, reading);
    if (bytes !== undefined && bytes.byteLength < byteLength) {
      throw new InputError(`${name} is truncated: it should have ${byteLength} bytes, there are ${bytes.byteLength}`);
    }
    total += bytes?.byteLength ?? 0;
    if (total > reading.limits.bytes)
      throw exceeds(`its buffers up to ${name} have ${total.toLocaleString('en')} bytes`, 'bytes', reading.limits);
    buffers.push(bytes);
  }
  return buffers;
}

/** Decodes accessors by glTF-Transform. It gets no more of the file than their meshes, so that nothing else can make it fail. */
async function decode(json: GLTF.IGLTF, buffers: (Uint8Array | undefined)[]): Promise<Accessor[]> {
  const { asset, bufferViews = [], accessors = [], meshes = [] } = json;
  const names = (list: string[] | undefined) => list?.filter((name) => geometryExtensionNames.includes(name)) ?? [];
  const used = new Set(names(json.extensionsUsed));
  const usesDraco = meshes.some((mesh) => mesh.primitives.some(dracoOf));
  if (usesDraco) used.add('KHR_draco_mesh_compression');
  if (bufferViews.some(meshoptView)) used.add('EXT_meshopt_compression');

  const resources: Record<string, Uint8Array> = {};
  const bufferDefs = (json.buffers ?? []).map((buffer, b) => {
    resources[`buffer${b}`] = buffers[b] ?? new Uint8Array(0);
    return { ...buffer, uri: `buffer${b}` };
  });
  const io = new NodeIO().setLogger(new Logger(Logger.Verbosity.SILENT)).registerExtensions([...geometryExtensions]);
  io.registerDependencies({ 'meshopt.decoder': MeshoptDecoder });
  if (usesDraco) io.registerDependencies({ 'draco3d.decoder': await createDracoDecoder() });
  await MeshoptDecoder.ready;
  const document = await io.readJSON({
    json: {
      asset: { ...asset, version: '2.0' },
      buffers: bufferDefs,
      bufferViews: bufferViews.map((view) => {
        const compressed = meshoptView(view); // both extensions that it may come from have the same shape
        return compressed ? { ...view, extensions: { EXT_meshopt_compression: compressed } } : view;
      }),
      accessors,
      meshes: meshes.map((mesh) => ({
        primitives: mesh.primitives.map(({ attributes, indices, mode, extensions }) => ({
          attributes,
          ...(indices !== undefined && { indices }),
          ...(mode !== undefined && { mode }),
          ...(extensions && { extensions }),
        })),
      })),
      extensionsUsed: [...used],
      extensionsRequired: [...used],
    } as GLTF.IGLTF,
    resources,
  } as JSONDocument);
  return document.getRoot().listAccessors();
}
