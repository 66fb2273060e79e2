import { type GLTF, type JSONDocument, Logger, NodeIO } from '@gltf-transform/core';
import { EXTMeshoptCompression, KHRDracoMeshCompression, KHRMeshQuantization } from '@gltf-transform/extensions';
import { meshoptView } from '../../gltf/checks/check-geometry.js';
import { meshoptDecoder } from '../../gltf/meshopt.js';
import type { AccessorData } from '../../scene/accessor.js';
import { createDracoDecoder } from './draco.js';

const geometryExtensions = [KHRMeshQuantization, EXTMeshoptCompression, KHRDracoMeshCompression];
const geometryExtensionNames: string[] = geometryExtensions.map((extension) => extension.EXTENSION_NAME);

/**
 * Decodes accessors, those in streams of Draco too, by glTF-Transform. It gets no more of the file than its meshes, so that nothing else can
 * make it fail.
 */
export async function decodeDraco(
  json: GLTF.IGLTF,
  buffers: readonly (Uint8Array | undefined)[],
): Promise<AccessorData[]> {
  const { asset, bufferViews = [], accessors = [], meshes = [] } = json;
  const used = new Set(json.extensionsUsed?.filter((name) => geometryExtensionNames.includes(name)));
  used.add('KHR_draco_mesh_compression');

  const resources: Record<string, Uint8Array> = {};
  const bufferDefs = (json.buffers ?? []).map((buffer, b) => {
    resources[`buffer${b}`] = buffers[b] ?? new Uint8Array(0);
    return { ...buffer, uri: `buffer${b}` };
  });
  const io = new NodeIO().setLogger(new Logger(Logger.Verbosity.SILENT)).registerExtensions([...geometryExtensions]);
  if (bufferViews.some(meshoptView)) {
    used.add('EXT_meshopt_compression');
    io.registerDependencies({ 'meshopt.decoder': await meshoptDecoder() });
  }
  io.registerDependencies({ 'draco3d.decoder': await createDracoDecoder() });
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
