import assert from 'node:assert/strict';
import { test } from 'node:test';
import { BoxGeometry, Mesh, type Texture } from 'three';
import { Beside } from '../../../web/src/view/wardrobe/beside';

/** A model of a box that stands beside others. */
const box = (width: number, height: number): Beside =>
  new Beside({ scene: new Mesh(new BoxGeometry(width, height, 0.1)) } as never, undefined, {} as Texture);

test('models of much the same shape stand equally high; others keep their size, or nearly so', () => {
  const [slim, wide, flat] = [box(0.5, 1.8), box(1.7, 1.8), box(4, 0.5)];
  assert.ok(wide.high < 0.8 * slim.high, 'arms that are out cost height at first');
  const own = wide.wide / wide.high;
  wide.match(slim.high);
  assert.ok(Math.abs(wide.high - slim.high) < 1e-6);
  assert.ok(Math.abs(wide.wide / wide.high - own) < 1e-6, 'as a whole');
  const before = flat.high;
  flat.match(slim.high);
  assert.ok(Math.abs(flat.high / before - 1.4) < 1e-6, 'a car does not stand as high as a figure');
  flat.match();
  assert.equal(flat.high, before);
  assert.equal(flat.holder.scale.x, flat.holder.scale.y);
});
