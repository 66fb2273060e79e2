import assert from 'node:assert/strict';
import { test } from 'node:test';
import { titleOfExpression, titleOfMorph } from '../../../web/src/tools/live/expression-names';
import { expressionsOf, shownBy } from '../../../web/src/tools/live/expressions';

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

/** The expressions of a file with meshes that have these morphs; titles and weights. */
function read(extensions: object, ...meshes: string[][]) {
  const primitives = meshes.map((names) => ({
    mesh: {
      morphTargetDictionary: Object.fromEntries(names.map((name, place) => [name, place])),
      morphTargetInfluences: names.map(() => 0),
    },
  }));
  const associations = new Map(primitives.map(({ mesh }) => [mesh as object, { nodes: 2, meshes: 0 }]));
  return expressionsOf({ parser: { associations, json: { extensions } } }, { primitives } as never);
}
const weightsOf = (extensions: object, ...meshes: string[][]) =>
  read(extensions, ...meshes).map(({ title, weights }) => [title, Object.fromEntries(weights)]);

test('the expressions of a VRM 0 and of a VRM 1 are weights of morphs, by name; what is wrong in a file is none', () => {
  const names = ['lids', 'lips'];
  const blink = { isBinary: true, morphTargetBinds: [{ node: 2, index: 0, weight: 1 }] };
  const mouth = { morphTargetBinds: [{ node: 2, index: 1, weight: 0.5 }] };
  const elsewhere = { morphTargetBinds: [{ node: 9, index: 1, weight: 1 }] };
  const preset = { blinkLeft: blink, blink, happy: mouth, aa: mouth };
  assert.deepEqual(weightsOf({ VRMC_vrm: { expressions: { preset, custom: { elsewhere } } } }, names), [
    ['Smile', { lips: 0.5 }],
    ['Blink', { lids: 1 }],
    ['Speak', { lips: 0.5 }],
    ['Blink left', { lids: 1 }],
    ['Aa', { lips: 0.5 }],
  ]);
  const groups = [
    { presetName: 'blink_l', binds: [{ mesh: 0, index: 0, weight: 100 }] },
    { presetName: 'unknown', name: 'Wink', binds: [{ mesh: 0, index: 1, weight: 80 }] },
    { name: 'wrong', binds: [{ mesh: 0, index: 7, weight: 80 }, { mesh: 0, index: 'x' }, 3] },
    7,
  ];
  assert.deepEqual(weightsOf({ VRM: { blendShapeMaster: { blendShapeGroups: groups } } }, names), [
    ['Blink left', { lids: 1 }],
    ['Wink', { lips: 0.8 }],
  ]);
  for (const wrong of [{}, { VRM: 7 }, { VRMC_vrm: { expressions: [] } }])
    assert.deepEqual(weightsOf(wrong, names), []);
});

test('without a VRM, the names of morphs tell: of ARKit, Ready Player Me, VRoid, Oculus, and plain ones', () => {
  const kinds: [name: string, morphs: string[], smile: object, blink: object, speak: object][] = [
    [
      'ARKit',
      ['eyeBlinkLeft', 'eyeBlinkRight', 'mouthSmileLeft', 'mouthSmileRight', 'jawOpen', 'eyeLookUpLeft'],
      { mouthSmileLeft: 0.9, mouthSmileRight: 0.9 },
      { eyeBlinkLeft: 1, eyeBlinkRight: 1 },
      { jawOpen: 0.7 },
    ],
    [
      'ARKit, as other programs write it',
      ['face.eyeBlink_L', 'face.eyeBlink_R', 'face.mouthSmile_L', 'face.mouthSmile_R', 'face.jawOpen'],
      { 'face.mouthSmile_L': 0.9, 'face.mouthSmile_R': 0.9 },
      { 'face.eyeBlink_L': 1, 'face.eyeBlink_R': 1 },
      { 'face.jawOpen': 0.7 },
    ],
    [
      'Ready Player Me',
      ['mouthOpen', 'mouthSmile', 'mouthSmileLeft', 'eyesClosed', 'viseme_sil', 'viseme_aa', 'viseme_O'],
      { mouthSmile: 1 },
      { eyesClosed: 1 },
      { viseme_aa: 1 },
    ],
    [
      'VRoid',
      ['Fcl_ALL_Joy', 'Fcl_ALL_Angry', 'Fcl_EYE_Close', 'Fcl_EYE_Close_L', 'Fcl_MTH_A', 'Fcl_MTH_O'],
      { Fcl_ALL_Joy: 1 },
      { Fcl_EYE_Close: 1 },
      { Fcl_MTH_A: 1 },
    ],
    ['Oculus', ['Smile', 'Blink', 'aa', 'E', 'ih', 'oh', 'ou'], { Smile: 1 }, { Blink: 1 }, { aa: 1 }],
    [
      'plain',
      ['happy', 'Blink_Left', 'Blink_Right', 'mouth_open'],
      { happy: 1 },
      { Blink_Left: 1, Blink_Right: 1 },
      { mouth_open: 0.7 },
    ],
  ];
  for (const [kind, names, ...weights] of kinds)
    assert.deepEqual(
      weightsOf({}, names).slice(0, 3),
      ['Smile', 'Blink', 'Speak'].map((title, i) => [title, weights[i]]),
      kind,
    );
  assert.deepEqual(
    weightsOf({}, ['sad', 'surprised', 'angry']).map(([title]) => title),
    ['Sad', 'Surprised', 'Angry'],
  );
  assert.deepEqual(weightsOf({}, ['width', 'blinker', 'smiley', 'eyelid']), [], 'other morphs are no expressions');
});

test('an expression moves all meshes; a blink and speech end at rest', () => {
  const found = read({}, ['head.blink', 'head.A', 'head.U'], ['teeth.A'], ['lashes.blink']);
  assert.deepEqual(
    found.map(({ title, weights }) => [title, [...weights.keys()]]),
    [
      ['Blink', ['head.blink', 'lashes.blink']],
      ['Speak', ['head.A', 'teeth.A']],
    ],
  );
  for (const { sequence } of found) {
    const times = sequence!.map(([at]) => at);
    assert.deepEqual(
      times,
      [...times].sort((a, b) => a - b),
    );
    assert.equal(sequence!.at(-1)![1].size, 0);
  }
  const said = new Set(found[1]!.sequence!.flatMap(([, weights]) => [...weights.keys()]));
  assert.deepEqual([...said].sort(), ['head.A', 'head.U', 'teeth.A']);
});

test('weights that were set otherwise, as after a reload, show the expression that has them', () => {
  const weights = new Map([['mouthSmile', 1]]);
  const smile = { title: 'Smile', weights };
  const blink = { title: 'Blink', weights: new Map([['eyes', 1]]), sequence: [[0.1, new Map([['eyes', 1]])] as const] };
  assert.equal(shownBy([blink, smile], new Map([...weights, ['male', 0.3]])), smile);
  assert.equal(shownBy([smile], new Map([['mouthSmile', 0.5]])), undefined);
  assert.equal(shownBy([blink], new Map([['eyes', 1]])), undefined, 'a blink does not stay');
  assert.equal(shownBy([{ title: 'None', weights: new Map() }], weights), undefined);
});
