import assert from 'node:assert/strict';
import { test } from 'node:test';
import { deflateRawSync } from 'node:zlib';
import { maxLayers } from '#three';
import { type LinkState, type Look, readLink, readLook, writeLink, writeLook } from '../../../web/src/export/link';
import { packTexels, type Texels, unpackTexels } from '../../../web/src/export/packed-texels';
import { kFirstView } from '../../../web/src/state/view-state';

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
    left: 'naive',
    right: 'result',
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
  const halves = { ...plain, view: { ...kFirstView, left: 'paper', right: 'rays' } as const };
  assert.deepEqual(readLink(writeLink(halves)), halves);
  assert.match(writeLink(halves), /&view=compare&split=0\.500&left=paper&right=rays$/);
  assert.deepEqual(readLink('#sample=human&left=best&right=')!.view, kFirstView);
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

test('a link has a look for a template of the page, in few letters', () => {
  const look: Look = { template: 'human-head', layers: state.layers!, light: 'evening', background: '#204060' };
  assert.deepEqual(readLook(`#${writeLook(look)}`), look);
  const plain = { template: 'car', layers: [state.layers![1]!], light: 'studio', background: '' } as const;
  assert.equal(writeLook({ ...plain, layers: [...plain.layers] }), 'look=car&layer=checker,1,ffffff,normal');
  assert.equal(readLook('#look=car&lay'), undefined, 'cut off before its layers');
  for (const other of ['', 'look=car', '#sample=car', '#look=', '#look=octopus', '#look=toString', '#look=car%00'])
    assert.equal(readLook(other), undefined, other);
  assert.equal(readLink('#look=car'), undefined);
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

/** Strokes with soft borders, in as many colours, on a sheet. */
function strokes(size: number, colors: readonly (readonly [number, number, number])[], length = 0.2): Texels {
  const data = new Uint8ClampedArray(4 * size * size);
  colors.forEach((color, i) => {
    const [fromX, fromY] = [0.1 + ((i * 0.37) % 0.7), 0.1 + ((i * 0.53) % 0.7)];
    for (let step = 0; step < 200; step++) {
      const along = (step / 200) * length;
      const [x, y] = [(fromX + along) * size, (fromY + 0.3 * along + 0.02 * Math.sin(30 * along)) * size];
      const radius = 0.012 * size;
      for (let v = Math.floor(y - radius); v <= y + radius; v++)
        for (let u = Math.floor(x - radius); u <= x + radius; u++) {
          const alpha = 255 * Math.min(1, Math.max(0, (radius - Math.hypot(u - x, v - y)) / 2));
          const at = 4 * (v * size + u);
          if (alpha > data[at + 3]!) data.set([...color, alpha], at);
        }
    }
  });
  return { width: size, height: size, data };
}

const kBrushes = Array.from({ length: 8 }, (_, i) => [30 * i + 7, 255 - 29 * i, (91 * i) % 256] as const);

test('strokes that were packed keep their colours, and their alpha but for a step', async () => {
  for (const size of [512, 256]) {
    const drawn = strokes(size, kBrushes);
    const found = (await unpackTexels(await packTexels(drawn)))!;
    assert.deepEqual([found.width, found.height], [size, size]);
    for (let at = 0; at < drawn.data.length; at += 4) {
      assert.ok(Math.abs(found.data[at + 3]! - drawn.data[at + 3]!) <= 9);
      if (found.data[at + 3]! > 0)
        assert.deepEqual([...found.data.subarray(at, at + 3)], [...drawn.data.subarray(at, at + 3)]);
    }
  }
});

test('a look of a few strokes is small enough for a link, and what is packed once packs the same again', async () => {
  const text = await packTexels(strokes(512, kBrushes));
  assert.ok(text.length < 5000, `${text.length} letters of eight strokes`);
  assert.match(text, /^[\w-]+$/);
  assert.equal(await packTexels((await unpackTexels(text))!), text);
  const one = await packTexels(strokes(512, kBrushes.slice(0, 1)));
  assert.ok(one.length < 1000, `${one.length} letters of a stroke`);
});

test('a photo loses colours, but not their place', async () => {
  const photo = strokes(256, [[0, 0, 0]], 0.5);
  for (let at = 0; at < photo.data.length; at += 4)
    photo.data.set([(at >> 2) % 256, (at >> 10) % 256, (at * 7) % 256], at);
  const { data } = (await unpackTexels(await packTexels(photo)))!;
  let [apart, count] = [0, 0];
  for (let at = 0; at < data.length; at += 4) {
    if (data[at + 3] === 0) continue;
    count++;
    for (const channel of [0, 1, 2]) apart += Math.abs(data[at + channel]! - photo.data[at + channel]!) / 3;
  }
  assert.ok(apart / count < 40, `${apart / count} of 255`);
});

test('nothing drawn is an empty text', async () => {
  assert.equal(await packTexels({ width: 256, height: 256, data: new Uint8ClampedArray(4 * 256 * 256) }), '');
});

test('what was cut off, or changed, or claims more than a sheet, is damaged', async () => {
  const text = await packTexels(strokes(256, kBrushes));
  for (const cut of [0, 1, 7, Math.floor(text.length / 2), text.length - 3])
    assert.equal(await unpackTexels(text.slice(0, cut)), undefined, `${cut} letters`);
  for (const wrong of ['%%%', 'UklGRg', text.replace(/^./, '_'), `${text.slice(0, 20)}AAAA${text.slice(24)}`])
    assert.equal(await unpackTexels(wrong), undefined, wrong.slice(0, 30));
  const packed = (...bytes: number[]) => deflateRawSync(Uint8Array.from(bytes)).toString('base64url');
  const corner = [0, 0, 0, 1, 0, 0, 0, 1, 1, 9, 9, 9, 0, 15]; // a texel
  assert.ok(await unpackTexels(packed(0, 0, ...corner)));
  assert.equal(await unpackTexels(packed(0, 3, ...corner)), undefined, 'of another size');
  assert.equal(await unpackTexels(packed(0, 0, ...corner, 0)), undefined, 'too long');
  assert.equal(await unpackTexels(packed(0, 0, ...corner.slice(0, -2), 1, 15)), undefined, 'without its colour');
  assert.equal(await unpackTexels(deflateRawSync(new Uint8Array(50e6)).toString('base64url')), undefined, 'a bomb');
});
