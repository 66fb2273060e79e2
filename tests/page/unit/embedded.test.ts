import assert from 'node:assert/strict';
import { test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { readGltfHead } from '../../../web/src/loading/gltf-file';
import { type Embedded, embed, embeddedIn } from '../../../web/src/platform/embedded';
import { glbOf, tetrahedron } from '../../support/glb';

const model = new Uint8Array(glbOf(tetrahedron(), 'figure'));
const cage: Embedded = {
  name: 'figure-cage.glb',
  type: 'model/gltf-binary',
  bytes: new Uint8Array(glbOf(tetrahedron(2), 'cage')),
};
const paint: Embedded = { name: 'paint.png', type: 'image/png', bytes: Uint8Array.of(0x89, 0x50, 0x4e, 0x47, 1, 2, 3) };
const bytesOf = async (file: File | undefined) => file && new Uint8Array(await file.arrayBuffer());
const find = (glb: Uint8Array<ArrayBuffer>, key: string, change = (json: object): object => json) =>
  embeddedIn(glb.buffer, change(readGltfHead(glb.buffer).json), key);

test('what is put into a model comes out as it was, and other programs show the model alone', async () => {
  const glb = embed(model, { cage, paint });
  for (const [key, { name, bytes }] of Object.entries({ cage, paint })) {
    const file = find(glb, key);
    assert.equal(file?.name, name);
    assert.deepEqual(await bytesOf(file), bytes);
  }
  assert.equal(find(model, 'cage'), undefined);
  const { scene, scenes } = await new GLTFLoader().parseAsync(glb.buffer, '');
  const seen: string[] = [];
  scene.traverse(({ name, type }) => void (type === 'Mesh' && seen.push(name)));
  assert.deepEqual([seen, scenes.length], [['figure'], 1]);
  const document = await new NodeIO().readBinary(glb);
  assert.deepEqual(document.getRoot().listMeshes().length, 1);
});

test('an image that the model has already takes no room, nor does what was put in before', () => {
  const glb = embed(model, { cage, paint });
  const again = embed(glb, { cage, paint: { ...paint, name: 'p.png' } });
  assert.ok(Math.abs(again.length - glb.length) < 16, `${again.length - glb.length} bytes more`);
  assert.ok(glb.length < model.length + cage.bytes.length + paint.bytes.length + 500);
});

test('what another program has moved or cut, or somebody has made up, is left out', () => {
  const glb = embed(model, { cage, paint });
  type Json = {
    bufferViews: { byteOffset?: number; byteLength: number }[];
    extras: { cagecast: { cage: Record<string, unknown> } };
  };
  const faults: ((json: Json) => unknown)[] = [
    (json) => (json.bufferViews = []),
    (json) => (json.extras.cagecast.cage['bufferView'] = 0),
    (json) => (json.extras.cagecast.cage['bufferView'] = -1),
    (json) => (json.bufferViews.at(-2)!.byteLength = 1e9),
    (json) => (json.bufferViews.at(-2)!.byteOffset = -4),
    (json) => (json.extras.cagecast.cage['type'] = 'text/html'),
    (json) => (json.extras.cagecast.cage['name'] = 7),
    (json) => ((json.extras as object) = { cagecast: null }),
    (json) => ((json.extras as object) = { cagecast: { cage: 'x' } }),
  ];
  for (const fault of faults)
    assert.equal(
      find(glb, 'cage', (json) => {
        fault(json as Json);
        return json;
      }),
      undefined,
      String(fault),
    );
});
