import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bone, Group, type Vector3 } from 'three';
import { findFace, patchesOf } from '../../../web/src/tools/paint/face-photo';
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

test('a photo of a face is seen from the front: its eyes on those of the cage, nothing on what is behind or far away', () => {
  const face = findFace({ eye_centre_left: [1, 5, 0], eye_inner_right: [-0.5, 5, 0], eye_outer_right: [-1.5, 5, 0] })!;
  assert.equal(findFace({ eye_centre_left: [1, 5, 0] }), undefined);
  const triangle = [-1, 5, 0, 1, 5, 0, 0, 7, 0.5]; // between the eyes and the forehead
  const moved = (x: number, z: number) => triangle.map((value, i) => value + [x, 0, z][i % 3]!);
  const positions = Float32Array.from([...triangle, ...moved(0, -4), ...moved(9, 0)]);
  const uvs = Float32Array.from([0, 0, 1, 0, 0.5, 1, ...Array(12).fill(0)]);
  const indices = Uint32Array.from([0, 1, 2, 0, 2, 1, 3, 4, 5, 6, 7, 8]); // the same from behind, at the back, beside
  const patches = patchesOf({ positions, indices, uvs }, face);
  assert.equal(patches.length, 1);
  const [{ from, to }] = patches as [(typeof patches)[0]];
  const [[x, y], [x2, y2], [x3, y3]] = from as [[number, number], [number, number], [number, number]];
  assert.equal(y, y2);
  assert.ok(
    Math.abs(x + x2 - 2 * x3) < 1e-3 && Math.abs(x2 - x - (y - y3)) < 1e-3,
    'a distance of the eyes up is as long as one across',
  );
  assert.deepEqual(to[2], [1024, 2048]);
});
