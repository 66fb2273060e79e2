import assert from 'node:assert/strict';
import { test } from 'node:test';
import { likelyTemplate } from '../../wasm/src/cages/likely-template.js';

const box = (size: readonly number[]) => Float32Array.from([3, 3, 3, ...size.map((extent) => 3 + extent)]);

test('the template is chosen by the shape: a figure is flat, a car is low, a head is neither', () => {
  for (const [size, template] of [
    [[1.7, 1.75, 0.35], 'human-body'], // arms stretched out
    [[55, 178, 40], 'human-body'], // arms at the sides, in centimetres
    [[0.18, 0.3, 0.24], 'human-head'],
    [[2.7, 2, 1.7], 'human-head'],
    [[1.8, 1.4, 4.4], 'car'],
    [[4.4, 1.4, 1.8], 'car'],
    [[1, 1, 1], 'human-head'],
  ] as const)
    assert.equal(likelyTemplate(box(size)), template);
});

test('names tell more than the shape: a figure has joints of arms and legs, a car has wheels', () => {
  const likely = (joints: string[], parts: string[]) => likelyTemplate(box([1, 1, 1]), { joints, parts });
  assert.equal(likely(['mixamorig:LeftUpLeg', 'mixamorig:LeftArm'], ['Body']), 'human-body');
  assert.equal(likely(['J_Bip_L_UpperLeg', 'J_Bip_L_Hand'], []), 'human-body');
  assert.equal(likely(['Head', 'Neck', 'Jaw'], ['Skin']), 'human-head');
  assert.equal(likely(['front_leg_l', 'tail'], ['Fur']), 'human-head', 'no arms');
  assert.equal(likely([], ['body', 'wheel_front_left']), 'car');
  assert.equal(likely([], ['Tire_FL']), 'car');
  assert.equal(likely([], ['tree', 'centre', 'tired_face']), 'human-head');
});
