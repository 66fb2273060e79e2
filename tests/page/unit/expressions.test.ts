import assert from 'node:assert/strict';
import { test } from 'node:test';
import { titleOfExpression, titleOfMorph } from '../../../web/src/tools/live/expression-names';
import { expressionsOf } from '../../../web/src/tools/live/expressions';

test('names of ARKit, VRoid and VRM in words; others stay as they are', () => {
  const names = ['browOuterUpRight', 'mouthSmileLeft', 'mouthLeft', 'jawOpen', 'cheekPuff', 'eyeLookInLeft'];
  assert.deepEqual([...names, 'Fcl_EYE_Close_L', 'Fcl_ALL_Joy', 'grow', 'Smile_L', 'eyelash'].map(titleOfMorph), [
    'Right brow: outer up',
    'Mouth: smile, left',
    'Mouth: left',
    'Jaw: open',
    'Cheek: puff',
    'Left eye: look in',
    'Eyes: close, left',
    'Face: joy',
    'grow',
    'Smile_L',
    'eyelash',
  ]);
  const titles = ['Relaxed', 'Surprised', 'Look up', 'Ee'];
  assert.deepEqual(['fun', 'surprised', 'lookUp', 'E'].map(titleOfExpression), titles);
});

test('the expressions of a VRM 0 and of a VRM 1 are weights of morphs, by name; what is wrong in a file is none', () => {
  const mesh = { morphTargetDictionary: { eyeBlinkLeft: 0, aa: 1 }, morphTargetInfluences: [0, 0] };
  const read = (extensions: object) =>
    expressionsOf(
      { parser: { associations: new Map([[mesh as object, { nodes: 2, meshes: 0 }]]), json: { extensions } } },
      { primitives: [{ mesh }] } as never,
    ).map(({ title, weights }) => [title, Object.fromEntries(weights)]);
  const blink = { isBinary: true, morphTargetBinds: [{ node: 2, index: 0, weight: 1 }] };
  const mouth = { morphTargetBinds: [{ node: 2, index: 1, weight: 0.5 }] };
  const elsewhere = { morphTargetBinds: [{ node: 9, index: 1, weight: 1 }] };
  assert.deepEqual(
    read({ VRMC_vrm: { expressions: { preset: { blinkLeft: blink, aa: mouth }, custom: { elsewhere } } } }),
    [
      ['Blink left', { eyeBlinkLeft: 1 }],
      ['Aa', { aa: 0.5 }],
    ],
  );
  const groups = [
    { presetName: 'blink_l', binds: [{ mesh: 0, index: 0, weight: 100 }] },
    { presetName: 'unknown', name: 'Happy', binds: [{ mesh: 0, index: 1, weight: 80 }] },
    { name: 'wrong', binds: [{ mesh: 0, index: 7, weight: 80 }, { mesh: 0, index: 'x' }, 3] },
    7,
  ];
  assert.deepEqual(read({ VRM: { blendShapeMaster: { blendShapeGroups: groups } } }), [
    ['Blink left', { eyeBlinkLeft: 1 }],
    ['Happy', { aa: 0.8 }],
  ]);
  for (const wrong of [{}, { VRM: 7 }, { VRMC_vrm: { expressions: [] } }]) assert.deepEqual(read(wrong), []);
});
