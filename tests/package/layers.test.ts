// Layers and painters as far as nothing is drawn: steps that can be undone, and what is refused.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { LoadedCage } from 'cagecast/three';
import {
  createLayers,
  createPainter,
  Edits,
  History,
  LayerStack,
  type Layers,
  type StickerPicture,
} from 'cagecast/three/paint';
import { Group, Mesh, SphereGeometry, Texture } from 'three';
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
    const message = `cagecast/three/paint: region is "lip", which is not known; ${why}`;
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
    [{ version: 1, layers: [{ ...layer, tint: 'red' }] }, 'tint is "red", not a colour such as #ff8800'],
    [
      { version: 1, layers: [{ ...layer, region: 'lips' }] },
      'region is "lips", which is not known; give createLayers the cage',
    ],
    [
      { version: 1, layers: [{ ...layer, image: 'a.png' }] },
      'saved.layers[0].image cannot be read: it is no data URL of an image',
    ],
  ] as const)
    await assert.rejects(layers.load(saved as never), {
      name: 'CagecastError',
      message: `cagecast/three/paint: ${message}`,
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
      assert.throws(call, { name: 'CagecastError', code, message: `cagecast/three/paint: ${reason}` }, reason);
  for (const call of [() => layers.remove(gone), () => layers.move(gone, 0), () => layers.set(gone, {})])
    assert.throws(call, { code: 'badArgument', message: 'That layer was removed.' });
  assert.deepEqual([layers.list, layers.canUndo, layers.history.held], [[layer], false, false]);
});
