import assert from 'node:assert/strict';
import { test } from 'node:test';
import { BoxGeometry, Group, Mesh } from 'three';
import { bringNear } from '../../../web/src/loading/bring-near';

test('models far from the origin are moved near it, and their cages by the same', () => {
  const movedBy = (size: number, x: number): number => {
    const mesh = new Mesh(new BoxGeometry(size, size, size));
    mesh.position.x = x;
    const scene = new Group().add(mesh);
    bringNear(scene);
    return scene.position.x;
  };
  assert.equal(movedBy(2, 10), 0);
  assert.equal(movedBy(2, 1e6), -1e6);
  assert.equal(movedBy(0.3, 1e6 + 1), -1e6, 'a cage around its head');
  assert.equal(movedBy(2, 100), 0);
  assert.equal(movedBy(0.3, 101), 0, 'far by itself, but the model that it is for is not');
});
