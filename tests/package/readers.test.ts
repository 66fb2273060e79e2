// Every reader makes the same of a glTF: those of the package, of files, of documents and of what three.js has loaded, and the native one.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import type { CagecastError, Mesh } from 'cagecast';
import { cageModel, cageTemplate, checkGltf } from 'cagecast/gltf';
import { extract, type Loaded } from 'cagecast/three';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { Texture } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { loadFileLayer } from '../support/file-layer.js';
import { fileNameOf, type GltfFile, gltfFiles, type Reader } from '../support/gltf-files.js';
import { nativeCommand } from '../support/native.js';
import { temporaryFolder } from '../support/temporary.js';

await MeshoptDecoder.ready;
const files = await loadFileLayer();
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({ 'meshopt.decoder': MeshoptDecoder });
// What GLTFLoader expects of a page; pictures are not needed.
Object.assign(globalThis, { self: globalThis, ProgressEvent: Event });
const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
loader.register(() => ({ name: 'no pictures', loadTexture: async () => new Texture() }));

const isText = (bytes: Uint8Array): boolean => Buffer.from(bytes.subarray(0, 4)).toString() !== 'glTF';

/** What the native reader says of each file, by its name. */
const natively = (() => {
  const { at } = temporaryFolder('readers');
  const names = gltfFiles.map((file) => at(fileNameOf(file)));
  gltfFiles.forEach(({ bytes }, i) => writeFileSync(names[i]!, bytes));
  const lines = execFileSync(nativeCommand('cagecast_read_gltf'), names, { encoding: 'utf8' }).trim().split('\n');
  return new Map(gltfFiles.map(({ name }, i) => [name, lines[i]!]));
})();

const readers: Record<Reader, (file: GltfFile) => Promise<Mesh>> = {
  file: async (file) => files.extract(await files.readGltf(fileNameOf(file), files.defaultReading, file.bytes)).mesh,
  document: async ({ bytes }) => {
    const document = isText(bytes)
      ? await io.readJSON({ json: JSON.parse(Buffer.from(bytes).toString()), resources: {} })
      : await io.readBinary(Uint8Array.from(bytes));
    const { positions, indices, groups } = await cageModel(document);
    let uvs: Float32Array | undefined;
    try {
      ({ uvs } = cageTemplate(document));
    } catch (error) {
      if ((error as CagecastError).code !== 'missingUvs') throw error;
    }
    return { positions, indices, groups: groups!, ...(uvs && { uvs }) } as Mesh;
  },
  native: async ({ name }) => {
    const { error, uvs, ...mesh } = JSON.parse(natively.get(name)!);
    if (error) throw new Error(error);
    return { ...mesh, ...(uvs.length > 0 && { uvs }) };
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

test('the UVs of what GLTFLoader has loaded are those in its texture, loaded or not', async () => {
  const bare = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
  bare.register(() => ({ name: 'no textures', loadTexture: async () => null as never }));
  for (const { name, bytes, expected, not } of gltfFiles) {
    if (expected instanceof RegExp || (not && 'three' in not)) continue;
    const { uvs } = extract((await bare.parseAsync(Uint8Array.from(bytes).buffer, '')) as Loaded).mesh;
    assert.equal(uvs?.length, expected.uvs?.length, name);
    expected.uvs?.forEach((value, i) => assert.ok(Math.abs(uvs![i]! - value) < 1e-6, `${name}: ${[...uvs!]}`));
  }
});

test('checkGltf admits what can be read', () => {
  for (const { bytes, expected } of gltfFiles) if (!(expected instanceof RegExp)) checkGltf(bytes);
});
