import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { CagecastError, init, transfer } from 'cagecast';
import { loadTemplate, type TemplateName, templateNames } from 'cagecast/cages';
import { cagecast } from '../support/gltf.js';
import { readPlain } from './scenes.js';

before(init);

interface Extras {
  kind: string;
  landmarks: Record<string, [number, number, number]>;
  holes: Record<string, number[]>;
}

/** Spots from where an axis is largest to where it is smallest. */
type Order = readonly [axis: 0 | 1 | 2, ...spots: string[]];
const kFaceOrder: Order = [1, 'crown', 'forehead', 'nasion', 'nose_tip', 'lip_upper', 'lip_lower', 'chin'];
const kEyeOrder: Order = [
  0,
  'eye_outer_left',
  'eye_centre_left',
  'eye_inner_left',
  'eye_inner_right',
  'eye_outer_right',
];

/** Each template, the folder of the model that it was made along with, and what it must name. */
const kTemplates: readonly {
  name: TemplateName;
  model: string;
  kind: string;
  landmarks: string[];
  holes: string[];
  orders: Order[];
}[] = [
  {
    name: 'human-head',
    model: 'human',
    kind: 'head',
    landmarks: [
      'nose_tip',
      'crown',
      'occiput',
      'chin',
      'nape',
      'eye_centre_left',
      'ear_top_right',
      'mouth_corner_left',
    ],
    holes: ['eye_left', 'eye_right', 'mouth', 'neck'],
    orders: [kFaceOrder, kEyeOrder, [2, 'nose_tip', 'lip_upper', 'ear_lobe_left', 'nape', 'occiput']],
  },
  {
    name: 'human-body',
    model: 'human-body',
    kind: 'body',
    landmarks: [
      ...[
        'nose_tip',
        'crown',
        'eye_inner_left',
        'collar_front',
        'shoulder_left',
        'elbow_right',
        'wrist_left',
        'hip_left',
      ],
      ...['finger_thumb_left', 'finger_pinky_right', 'knee_left', 'ankle_right', 'heel_left', 'toe_big_left'],
      ...['joint_hips', 'joint_spine', 'joint_chest', 'joint_neck', 'joint_head', 'joint_clavicle_left'],
      ...['joint_shoulder_left', 'joint_elbow_right', 'joint_wrist_left', 'joint_hip_right', 'joint_knee_left'],
      ...['joint_ankle_left', 'joint_eye_right', 'joint_jaw'],
    ],
    holes: ['eye_left', 'eye_right', 'mouth'],
    orders: [
      kFaceOrder,
      kEyeOrder,
      [
        1,
        'menton',
        'collar_back',
        'joint_shoulder_left',
        'elbow_left',
        'hip_left',
        'knee_left',
        'ankle_left',
        'heel_left',
      ],
      [0, 'finger_middle_left', 'wrist_left', 'elbow_left', 'shoulder_left', 'hip_left', 'knee_left', 'nose_tip'],
      [2, 'finger_thumb_left', 'finger_index_left', 'finger_middle_left', 'finger_ring_left', 'finger_pinky_left'],
      [2, 'toe_big_left', 'collar_front', 'knee_left', 'elbow_left', 'collar_back'],
    ],
  },
  {
    name: 'animal-head',
    model: 'animal-head',
    kind: 'head',
    landmarks: ['nose_tip', 'crown', 'nape', 'chin', 'eye_centre_left', 'ear_top_right', 'mouth_corner_left'],
    holes: ['eye_left', 'eye_right', 'mouth', 'neck'],
    orders: [
      kEyeOrder,
      [2, 'nose_tip', 'chin', 'forehead', 'crown', 'nape'],
      [1, 'ear_top_left', 'crown', 'nose_tip', 'chin'],
    ],
  },
  {
    name: 'car',
    model: 'car',
    kind: 'prop',
    landmarks: ['bumper_front', 'roof', 'corner_front_left', 'wheel_rear_centre_right', 'mirror_left'],
    holes: ['window_front', 'window_side_rear_left', 'light_front_right', 'grille', 'underside', 'wheel_front_left'],
    orders: [
      [
        2,
        'bumper_front',
        'corner_front_left',
        'wheel_front_centre_left',
        'mirror_left',
        'roof',
        'corner_rear_left',
        'bumper_rear',
      ],
      [1, 'roof', 'windscreen_top', 'windscreen_bottom', 'bonnet_front', 'bumper_front'],
      [0, 'mirror_left', 'sill_front_left', 'roof_corner_front_left', 'roof', 'mirror_right'],
    ],
  },
];

const load = async (name: string) => {
  const bytes = readFileSync(`examples/samples/templates/${name}.glb`);
  const document = await new NodeIO().readBinary(new Uint8Array(bytes));
  const meshes = document.getRoot().listMeshes();
  assert.equal(meshes.length, 1);
  return { bytes, extras: meshes[0]!.getExtras() as unknown as Extras };
};

describe('loadTemplate', () => {
  test('knows every template that is checked in, and gives its cage, landmarks and holes', async () => {
    assert.deepEqual([...templateNames].sort(), kTemplates.map(({ name }) => name).sort());
    for (const name of templateNames) {
      const cage = await loadTemplate(name);
      const plain = await readPlain(`examples/samples/templates/${name}.glb`);
      const { extras } = await load(name);
      assert.deepEqual(
        cage.positions.map((x) => x + 0), // not -0
        plain.positions,
      );
      assert.deepEqual(cage.uvs, plain.uvs);
      assert.deepEqual(cage.indices, plain.indices);
      assert.deepEqual({ landmarks: cage.landmarks, holes: cage.holes, kind: cage.kind }, extras);
    }
  });

  test('refuses other names, and says which there are', async () => {
    await assert.rejects(loadTemplate('dog' as TemplateName), (error) => {
      assert.ok(error instanceof CagecastError);
      assert.equal(error.code, 'badArgument');
      assert.match(error.message, /^loadTemplate: name is "dog", not one of "human-head", "human-body"/);
      return true;
    });
  });
});

describe('cagecast fit', () => {
  test('takes the name of a template for its file', () => {
    const { status, stderr } = cagecast('fit', 'car', 'no-such.glb', '-o', 'build/no-cage.glb');
    assert.equal(status, 1);
    assert.match(stderr, /no-such\.glb/); // the template was read before
    assert.match(cagecast('fit', 'dog', 'no-such.glb', '-o', 'build/no-cage.glb').stderr, /dog/);
  });
});

describe('the template', () => {
  for (const { name, model, kind, landmarks, holes, orders } of kTemplates)
    describe(name, () => {
      test('has at most 60 kB', async () => {
        const { bytes } = await load(name);
        assert.ok(bytes.length <= 60_000, `${bytes.length} bytes`);
      });

      test('names its kind, landmarks and holes', async () => {
        const { extras } = await load(name);
        const { positions } = await readPlain(`examples/samples/templates/${name}.glb`);
        assert.equal(extras.kind, kind);
        for (const spot of landmarks) assert.equal(extras.landmarks[spot]?.length, 3, spot);
        for (const [spot, [x, y, z]] of Object.entries(extras.landmarks)) {
          const [other, sign] = spot.endsWith('_left') ? [spot.replace(/left$/, 'right'), -1] : [spot, 1];
          assert.deepEqual(extras.landmarks[other], [x === 0 ? 0 : sign * x, y, z], spot);
          assert.ok(/_(left|right)$/.test(spot) || x === 0, `${spot} is off the plane of symmetry`);
        }
        // Rays may go through a hole, or hit a hand before a hip.
        const isOrdered = (axis: number, ...spots: string[]): boolean =>
          spots.every((spot, i) => i === 0 || extras.landmarks[spot]![axis]! < extras.landmarks[spots[i - 1]!]![axis]!);
        for (const [axis, ...spots] of orders) assert.ok(isOrdered(axis, ...spots), spots.join(' > '));
        for (const hole of holes) assert.ok(extras.holes[hole]!.length >= 3, hole);
        for (const [hole, loop] of Object.entries(extras.holes))
          for (const v of loop) assert.ok(v >= 0 && 3 * v < positions.length, `${hole}: ${v}`);
      });

      test('has UVs that are their own mirror image', async () => {
        const { positions, uvs } = await readPlain(`examples/samples/templates/${name}.glb`);
        const places = new Map<string, number[]>();
        const keyOf = (x: number, y: number, z: number): string => [x, y, z].map((a) => Math.round(a * 1e5)).join(' ');
        for (let v = 0; 3 * v < positions.length; v++) {
          const key = keyOf(positions[3 * v]!, positions[3 * v + 1]!, positions[3 * v + 2]!);
          places.set(key, [...(places.get(key) ?? []), v]);
        }
        for (let v = 0; 3 * v < positions.length; v++) {
          const key = keyOf(-positions[3 * v]! + 0, positions[3 * v + 1]!, positions[3 * v + 2]!);
          const [u, w] = [uvs![2 * v]!, uvs![2 * v + 1]!];
          const twin = places
            .get(key)
            ?.some((o) => Math.abs(uvs![2 * o]! + u - 1) < 1e-5 && Math.abs(uvs![2 * o + 1]! - w) < 1e-5);
          assert.ok(twin, `vertex ${v}`);
        }
      });

      test('fits the model that it was made for', async () => {
        const cage = await readPlain(`examples/samples/templates/${name}.glb`);
        const target = await readPlain(`examples/samples/${model}/target.glb`);
        const truth = JSON.parse(readFileSync(`examples/samples/${model}/truth.json`, 'utf8'));
        const { zones } = transfer(cage, target);
        const isLabelled = (label: string, v: number): boolean => truth[label][v] === '1';
        const scored = Array.from(zones, (_, v) => v).filter((v) => !isLabelled('ignore', v));
        const forbidden = scored.filter((v) => isLabelled('ncz', v));
        const skin = scored.filter((v) => !isLabelled('ncz', v) && !isLabelled('offTemplate', v));
        const suppressed = forbidden.filter((v) => zones[v] !== 0).length / forbidden.length;
        const kept = skin.filter((v) => zones[v] === 0).length / skin.length;
        assert.equal(suppressed, 1);
        assert.ok(kept >= 0.997, `kept ${kept}`);
      });
    });
});
