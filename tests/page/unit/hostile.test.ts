import assert from 'node:assert/strict';
import { test } from 'node:test';
import { readProject, writeProject } from '../../../web/src/project/container';
import { loadModel } from '../../../web/src/scene/load-model';
import { GlbMaker, tetrahedron } from '../../support/glb';

/** A file of this many nodes that show one mesh. */
function instances(count: number): File {
  const maker = new GlbMaker();
  const mesh = maker.mesh(tetrahedron());
  for (let n = 0; n < count; ++n) maker.node({ mesh });
  return new File([new Uint8Array(maker.finish())], 'many.glb');
}

test('a model that would take all memory is refused before it is loaded', async () => {
  const message =
    'many.glb: the positions of meshes[0] are in 2000 places of the scene; the limit "instances" is 1,000';
  await assert.rejects(loadModel(instances(2000), undefined), { message });
});

test('a model that refers to other files counts them', async () => {
  const maker = new GlbMaker();
  maker.node({ mesh: maker.mesh(tetrahedron()) });
  maker.json.buffers!.push({ byteLength: 8, uri: 'more.bin' });
  maker.json.accessors[0]!.count = 3_000_000;
  delete maker.json.accessors[0]!.bufferView;
  const file = new File([new Uint8Array(maker.finish())], 'box.glb');
  await assert.rejects(loadModel(file, undefined), /box\.glb: the model needs the file more\.bin/);
  const more = new File([new Uint8Array(8)], 'more.bin');
  await assert.rejects(
    loadModel(file, undefined, [more]),
    /box\.glb: .*TEXCOORD_0 has 4 elements for 3000000 vertices/,
  );
});

test('a text that begins as a project does is no project, nor one of a newer page', async () => {
  const text = new Blob(['CAGECAST: how to paint many models at once']);
  await assert.rejects(readProject(text), { message: 'this is not a Cagecast project' });
  const bytes = new Uint8Array(await writeProject({}, new Map()).arrayBuffer());
  bytes[8] = 9; // the version
  await assert.rejects(readProject(new Blob([bytes])), /newer version/);
});
