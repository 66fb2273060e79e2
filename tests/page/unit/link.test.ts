import assert from 'node:assert/strict';
import { test } from 'node:test';
import { maxLayers } from '#three';
import { type LinkState, readLink, writeLink } from '../../../web/src/export/link';
import { Strokes } from '../../../web/src/export/strokes';
import { kFirstView } from '../../../web/src/state/view-state';
import { webpOf } from '../../support/files/costly';

const state: LinkState = {
  sample: 'human',
  layers: [
    { paint: 'human/war paint.png', opacity: 0.25, tint: '#ff8020', blend: 'multiply', visible: false },
    { paint: 'checker', opacity: 1, tint: '#ffffff', blend: 'normal', visible: true },
  ],
  rules: { preset: 'paper', threshold: 0.35, weldTolerance: 1e-6, borders: 'cut' },
  locks: { 0: 'exclude', 7: 'keep', 8: 'keep', 12: 'always', 13: 'out' },
  view: {
    mode: 'zones',
    split: 0.5,
    step: 0,
    paint: false,
    cage: true,
    seeThrough: true,
    light: 'evening',
    background: '#204060',
  },
  shape: { deform: 'twist', amount: -0.5, cage: false, morphs: new Map([['smile, wide', 0.75]]) },
  angle: { turn: -4, tilt: 74, near: 1.331 },
};

test('a link restores what it was written from', () => {
  assert.deepEqual(readLink(`#${writeLink(state)}`), state);
  const plain = { ...state, layers: undefined, shape: undefined, angle: undefined, locks: {}, view: kFirstView };
  assert.deepEqual(readLink(writeLink(plain)), plain);
  assert.deepEqual(readLink(writeLink({ ...plain, layers: [] }))!.layers, []);
  const closer = { ...state, angle: { turn: 30, tilt: 80, near: 2, at: [0.25, -0.5, 0] as const } };
  assert.deepEqual(readLink(writeLink(closer)), closer);
  const { at: _, ...middle } = closer.angle;
  for (const wrong of ['0.25,-0.5,7', '0.25,-0.5', 'x,0,0', '0,0,Infinity'])
    assert.deepEqual(readLink(`#sample=human&angle=30,80,2,${wrong}`)!.angle, middle);
  assert.equal(
    writeLink({ ...plain, shape: { deform: 'bend', amount: 0, cage: true, morphs: new Map() } }),
    'sample=human&rules=paper&threshold=0.35&borders=cut&weld=0.000001&view=compare&split=0.500',
  );
});

test('a link has no more layers than the page, and no weights that are out of range', () => {
  const many = readLink(`#sample=human${'&layer=checker'.repeat(20_000)}${'&morph=1,a'.repeat(20_000)}&morph=1e9,b`)!;
  assert.equal(many.layers!.length, maxLayers);
  assert.deepEqual([...many.shape!.morphs], [['a', 1]]);
  assert.equal(readLink('#sample=human&morph=1e9,b&morph=-Infinity,c')!.shape, undefined);
});

test('strokes of a link have the sizes that the page writes, and are damaged or decoded else', async () => {
  const textOf = (bytes: Buffer) => `strokes:${bytes.toString('base64url')}`;
  for (const [width, height] of [
    [16_383, 4096],
    [512, 256],
    [1024, 1024],
    [1, 1],
  ] as const)
    await assert.rejects(Strokes.check(textOf(webpOf(width, height))), {
      message: `its strokes have ${width.toLocaleString('en')} × ${height.toLocaleString('en')} pixels, not 512 × 512 or 256 × 256`,
    });
  for (const size of [256, 512]) assert.ok((await Strokes.check(textOf(webpOf(size, size)))) instanceof File);
  for (const text of ['strokes:', 'strokes:%%%', 'strokes:AAAA', textOf(Buffer.from('RIFF'))])
    assert.equal(await Strokes.check(text), undefined);
  await assert.rejects(Strokes.check(textOf(Buffer.from('GIF89a\xff\xff\xff\xff', 'latin1'))), /65,535 × 65,535/);
});

test('of a link that is old, cut short or edited by hand, what is wrong has its default', () => {
  assert.equal(readLink(''), undefined);
  assert.equal(readLink('#rules=paper'), undefined);
  assert.deepEqual(
    readLink(
      '#sample=lizard&layer=a.png,7,red&rules=none&threshold=9&weld=1&keep=1,x,99999&view=none&split=-3&angle=1,x,-3&deform=bend,7&morph=x,y&morph=2&light=sun&background=red&paint',
    ),
    {
      sample: 'lizard',
      layers: [{ paint: 'a.png', opacity: 1, tint: '#ffffff', blend: 'normal', visible: true }],
      rules: { preset: 'default', threshold: 0.5, weldTolerance: 0, borders: 'triangle' },
      locks: { 1: 'keep', 99999: 'keep' },
      view: kFirstView,
      shape: undefined,
      angle: undefined,
    },
  );
});
