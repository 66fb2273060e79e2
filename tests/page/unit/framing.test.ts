import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bone, Group } from 'three';
import { frontOf } from '../../../web/src/view/framing';

const names = [
  ['LeftArm', 'RightArm'],
  ['mixamorigLeftLeg', 'mixamorigRightLeg'],
  ['upperarm.l', 'upperarm.r'],
  ['L_hand', 'R_hand'],
  ['左腕', '右腕'],
] as const;

/** A skeleton that looks into a direction. */
function figure(angle: number, [left, right]: readonly [string, string]) {
  const scene = new Group();
  scene.rotation.y = angle;
  for (const [name, x] of [
    ['Head', 0],
    [left, 0.4],
    [right, -0.4],
  ] as const) {
    const bone = new Bone();
    bone.position.set(x, 1, 0);
    bone.userData['name'] = name;
    scene.add(bone);
  }
  return { loaded: { scene: new Group().add(scene) } } as never;
}

test('a model is seen from where its bones say that its front is', () => {
  for (const pair of names)
    for (const angle of [-Math.PI / 2, 1, 3]) assert.ok(Math.abs(frontOf(figure(angle, pair)) - angle) < 1e-6, pair[0]);
  // Who stands a little askew is left so; and bones without sides say nothing.
  assert.equal(frontOf(figure(0.5, names[0])), 0);
  assert.equal(frontOf(figure(2, ['Spine', 'Neck'])), 0);
  assert.equal(
    frontOf({ loaded: { scene: new Group(), parser: { json: { extensions: { VRM: {} } } } } } as never),
    Math.PI,
  );
});
