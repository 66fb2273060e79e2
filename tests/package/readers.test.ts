// Every reader of the package makes the same of a glTF: that of files, that of documents, and that of what three.js has loaded.
import assert from 'node:assert/strict';
import { describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import type { CagecastError, Mesh } from 'cagecast';
import { cageModel, cageTemplate, checkGltf } from 'cagecast/gltf';
import { extract } from 'cagecast/three';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { Texture } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { loadFileLayer } from '../support/file-layer.js';
import { fileNameOf, type GltfFile, gltfFiles, type Reader } from '../support/gltf-files.js';

await MeshoptDecoder.ready;
const files = await loadFileLayer();
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({ 'meshopt.decoder': MeshoptDecoder });
// What GLTFLoader expects of a page; pictures are not needed.
Object.assign(globalThis, { self: globalThis, ProgressEvent: Event });
const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
loader.register(() => ({ name: 'no pictures', loadTexture: async () => new Texture() }));

const isText = (bytes: Uint8Array): boolean => Buffer.from(bytes.subarray(0, 4)).toString() !== 'glTF';

const readers: Record<Exclude<Reader, 'native'>, (file: GltfFile) => Promise<Mesh>> = {
  file: async (file) => files.extract(await files.readGltf(fileNameOf(file), files.defaultReading, file.bytes)).mesh,
  document: async ({ bytes }) => {
    const document = isText(bytes)
      ? await io.readJSON({ json: JSON.parse(Buffer.from(bytes).toString()), resources: {} })
      : await io.readBinary(Uint8Array.from(bytes));
    const { positions, indices, groups } = cageModel(document);
    let uvs: Float32Array | undefined;
    try {
      ({ uvs } = cageTemplate(document));
    } catch (error) {
      if ((error as CagecastError).code !== 'missingUvs') throw error;
    }
    return { positions, indices, groups: groups!, ...(uvs && { uvs }) } as Mesh;
  },
  three: async ({ bytes }) => extract((await loader.parseAsync(Uint8Array.from(bytes).buffer, '')).scene).mesh,
};

for (const [reader, read] of Object.entries(readers)) {
  describe(`the reader of ${reader}`, () => {
    for (const file of gltfFiles) {
      if (file.not && reader in file.not) continue;
      test(file.name, async () => {
        const { expected } = file;
        if (expected instanceof RegExp) {
          await assert.rejects(read(file), expected);
          return;
        }
        const { positions, indices, groups, uvs } = await read(file);
        assert.deepEqual([...indices], expected.indices);
        assert.deepEqual([...groups!], expected.groups);
        assert.equal(uvs === undefined, expected.uvs === null, 'whether there are UVs');
        for (const [found, values] of [
          [positions, expected.positions],
          [uvs ?? [], expected.uvs ?? []],
        ] as const) {
          assert.equal(found.length, values.length);
          values.forEach((value, i) => assert.ok(Math.abs(found[i]! - value) < 1e-6, `${[...found]} is not ${values}`));
        }
      });
    }
  });
}

test('checkGltf admits what can be read', () => {
  for (const { bytes, expected } of gltfFiles) if (!(expected instanceof RegExp)) checkGltf(bytes);
});
