import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bone, Group, type Vector3 } from 'three';
import { faceOf } from '../../../web/src/view/face-of';

const kHeight = 1.8;
/** Feet, a head from 1.5 to 1.8, and raised hands. */
const positions = Float32Array.of(0, 0, 0, -0.1, 1.5, 0, 0.1, 1.6, 0.1, 0, kHeight, -0.1, 0.9, 1.75, 0, -0.9, 1.75, 0);

function figure(name: string) {
  const scene = new Group();
  for (const [y, bone] of [
    [1, 'Spine'],
    [1.5, name],
    [kHeight, `${name}Top_End`],
  ] as const) {
    const joint = new Bone();
    joint.position.y = y;
    joint.name = bone;
    scene.add(joint);
  }
  return { scene, mesh: { positions } } as never;
}

const rounded = (corners: Vector3[] | undefined): number[][] | undefined =>
  corners?.map((corner) => corner.toArray().map((value) => Math.round(100 * value) / 100));

test('the face of a figure is around the bone of its head, without raised hands', () => {
  for (const name of ['Head', 'mixamorigHead', 'Bip01_head', 'HEAD'])
    assert.deepEqual(
      rounded(faceOf(figure(name), undefined)),
      [
        [-0.1, 1.5, -0.1],
        [0.1, kHeight, 0.1],
      ],
      name,
    );
  assert.equal(faceOf(figure('Forehead'), undefined), undefined);
  assert.equal(faceOf(figure('ahead'), undefined), undefined);
});

test('landmarks of the cage tell better', () => {
  const scene = new Group();
  scene.userData['landmarks'] = {
    ...{ crown: [0, 1.8, 0], chin: [0, 1.55, 0.1], occiput: [0, 1.7, -0.1], ear_outer_left: [0.1, 1.65, 0] },
    joint_hips: [0, 1, 0],
  };
  assert.deepEqual(rounded(faceOf(figure('Head'), { scene })), [
    [0, 1.55, -0.1],
    [0.1, 1.8, 0.1],
  ]);
  scene.userData['landmarks'] = { crown: [0, 1.8, 0] };
  assert.deepEqual(rounded(faceOf(figure('Head'), { scene }))?.[0], [-0.1, 1.5, -0.1], 'too few of them');
});
