// Layers and painters as far as nothing is drawn: steps that can be undone, and what is refused.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import type { LoadedCage } from 'cagecast/three';
import { Group, Mesh, SphereGeometry, Texture } from 'three';
import { createLayers, createPainter, Edits, History, LayerStack, type Layers, type StickerPicture } from '#three';
import { imageSize } from '../../wasm/src/gltf/image-file.js';
import { jpegOf, pngOf, webpOf } from '../support/files/costly.js';
import { allocatedBy, renderer } from '../support/no-renderer.js';

const texture = new Texture();
const namesOf = ({ list }: Layers) => list.map(({ name }) => name);
const opacitiesOf = ({ list }: Layers) => list.map(({ opacity }) => opacity);

test('adding, removing and styling are steps of their own; equal changes in quick succession are one', () => {
  const layers = createLayers({ renderer });
  const undone = () => {
    layers.undo();
    return layers.list.length;
  };
  for (let i = 0; i < 3; ++i) layers.add(texture, { name: 'star' });
  assert.deepEqual([undone(), undone(), undone()], [2, 1, 0]);
  const [a, b] = [layers.add(texture, { name: 'star' }), layers.add(texture, { name: 'star' })];
  layers.remove(b);
  layers.remove(a);
  assert.deepEqual([undone(), undone()], [1, 2]);
  layers.set(a, { opacity: 0.5 });
  layers.set(b, { opacity: 0.2 });
  layers.undo();
  assert.deepEqual(opacitiesOf(layers), [0.5, 1]);
  layers.undo();
  for (const opacity of [0.9, 0.8, 0.7]) layers.set(a, { opacity });
  layers.undo();
  assert.deepEqual(opacitiesOf(layers), [1, 1]);
  assert.equal(layers.redo(), 'changing opacity of star');
});

test('a name is not given twice; what is undefined is as if it were not there; all of a layer may be given', () => {
  const layers = createLayers({ renderer });
  const first = layers.add(texture);
  layers.add(texture);
  layers.remove(first);
  layers.add(texture);
  assert.deepEqual(namesOf(layers), ['Layer 2', 'Layer 1']);

  const none = { opacity: undefined, tint: undefined, blend: undefined, visible: undefined } as object;
  const layer = layers.add(texture, none);
  layers.set(layer, { opacity: 0.5 });
  layers.set(layer, { ...none, tint: '#ff0000' });
  const { opacity, tint, blend, visible } = layers.list.at(-1)!;
  assert.deepEqual([opacity, tint, blend, visible], [0.5, '#ff0000', 'normal', true]);

  // As saved lists have it.
  const { sheet: _, ...saved } = layers.list[0]!;
  const copy = layers.add(texture, saved);
  assert.notEqual(copy.id, saved.id);
  layers.set(copy, { ...layer, opacity: 0.25 });
  assert.match(layers.undo()!, /^changing opacity, tint, blend, visible, region, roughness, .* of Layer 2$/);
  layers.remove(copy);
  assert.deepEqual(namesOf(layers), ['Layer 2', 'Layer 1', 'Layer 3']);
});

test('a base layer that undo brings back is the base again, unless there is a newer one', () => {
  const [stack, history] = [new LayerStack(), new History()];
  const edits = new Edits(stack, history);
  const sheet = { texture };
  const setBase = (name: string): void => edits.do(name, () => stack.setBase(name, sheet));
  const removeBase = (): void => edits.do('removing', () => stack.remove(stack.base!.id));
  const twice = (step: 'undo' | 'redo') => [1, 2].forEach(() => void history[step]());
  const state = () => [stack.base?.name, stack.layers.map(({ name }) => name)];
  setBase('first');
  removeBase();
  assert.deepEqual(state(), [undefined, []]);
  setBase('second');
  twice('undo');
  assert.deepEqual(state(), ['first', ['first']]);
  twice('redo');
  assert.deepEqual(state(), ['second', ['second']]);
  twice('undo');
  setBase('third');
  assert.deepEqual(state(), ['third', ['third']]);
  // Of another model, which is no step.
  removeBase();
  stack.setBase('newer', sheet);
  history.undo();
  assert.deepEqual(state(), ['newer', ['newer', 'third']]);
});

test('the history drops the oldest commands at its memory limit, and undone ones after a new command', () => {
  const history = new History();
  const log: string[] = [];
  const command = (name: string, megabytes = 0) => ({
    name,
    bytes: megabytes * 2 ** 20,
    undo: () => log.push(`-${name}`),
    redo: () => log.push(`+${name}`),
  });
  for (const name of ['a', 'b', 'c']) history.add(command(name, 60));
  while (history.undo()) {}
  assert.deepEqual(log, ['-c', '-b']);
  history.redo();
  history.add(command('d'));
  assert.equal(history.redo(), undefined);
  assert.deepEqual(log, ['-c', '-b', '+b']);
  const failing = {
    ...command('e'),
    undo: () => {
      throw new Error('full');
    },
  };
  history.add(failing);
  assert.throws(() => history.undo(), /full/);
  assert.equal(history.last, failing, 'what cannot be undone stays done');
});

test('a layer that is no step stays, whatever is undone', () => {
  const layers = createLayers({ renderer });
  layers.add(texture, { name: 'skin', undoable: false });
  layers.add(texture, { name: 'star' });
  assert.deepEqual([layers.undo(), layers.undo(), namesOf(layers)], ['adding star', undefined, ['skin']]);
});

test('a region that the cage does not have is an error that lists those that it has', () => {
  const ball = new SphereGeometry();
  const square = [0, 0, 1].map((u, i) => [u, i / 2]);
  const known = Object.assign(new SphereGeometry(), { userData: { regions: { lips: [square] } } });
  for (const [cage, why] of [
    [undefined, 'give createLayers the cage'],
    [ball, 'the cage has none'],
    [known, 'the cage has these: "lips"'],
    [{ scene: new Group().add(new Mesh(known)) }, 'the cage has these: "lips"'],
  ] as const) {
    const layers = createLayers({ renderer, cage });
    const message = `cagecast/three: region is "lip", which is not known; ${why}`;
    assert.throws(() => layers.add(texture, { region: 'lip' }), { code: 'badOption', message });
    assert.throws(() => layers.set(layers.add(texture), { region: 'lip' }), { code: 'badOption', message });
  }
  const arrays = { positions: new Float32Array(9), indices: new Uint32Array(3), uvs: new Float32Array(6) };
  const layers = createLayers({ renderer, cage: { ...arrays, regions: { lips: [square] } } as LoadedCage });
  const layer = layers.add(texture, { region: 'lips' });
  layers.set(layer, { region: null });
  assert.equal(layers.undo(), `changing region of ${layer.name}`);
  assert.equal(layers.list[0]!.region, 'lips');
});

test('what is no saved layers is refused, and changes nothing', async () => {
  const layers = createLayers({ renderer });
  layers.add(texture, { name: 'star' });
  const layer = { ...layers.list[0]!, image: 'data:image/png;base64,' };
  for (const [saved, message] of [
    [[layer], 'saved is of type Array, not what save returned'],
    [{ version: 2, layers: [] }, 'saved.version is 2, not 1'],
    [{ version: 1, layers: Array(17).fill(layer) }, 'saved.layers are 17, more than 16'],
    [{ version: 1, layers: [layer, {}] }, 'saved.layers[1].name is undefined, not a name'],
    [{ version: 1, layers: [{ ...layer, painting: 3 }] }, 'saved.layers[0].painting is 3, not 1024 or 2048'],
    [
      { version: 1, layers: [{ ...layer, tint: 'red' }] },
      'saved.layers[0].tint is "red", not a colour such as #ff8800',
    ],
    [
      { version: 1, layers: [{ ...layer, region: 'lips' }] },
      'saved.layers[0].region is "lips", which is not known; give createLayers the cage',
    ],
    [
      { version: 1, layers: [{ ...layer, image: 'a.png' }] },
      'saved.layers[0].image cannot be read: it is no data URL of an image',
    ],
  ] as const)
    await assert.rejects(layers.load(saved as never), {
      name: 'CagecastError',
      message: `cagecast/three: ${message}`,
    });
  assert.deepEqual(namesOf(layers), ['star']);
});

test('a frame allocates nothing for layers that have not changed', () => {
  const layers = createLayers({ renderer });
  const textures = [1, 2, 3].map(() => new Texture());
  for (const one of textures) layers.add(one);
  const updates = () => [layers.update(), layers.update()];
  assert.deepEqual(updates(), [true, false]);
  const bytes = allocatedBy(() => layers.update());
  assert.ok(bytes < 16, `${bytes} bytes`);
  for (const one of textures) {
    one.needsUpdate = true;
    assert.deepEqual(updates(), [true, false]);
  }
  layers.remove(layers.list[0]!);
  assert.deepEqual(updates(), [true, false]);
});

test('what is refused names the argument and its value, changes nothing and leaves no step', () => {
  const layers = createLayers({ renderer });
  const layer = layers.add(texture);
  const painter = createPainter({ layers, applied: [], cage: new SphereGeometry() });
  const at = { x: 0.5, y: 0.5 };
  const text: StickerPicture = { text: 'A', color: '#ff0000' };
  const none = undefined as never;
  const sticker = (place: object, picture: unknown = text) =>
    painter.sticker(picture as StickerPicture, { at, ...place } as never);
  const gone = layers.add(texture);
  layers.remove(gone);
  layers.edits.forget();
  const badOptions: [() => unknown, string][] = [
    [() => createLayers({ renderer, size: 100 as 256 }), 'size is 100, not one of 256, 512, 1024, 2048'],
    [() => layers.add(texture, null as never), 'options is null, not an object'],
    [() => layers.set(layer, null as never), 'style is null, not an object'],
    [() => layers.set(layer, { opacity: Number.NaN }), 'opacity is NaN, not a number from 0 to 1'],
    [
      () => layers.set(layer, { blend: 'overlay' as never }),
      'blend is "overlay", not one of normal, multiply, screen, add, none',
    ],
    [() => layers.set(layer, { tint: 'red' }), 'tint is "red", not a colour such as #ff8800'],
    [() => layers.set(layer, { visible: 1 as never }), 'visible is 1, not true or false'],
    [
      () => createPainter({ layers, applied: [], cage: new SphereGeometry(), size: 512 as 1024 }),
      'size is 512, not one of 1024, 2048',
    ],
    [() => painter.stroke([at], { size: Number.NaN }), 'size is NaN, not a number from 0 to 2'],
    [() => painter.stroke([at], { color: 'red' }), 'color is "red", not a colour such as #ff8800'],
    [() => painter.stroke([at], { opacity: 2 }), 'opacity is 2, not a number from 0 to 1'],
    [() => painter.stroke([at], { hardness: -1 }), 'hardness is -1, not a number from 0 to 1'],
    [() => painter.stroke([{ ...at, pressure: Number.NaN }]), 'pressure is NaN, not a number from 0 to 1'],
    [() => sticker({ size: -0.2 }), 'size is -0.2, not a number from 0 to 2'],
    [() => sticker({ size: 0 }), 'size is 0, not a number from 0 to 2'],
    [() => sticker({ size: 'big' }), 'size is "big", not a number from 0 to 2'],
    [() => sticker({ size: [0.1, 0.2] }), 'size is of type Array, not a number from 0 to 2'],
    [() => sticker({ angle: Number.NaN }), 'angle is NaN, not a number'],
    [() => sticker({ opacity: 2 }), 'opacity is 2, not a number from 0 to 1'],
  ];
  const badArguments: [() => unknown, string][] = [
    [() => createLayers(none), 'options.renderer is neither a WebGLRenderer nor a WebGPURenderer'],
    [() => createLayers({} as never), 'options.renderer is neither a WebGLRenderer nor a WebGPURenderer'],
    [() => layers.add({} as Texture), 'texture is of type Object, not a Texture'],
    [() => layers.set(none, { opacity: 1 }), 'layer is undefined, not a layer'],
    [() => layers.move(none, 0), 'layer is undefined, not a layer'],
    [() => layers.remove(none), 'layer is undefined, not a layer'],
    [() => layers.move(layer, 0.5), 'the place of a layer is 0.5, not an integer'],
    [() => layers.toImageData(0), 'size is 0, not an integer from 1 to 2048'],
    [() => createPainter(none), 'options.applied is not what applyTransfer returned'],
    [
      () => createPainter({ renderer, applied: {} as never, cage: new SphereGeometry() }),
      'options.applied is not what applyTransfer returned',
    ],
    [
      () => createPainter({ renderer, applied: [], cage: new SphereGeometry().deleteAttribute('uv') }),
      'options.cage has no UVs',
    ],
    [() => painter.listen(null as never), 'camera is null, not a Camera'],
    [() => painter.pickAt({ clientX: 0, clientY: 0 }, none), 'camera is undefined, not a Camera'],
    [() => painter.stroke(none), 'points is undefined, not an array'],
    [() => painter.stroke(at as never), 'points is of type Object, not an array'],
    [() => painter.stroke([{ x: Number.NaN, y: 0 }]), 'a point is (NaN, 0), not a UV'],
    [() => painter.sticker(none, { at }), 'the picture is undefined, not a text or an image'],
    [() => painter.sticker(text, none), 'the place is undefined, not an object with "at"'],
    [() => sticker({}, {}), 'the picture is of type Object, not a text or an image'],
    [() => sticker({}, 'A'.repeat(99)), `the picture is "${'A'.repeat(40)}…", not a text or an image`],
    [() => sticker({}, { image: { width: 0, height: 0 } }), 'the image is not loaded yet'],
  ];
  for (const [code, cases] of Object.entries({ badOption: badOptions, badArgument: badArguments }))
    for (const [call, reason] of cases)
      assert.throws(call, { name: 'CagecastError', code, message: `cagecast/three: ${reason}` }, reason);
  for (const call of [() => layers.remove(gone), () => layers.move(gone, 0), () => layers.set(gone, {})])
    assert.throws(call, { code: 'badArgument', message: 'That layer was removed.' });
  assert.deepEqual([layers.list, layers.canUndo, layers.history.held], [[layer], false, false]);
});

describe('saved layers that anybody may have written', () => {
  const dataUrl = (bytes: Uint8Array, type = 'image/webp') =>
    `data:${type};base64,${Buffer.from(bytes).toString('base64')}`;
  const small = dataUrl(pngOf(64, 64), 'image/png');
  const savedOf = (...layers: object[]) =>
    ({ version: 1, layers: layers.map((layer) => ({ name: 'a', image: small, ...layer })) }) as never;

  /** What decodes images: here none are, but it is counted how many at the same time. */
  let [decoding, atOnce, open, fails] = [0, 0, 0, -1];
  const bitmapOf = async (file: Blob) => {
    atOnce = Math.max(atOnce, ++decoding);
    const { width, height } = imageSize(new Uint8Array(await file.arrayBuffer()))!;
    --decoding;
    if (fails-- === 0) throw new Error('damaged');
    ++open;
    return { width, height, close: () => void --open };
  };
  before(() => Object.assign(globalThis, { createImageBitmap: bitmapOf }));
  after(() => Reflect.deleteProperty(globalThis, 'createImageBitmap'));

  /** That they are refused, nothing is decoded, and the layers that were there stay. */
  async function refused(saved: never, message: RegExp) {
    const layers = createLayers({ renderer });
    layers.add(texture, { name: 'mine' });
    layers.setBaseTint('#ff0000');
    await assert.rejects(layers.load(saved), { name: 'CagecastError', message });
    assert.deepEqual(
      [namesOf(layers), layers.baseTint, layers.undo()],
      [['mine'], '#ff0000', 'changing the base tint'],
    );
    assert.equal(open, 0);
  }

  test('images of more pixels than there is room for are refused by what they say, whatever their format', async () => {
    const most = 'more than 2048 × 2048$';
    const bombs: Record<string, [bytes: Uint8Array, type: string, size: string]> = {
      webp: [webpOf(16_383, 16_383), 'image/webp', '16,383 × 16,383'],
      png: [pngOf(30_000, 30_000), 'image/png', '30,000 × 30,000'],
      jpeg: [jpegOf(65_500, 65_500), 'image/jpeg', '65,500 × 65,500'],
      gif: [Buffer.from('GIF89a\xff\xff\xff\xff', 'latin1'), 'image/gif', '65,535 × 65,535'],
      bmp: [bmpOf(40_000, -40_000), 'image/bmp', '40,000 × 40,000'],
      ico: [icoOf(pngOf(64, 64), pngOf(30_000, 30_000)), 'image/x-icon', '30,000 × 30,000'],
      avif: [avifOf([64, 64], [50_000, 50_000]), 'image/avif', '50,000 × 50,000'],
      'png that lies of its type': [pngOf(30_000, 30_000), 'image/webp', '30,000 × 30,000'],
    };
    for (const [name, [bytes, type, size]] of Object.entries(bombs)) {
      const image = dataUrl(bytes, type);
      const said = new RegExp(`saved\\.layers\\[1\\]\\.image has ${size} pixels, ${most}`);
      await refused(savedOf({}, { image }), said);
      await refused(
        savedOf({}, { image: small, normal: image }),
        new RegExp(`saved\\.layers\\[1\\]\\.normal has ${size}`),
      );
      assert.ok(bytes.length < 500_000, name);
    }
    await refused(
      savedOf({ image: dataUrl(Buffer.from('<svg/>'), 'image/svg+xml') }),
      /\[0\]\.image cannot be read: .*how many pixels/,
    );
    await refused(
      savedOf({ image: dataUrl(webpOf(2049, 1)) }),
      /saved\.layers\[0\]\.image has 2,049 × 1 pixels, more than 2048 × 2048$/,
    );
  });

  test('the image of a painting has its size', async () => {
    for (const [width, height] of [
      [16_383, 4096],
      [1024, 1023],
      [2048, 2048],
      [1, 1],
    ] as const)
      await refused(
        savedOf({ painting: 1024, image: dataUrl(webpOf(width, height)) }),
        new RegExp(`\\[0\\]\\.image has ${width.toLocaleString('en')} × .* pixels, not 1024 × 1024 as its painting`),
      );
  });

  test('values out of range, of another type or too long are refused with the layer, the value and the limit', async () => {
    const cases: [layer: object, message: RegExp][] = [
      [{ opacity: 1.5 }, /saved\.layers\[1\]\.opacity is 1\.5, not a number from 0 to 1/],
      [{ opacity: '0.5' }, /\[1\]\.opacity is "0\.5", not a number/],
      [{ opacity: null }, /\[1\]\.opacity is null/],
      [{ tint: ['#ffffff'] }, /\[1\]\.tint is of type Array, not a colour/],
      [{ blend: 'burn' }, /\[1\]\.blend is "burn", not one of/],
      [{ emissive: 1e9 }, /\[1\]\.emissive is 1000000000, not a number from 0 to 10/],
      [{ roughness: -1 }, /\[1\]\.roughness is -1/],
      [{ normalScale: '1' }, /\[1\]\.normalScale is "1", not a finite number/],
      [{ region: 'lips' }, /\[1\]\.region is "lips", which is not known/],
      [{ visible: 1 }, /\[1\]\.visible is 1, not true or false/],
      [{ offset: [0] }, /\[1\]\.offset is .*, not two finite numbers \[u, v\]/],
      [{ scale: 0 }, /\[1\]\.scale is 0, not a number from 0.001 to 1000/],
      [{ scale: '2' }, /\[1\]\.scale is "2", not a number/],
      [{ rotation: '1' }, /\[1\]\.rotation is "1", not a finite number of radians/],
      [{ painting: 4096 }, /\[1\]\.painting is 4096, not 1024 or 2048/],
      [{ name: 7 }, /\[1\]\.name is 7, not a name/],
      [{ name: 'x'.repeat(5000) }, /\[1\]\.name has 5000 characters, more than 1000/],
      [{ image: 7 }, /\[1\]\.image is 7, not the data URL of an image/],
      [{ image: {} }, /\[1\]\.image is of type Object, not the data URL/],
      [{ normal: null }, /\[1\]\.normal is null, not the data URL/],
    ];
    for (const [layer, message] of cases) await refused(savedOf({}, layer), message);
    await refused(savedOf(...Array.from({ length: 17 }, () => ({}))), /saved\.layers are 17, more than 16/);
    await refused({ version: 1, layers: [null] } as never, /saved\.layers\[0\]\.name is undefined/);
  });

  test('they are decoded one after the other; if one cannot be, nothing is left of the others', async () => {
    atOnce = 0;
    const three = savedOf({ normal: small }, {}, {});
    fails = 3;
    await refused(three, /saved\.layers\[2\]\.image cannot be read: damaged/);
    fails = 1;
    await refused(three, /saved\.layers\[0\]\.normal cannot be read: damaged/);
    const layers = createLayers({ renderer });
    await layers.load(three);
    assert.deepEqual([layers.list.length, atOnce, open], [3, 1, 4]);
    layers.dispose();
    assert.equal(open, 0);
  });
});

/** The beginnings of images that say to have as many pixels. */
function bmpOf(width: number, height: number): Buffer {
  const bytes = Buffer.alloc(54);
  bytes.write('BM');
  [40, width, height].forEach((value, at) => bytes.writeInt32LE(value, 14 + 4 * at));
  return bytes;
}

function icoOf(...pictures: Buffer[]): Buffer {
  const head = Buffer.alloc(6 + 16 * pictures.length);
  head.writeUInt16LE(1, 2);
  head.writeUInt16LE(pictures.length, 4);
  let at = head.length;
  for (const [n, { length }] of pictures.entries()) {
    head.writeUInt32LE(at, 6 + 16 * n + 12);
    at += length;
  }
  return Buffer.concat([head, ...pictures]);
}

function avifOf(...sizes: [width: number, height: number][]): Buffer {
  const boxes = sizes.map(([width, height]) => {
    const box = Buffer.alloc(20);
    box.writeUInt32BE(20);
    box.write('ispe', 4);
    box.writeUInt32BE(width, 12);
    box.writeUInt32BE(height, 16);
    return box;
  });
  return Buffer.concat([Buffer.from('\0\0\0\x14ftypavif\0\0\0\0avif', 'latin1'), ...boxes]);
}
