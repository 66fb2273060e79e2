import assert from 'node:assert/strict';
import { test } from 'node:test';
import { sortFiles } from '../../../web/src/state/intake';

const ignored = (what: string): string =>
  `${what} ignored: only one target, one cage and one paint can be opened at a time.`;

for (const [files, roles, warning] of [
  ['a.glb', { target: 'a.glb' }],
  ['cage.glb', { cage: 'cage.glb' }],
  ['body.vrm body-Cage.glb skin.png', { target: 'body.vrm', cage: 'body-Cage.glb', texture: 'skin.png' }],
  ['a.glb b.glb', { unclear: 'a.glb b.glb' }],
  ['cage-a.glb cage-b.glb', { unclear: 'cage-a.glb cage-b.glb' }],
  ['a.glb cage.glb notes.txt c.glb', { target: 'a.glb', cage: 'cage.glb' }, ignored('notes.txt and 1 more were')],
  ['skin.jpeg other.webp', { image: 'other.webp' }, ignored('skin.jpeg was')],
  ['scene.gltf scene.bin skin.png', { target: 'scene.gltf' }], // the image belongs to the model
  ['scene.gltf scene.bin cage.gltf', { target: 'scene.gltf', cage: 'cage.gltf' }],
  ['thing.obj thing.png', { target: 'thing.obj', texture: 'thing.png' }],
  ['thing.obj thing.mtl thing.png', { target: 'thing.obj' }], // the image belongs to the model
  ['thing.fbx cage.obj', { target: 'thing.fbx', cage: 'cage.obj' }],
  ['thing.blend thing.png', { target: 'thing.blend', texture: 'thing.png' }], // so that it is said what it is
  ['notes.txt', { target: 'notes.txt' }],
  ['skin.png notes.txt', { image: 'skin.png' }, ignored('notes.txt was')],
  ['work.cagecast a.glb', { project: 'work.cagecast' }],
] as const)
  test(`${files}: ${JSON.stringify(roles)}`, () => {
    const { warnings, all, unclear, ...found } = sortFiles(files.split(' ').map((name) => new File([], name)));
    const names = Object.entries(found).flatMap(([role, file]) => (file ? [[role, file.name]] : []));
    if (unclear.length > 0) names.push(['unclear', unclear.map(({ name }) => name).join(' ')]);
    assert.deepEqual(Object.fromEntries(names), roles);
    assert.deepEqual(warnings, warning ? [warning] : []);
    assert.equal(all.length, files.split(' ').length);
  });
