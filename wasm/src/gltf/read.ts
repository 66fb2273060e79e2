import { readFile } from 'node:fs/promises';
import { dirname, resolve } from 'node:path';
import { type Document, type GLTF, type JSONDocument, Logger, NodeIO } from '@gltf-transform/core';
import { EXTMeshoptCompression, KHRDracoMeshCompression, KHRMeshQuantization } from '@gltf-transform/extensions';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { show } from '../api/error.js';
import { checkGeometry, checkLists, dracoOf, meshoptView } from './check.js';
import { createDracoDecoder } from './draco.js';
import { firstLine, InputError } from './input-error.js';

/** A glTF file as it is, and its geometry decoded. */
export interface GltfFile {
  /** As the caller named it, for messages. */
  path: string;
  /** The JSON as it stands in the file. Not to be changed. */
  json: GLTF.IGLTF;
  /** The bytes of each buffer; `undefined` for one that has none (a fallback for compressed views). */
  buffers: (Uint8Array | undefined)[];
  /** The meshes and accessors, in the file's order, decompressed and decoded. */
  geometry: Document;
}

const geometryExtensions = [KHRMeshQuantization, EXTMeshoptCompression, KHRDracoMeshCompression];
const geometryExtensionNames: string[] = geometryExtensions.map((extension) => extension.EXTENSION_NAME);

/**
 * Reads a GLB or glTF file, with external or embedded buffers, quantised, sparse, or compressed by Draco or meshopt.
 * Only geometry is decoded; images and materials stay as they are.
 * @param bytes  Its content, if it is known already.
 * @throws {InputError} that names the file and what is wrong with it.
 */
export async function readGltf(path: string, bytes?: Uint8Array): Promise<GltfFile> {
  try {
    const { json, binary } = parse(bytes ?? (await readBytes(path)));
    const buffers = await readBuffers(json, binary, dirname(path));
    checkGeometry(
      json,
      buffers.map((buffer) => buffer?.byteLength),
    );
    return { path, json, buffers, geometry: await decode(json, buffers) };
  } catch (error) {
    if (error instanceof InputError) throw error.in(path);
    throw new InputError(`${path}: cannot be decoded (${firstLine(error)})`, { cause: error });
  }
}

/**
 * Reads a whole file.
 * @throws {InputError} with a message that does not name the file.
 */
export async function readBytes(path: string): Promise<Uint8Array> {
  try {
    return await readFile(path);
  } catch (error) {
    const { code } = error as NodeJS.ErrnoException;
    if (code === 'ENOENT') throw new InputError('no such file');
    if (code === 'EISDIR') throw new InputError('is a folder, not a file');
    if (code === 'EACCES') throw new InputError('cannot be read: permission denied');
    throw new InputError(`cannot be read (${firstLine(error)})`, { cause: error });
  }
}

function parse(bytes: Uint8Array): { json: GLTF.IGLTF; binary: Uint8Array | undefined } {
  if (bytes.byteLength === 0) throw new InputError('the file is empty');
  const isGlb = bytes[0] === 0x67 && bytes[1] === 0x6c && bytes[2] === 0x54 && bytes[3] === 0x46; // "glTF"
  const { text, binary } = isGlb ? chunks(bytes) : { text: bytes, binary: undefined };
  let json: GLTF.IGLTF | null;
  try {
    json = JSON.parse(new TextDecoder().decode(text)) as GLTF.IGLTF | null;
  } catch (cause) {
    throw new InputError(isGlb ? 'its JSON is damaged' : 'is neither a GLB nor a glTF file', { cause });
  }
  const version = typeof json === 'object' ? json?.asset?.version : undefined;
  if (typeof json !== 'object' || json === null || version === undefined) {
    throw new InputError('is JSON but not glTF: it has no asset.version');
  }
  if (!/^2\./.test(String(version)))
    throw new InputError(`is glTF ${typeof version === 'string' ? version : show(version)}; only 2.x can be read`);
  checkLists(json);
  return { json, binary };
}

/** The two chunks of a GLB. */
function chunks(bytes: Uint8Array): { text: Uint8Array; binary: Uint8Array | undefined } {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const have = bytes.byteLength;
  if (have < 20) throw new InputError(`is truncated: a GLB has at least 20 bytes, this one ${have}`);
  const version = view.getUint32(4, true);
  if (version !== 2) throw new InputError(`is a GLB of version ${version}; only version 2 can be read`);
  const length = view.getUint32(8, true);
  if (length > have) throw new InputError(`is truncated: its header says ${length} bytes, there are ${have}`);
  const found: Record<number, Uint8Array> = {};
  for (let at = 12; at + 8 <= length; ) {
    const size = view.getUint32(at, true);
    const type = view.getUint32(at + 4, true);
    if (at + 8 + size > length)
      throw new InputError(`is damaged: the chunk at byte ${at} has ${size} bytes, ${length - at - 8} are left`);
    found[type] ??= bytes.subarray(at + 8, at + 8 + size);
    at += 8 + size;
  }
  const text = found[0x4e4f534a]; // "JSON"
  if (text === undefined) throw new InputError('is damaged: it has no JSON chunk');
  return { text, binary: found[0x004e4942] }; // "BIN\0"
}

async function readBuffers(
  json: GLTF.IGLTF,
  binary: Uint8Array | undefined,
  folder: string,
): Promise<(Uint8Array | undefined)[]> {
  const { buffers = [] } = json;
  return Promise.all(
    buffers.map(async (buffer, b) => {
      const bytes =
        buffer.uri === undefined ? (b === 0 ? binary : undefined) : await readUri(`buffers[${b}]`, buffer.uri, folder);
      if (bytes !== undefined && bytes.byteLength < buffer.byteLength) {
        throw new InputError(
          `buffers[${b}] is truncated: it should have ${buffer.byteLength} bytes, there are ${bytes.byteLength}`,
        );
      }
      return bytes;
    }),
  );
}

/**
 * Reads what a glTF refers to: a data URI, or a file relative to it.
 * @throws {InputError} that begins with `name`.
 */
export async function readUri(name: string, uri: string, folder: string): Promise<Uint8Array> {
  if (/^data:/i.test(uri)) {
    const [head, kind] = /^data:([^,]*),/i.exec(uri) ?? [];
    if (head === undefined) throw new InputError(`${name} is ${show(uri)}, not a valid data URI`);
    // `fetch` would do it too, in 7 seconds for 60 MB instead of one tenth.
    const bytes = uri
      .slice(head.length)
      .replace(/%([0-9a-f]{2})/gi, (_, byte: string) => String.fromCharCode(Number.parseInt(byte, 16)));
    return Buffer.from(bytes, /;\s*base64\s*$/i.test(kind!) ? 'base64' : 'latin1');
  }
  if (/^[a-z][a-z0-9+.-]+:/i.test(uri))
    throw new InputError(`${name} is at ${uri.slice(0, 60)}; only local files can be read`);
  try {
    return await readBytes(resolve(folder, decoded(uri)));
  } catch (error) {
    throw error instanceof InputError ? new InputError(`${name} is in ${uri}: ${error.message}`) : error;
  }
}

/** The name of a file; as it stands, if it is not encoded as an address has to be. */
function decoded(uri: string): string {
  try {
    return decodeURIComponent(uri);
  } catch {
    return uri;
  }
}

/** Decodes meshes and accessors by glTF-Transform. It gets nothing else of the file, so that nothing else can make it fail. */
async function decode(json: GLTF.IGLTF, buffers: (Uint8Array | undefined)[]): Promise<Document> {
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
  return io.readJSON({
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
}
