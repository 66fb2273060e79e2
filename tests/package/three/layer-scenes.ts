// What the page of the tests does with layers and painters. Runs in the browser.
import { type Applied, applyTransfer, modelMasks } from 'cagecast/three';
import { type Blend, createLayers, type Layers } from 'cagecast/three/paint';
import {
  createPainter,
  LayerPainter,
  type Painter,
  type StickerPicture,
  type StickerPlace,
  type StrokePoint,
} from 'cagecast/three/paint';
import {
  Bone,
  BufferAttribute,
  DataTexture,
  Group,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  type Object3D,
  Raycaster,
  Scene,
  Skeleton,
  SkinnedMesh,
  SphereGeometry,
  SRGBColorSpace,
  Texture,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three';
import { ball, cage, camera, countOf, difference, draw, flat, kSize, modelOf, renderer } from './scenes';

/** A texture of one colour with alpha, given as sRGB. */
function clear(color: number, alpha: number): DataTexture {
  const texture = flat(color);
  const data = texture.image.data as Uint8Array;
  for (let at = 3; at < data.length; at += 4) data[at] = alpha;
  return texture;
}

const texelOf = ({ data }: ImageData): number[] => [...data.subarray(0, 4)];
const white = (): MeshBasicMaterial => new MeshBasicMaterial({ color: 0xbbbbbb });
const messageOf = (run: () => unknown): string => {
  try {
    run();
    return 'no error';
  } catch (error) {
    return (error as Error).message;
  }
};

/** What a pixel of the picture is, 0 to 255. */
const pixelAt = (pixels: readonly number[], x: number, y: number): number[] =>
  pixels.slice(4 * (y * kSize + x), 4 * (y * kSize + x) + 3);

/** A ray through a pixel of the picture. */
function ray(x: number, y: number): Raycaster {
  const raycaster = new Raycaster();
  camera.updateMatrixWorld();
  raycaster.setFromCamera(new Vector2((2 * (x + 0.5)) / kSize - 1, (2 * (y + 0.5)) / kSize - 1), camera);
  return raycaster;
}

interface Painted {
  model: Object3D;
  applied: Applied;
  painter: Painter;
  /** The model as it is drawn now. */
  look(): number[];
  /** The spots of the model at some pixels. */
  spots(...at: readonly (readonly [number, number])[]): StrokePoint[];
}

function paintedBall(model: Object3D = modelOf(white()), layers?: Layers): Painted {
  const applied = applyTransfer(model, cage());
  const painter = createPainter({ renderer, layers, applied, cage: cage() });
  painter.brush.color = '#ff0000';
  const look = (): number[] => {
    painter.update();
    return draw(model).pixels;
  };
  const spots: Painted['spots'] = (...at) => at.map(([x, y]) => painter.pick(ray(x, y))!);
  return { model, applied, painter, look, spots };
}

/** Loses the graphics context, and gets it back. @param meanwhile What is done without it. */
async function loseContext(meanwhile = (): void => {}): Promise<void> {
  // It cannot be restored before the event has ended.
  const told = (name: string) =>
    new Promise((done) => renderer.domElement.addEventListener(name, () => setTimeout(done), { once: true }));
  const lost = told('webglcontextlost');
  renderer.forceContextLoss();
  await lost;
  meanwhile();
  const restored = told('webglcontextrestored');
  renderer.forceContextRestore();
  await restored;
}

/** A white image, laid out on the page in another size than its own. */
async function shownImage(width: number, height: number): Promise<HTMLImageElement> {
  const context = document.createElement('canvas').getContext('2d')!;
  Object.assign(context.canvas, { width, height });
  context.fillStyle = '#ffffff';
  context.fillRect(0, 0, width, height);
  const image = new Image();
  image.src = context.canvas.toDataURL();
  await image.decode();
  image.style.cssText = 'width: 16px; height: 16px';
  document.body.append(image);
  return image;
}

/** Texels with paint. */
function filled(painter: Painter): { texels: number; most: number } {
  const { data } = painter.layers.toImageData();
  let [texels, most] = [0, 0];
  for (let at = 3; at < data.length; at += 4) {
    if (data[at]! > 0) texels++;
    most = Math.max(most, data[at]!);
  }
  return { texels, most };
}

export const layerScenes: Record<string, () => unknown> = {
  /** Sixteen layers, beside what the formulas say. */
  sixteenLayers() {
    const blends: Blend[] = ['normal', 'multiply', 'screen', 'add'];
    const layers = createLayers({ renderer, size: 256 });
    const styles = Array.from({ length: 16 }, (_, i) => ({
      color: [(i * 97) % 256, (i * 53 + 80) % 256, (i * 29 + 30) % 256, 255 - 13 * i] as const,
      blend: i === 0 ? 'normal' : blends[i % 4]!,
      opacity: 1 - 0.04 * i,
      tint: i % 3 === 0 ? '#ffffff' : '#ffcc99',
    }));
    const added = styles.map(({ color: [r, g, b, a], ...style }) =>
      layers.add(clear((r << 16) + (g << 8) + b, a), style),
    );
    const errors = [
      () => layers.add(flat(0)),
      () => layers.set(added[0]!, { opacity: Number.NaN }),
      () => layers.set(added[0]!, { blend: 'overlay' as Blend }),
      () => layers.set(added[0]!, { tint: 'red' }),
      () => layers.move(added[0]!, 0.5),
      () => (createLayers as (options?: unknown) => void)(),
      () => createLayers({} as Parameters<typeof createLayers>[0]),
      () => createLayers({ renderer }).add({} as DataTexture),
      () => layers.toImageData(0),
      () => createLayers({ renderer, size: 100 as 256 }),
    ].map(messageOf);
    const all = texelOf(layers.toImageData(16));
    layers.move(added[15]!, 0);
    const moved = texelOf(layers.toImageData(16));
    const undone = [layers.undo(), texelOf(layers.toImageData(16))];
    layers.set(added[15]!, { visible: false });
    layers.remove(added[14]!);
    const fewer = texelOf(layers.toImageData(16));
    layers.undo();
    layers.undo();
    const back = texelOf(layers.toImageData(16));
    const { width } = layers.toImageData();
    const count = layers.list.length;
    layers.dispose();
    return { styles, all, moved, undone, fewer, back, count, width, errors };
  },

  /** Changes in quick succession, of layers with one name, and what undo takes back. */
  quickSteps() {
    const layers = createLayers({ renderer, size: 256 });
    const back = () => {
      layers.undo();
      return layers.list.length;
    };
    const add = (name?: string) => layers.add(flat(0xdd3311), { name });
    for (let i = 0; i < 3; ++i) add('star');
    const added = [back(), back(), back()];
    const [a, b] = [add('star'), add('star')];
    layers.remove(b);
    layers.remove(a);
    const removed = [back(), back()];
    const opacities = () => layers.list.map(({ opacity }) => opacity);
    layers.set(a, { opacity: 0.5 });
    layers.set(b, { opacity: 0.2 });
    layers.undo();
    const restyled = [opacities()];
    layers.undo();
    restyled.push(opacities());
    for (const opacity of [0.9, 0.8, 0.7]) layers.set(a, { opacity });
    layers.undo();
    const slid = opacities()[0];
    layers.remove(a);
    layers.remove(b);
    const first = add();
    add();
    layers.remove(first);
    add();
    const names = layers.list.map(({ name }) => name);
    layers.dispose();
    return { added, removed, restyled, slid, names };
  },

  /** A layer whose options are there, but undefined. */
  undefinedStyle() {
    const layers = createLayers({ renderer, size: 256 });
    const none = { opacity: undefined, tint: undefined, blend: undefined, visible: undefined } as object;
    const layer = layers.add(flat(0xdd3311), none);
    const added = texelOf(layers.toImageData(16));
    layers.set(layer, { opacity: 0.5 });
    layers.set(layer, { ...none, tint: '#ff0000' });
    const { opacity, tint, blend, visible } = layers.list[0]!;
    layers.dispose();
    return { added, style: { opacity, tint, blend, visible } };
  },

  /** What a renderer with a reversed depth buffer draws: layers, a stroke, filled triangles, a sticker. */
  reversedDepth() {
    const own = new WebGLRenderer({ reversedDepthBuffer: true } as object);
    const layers = createLayers({ renderer: own, size: 256 });
    layers.add(flat(0xdd3311));
    const texel = texelOf(layers.toImageData(16));
    layers.dispose();
    const painter = createPainter({ renderer: own, applied: [], cage: cage() });
    const at = { x: 0.5, y: 0.5 };
    painter.stroke([at], { size: 0.1 });
    const counts = [filled(painter).texels];
    painter.undo();
    painter.sticker({ text: 'III', color: '#ff0000' }, { at });
    counts.push(filled(painter).texels);
    painter.undo();
    const filler = new LayerPainter(painter.layers);
    filler.setCage({
      positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]),
      indices: new Uint32Array([0, 1, 2]),
      uvs: new Float32Array([0, 0, 1, 0, 0, 1]),
    });
    filler.begin('fill', { color: '#ff0000', opacity: 1, hardness: 1, erases: false });
    filler.fill([0, 0, 1, 0, 0, 1]);
    filler.end();
    counts.push(filled(painter).texels);
    filler.dispose();
    painter.dispose();
    painter.layers.dispose();
    own.dispose();
    own.forceContextLoss();
    return { texel, counts };
  },

  /** An update that fails, and the next one. */
  failedUpdate() {
    const layers = createLayers({ renderer, size: 256 });
    layers.add(flat(0xdd3311));
    const { render } = renderer;
    renderer.render = () => {
      throw new Error('not now');
    };
    const message = messageOf(() => layers.update());
    renderer.render = render;
    const updated = layers.update();
    const texel = texelOf(layers.toImageData(16));
    layers.dispose();
    return { message, updated, texel };
  },

  /** Layers added with what another one, or a saved list, has, and one that gets the style of another. */
  copiedLayers() {
    const layers = createLayers({ renderer, size: 256 });
    const first = layers.add(flat(0xff0000), { name: 'red' });
    const copy = layers.add(flat(0x0000ff), { ...first, name: 'copy' });
    const shown = texelOf(layers.toImageData(16));
    layers.set(first, { ...copy, opacity: 0.5 });
    const step = layers.undo();
    layers.redo();
    const saved = JSON.parse(JSON.stringify(layers.list.map(({ sheet, ...rest }) => rest)));
    layers.remove(copy);
    const back = layers.add(flat(0x0000ff), saved[1]);
    layers.add(flat(0x00ff00), { name: 'third' });
    layers.remove(back);
    const list = layers.list.map(({ name, opacity }) => `${name} ${opacity}`);
    layers.dispose();
    return { shown, step, list };
  },

  /** One stack on two models, beside the same colour as a texture; a texture that changes. */
  stackOnModels() {
    const layers = createLayers({ renderer });
    const models = [modelOf(white()), modelOf(white())];
    const applied = models.map((model) => applyTransfer(model, cage()));
    for (const one of applied) one.setTexture(layers.texture);
    const layer = layers.add(clear(0xdd3311, 120));
    const plain = modelOf(white());
    applyTransfer(plain, cage(), { texture: clear(0xdd3311, 120) });
    const look = () => {
      layers.update();
      return models.map((model) => draw(model).pixels);
    };
    const apart = look().map((pixels) => difference(pixels, draw(plain).pixels));
    layers.set(layer, { opacity: 0 });
    const bare = modelOf(white());
    const hidden = look().map((pixels) => difference(pixels, draw(bare).pixels));
    const idle = layers.update();

    const texture = new DataTexture(new Uint8Array(16), 2, 2);
    texture.colorSpace = SRGBColorSpace;
    layers.add(texture);
    layers.update();
    (texture.image.data as Uint8Array).set([255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255]);
    texture.needsUpdate = true;
    const changed = look().map((pixels) => countOf(pixels, 0));
    for (const one of applied) one.dispose();
    layers.dispose();
    return { apart, hidden, idle, changed };
  },

  /** A stroke, undone and repeated; erased with its soft edge; on layers below. */
  strokes() {
    const { painter, look, spots } = paintedBall();
    const bare = look();
    const path = spots([24, 32], [40, 32]);
    painter.stroke(path, { size: 0.1, hardness: 1 });
    const painted = look();
    const middle = [pixelAt(painted, 32, 32), pixelAt(painted, 32, 48)];
    const names = [painter.undo()];
    const undone = difference(look(), bare);
    names.push(painter.redo());
    const redone = difference(look(), painted);
    painter.undo();
    // Over and over, and softly.
    painter.stroke(path, { size: 0.15, hardness: 0, opacity: 0.6 });
    const soft = filled(painter);
    painter.erase(path, { size: 0.15, hardness: 0, opacity: 0.6 });
    const left = filled(painter);
    painter.undo();
    const again = filled(painter);
    painter.erase(spots([40, 32]), { size: 0.05, hardness: 1 });
    const half = filled(painter);
    const errors = [
      () => painter.stroke(path, { size: Number.NaN }),
      () => painter.stroke(path, { color: 'red' }),
      () => painter.stroke(path, { opacity: 2 }),
      () => painter.stroke([{ x: Number.NaN, y: 0 }]),
      () => (createPainter as () => unknown)(),
      () => createPainter({ renderer, applied: {} as Applied, cage: cage() }),
      () => createPainter({ renderer, applied: [], cage: cage(), size: 512 as 1024 }),
    ].map(messageOf);
    const steps = painter.layers.list.length;
    painter.dispose();
    return { middle, names, undone, redone, soft, left, again, half, errors, steps };
  },

  /** Mirrored strokes, and those of a pen. */
  mirroredAndPressed() {
    const { painter, look, spots } = paintedBall();
    painter.stroke(spots([20, 32]), { size: 0.1, hardness: 1, mirror: true });
    const pixels = look();
    const sides = [20, 43].map((x) => pixelAt(pixels, x, 32));
    painter.undo();
    const [from, to] = spots([16, 32], [48, 32]) as [StrokePoint, StrokePoint];
    painter.stroke([from, to], { size: 0.2, hardness: 1 });
    const full = filled(painter).texels;
    painter.undo();
    painter.stroke(
      [
        { ...from, pressure: 0.1 },
        { ...to, pressure: 1 },
      ],
      { size: 0.2, hardness: 1 },
    );
    const pressed = look();
    // How wide the stroke is near its ends.
    const width = (x: number): number =>
      Array.from({ length: kSize }, (_, y) => pixelAt(pressed, x, y)).filter(([r, g]) => r! > 200 && g! < 80).length;
    const widths = [20, 44].map(width);
    const thin = filled(painter).texels;
    painter.dispose();
    return { sides, full, thin, widths };
  },

  /** Text and an image on the model. */
  stickers() {
    const { painter, look, spots } = paintedBall();
    const [at] = spots([32, 32]) as [StrokePoint];
    painter.sticker({ text: 'III', color: '#ff0000' }, { at, size: 0.25 });
    const text = countOf(look(), 0);
    painter.undo();
    const context = document.createElement('canvas').getContext('2d')!;
    context.canvas.width = context.canvas.height = 64;
    // Red above, blue below.
    context.fillStyle = '#ff0000';
    context.fillRect(0, 0, 64, 32);
    context.fillStyle = '#0000ff';
    context.fillRect(0, 32, 64, 32);
    painter.sticker({ image: context.canvas }, { at, size: 0.25 });
    const upright = look();
    painter.undo();
    painter.sticker({ image: context.canvas }, { at, size: 0.25, angle: Math.PI });
    const turned = look();
    const ends = (pixels: number[]): string[] =>
      [36, 28].map((y) => (pixelAt(pixels, 32, y)[0]! > 150 ? 'red' : 'blue'));
    painter.dispose();
    return { text, upright: ends(upright), turned: ends(turned) };
  },

  /** An image of another size on the page than its own, as a sticker and as a mask. */
  async shownImages() {
    const { painter } = paintedBall();
    const image = await shownImage(128, 32);
    painter.sticker({ image }, { at: { x: 0.5, y: 0.5 }, size: 0.1 });
    const { data, width } = painter.layers.toImageData();
    const columns = new Set<number>();
    const rows = new Set<number>();
    for (let i = 0; i < width * width; ++i) {
      if (data[4 * i + 3]! < 128) continue;
      columns.add(i % width);
      rows.add(Math.floor(i / width));
    }
    const never = new Texture(image);
    const masked = [...modelMasks(ball(), { never }).triangles!].filter((mask) => mask === -1).length;
    const triangles = ball().index!.count / 3;
    image.remove();
    painter.dispose();
    return { shape: columns.size / rows.size, masked, triangles };
  },

  /** Stickers, pressures and pictures that are refused; nothing is painted and no step is left. */
  refusedStickers() {
    const { painter } = paintedBall();
    const at = { x: 0.5, y: 0.5 };
    const sticker = (place: object, picture: StickerPicture = { text: 'A', color: '#ff0000' }) =>
      messageOf(() => painter.sticker(picture, { at, ...place } as StickerPlace));
    const errors = [
      sticker({ size: Number.NaN }),
      sticker({ size: -0.2 }),
      sticker({ size: 0 }),
      sticker({ size: 'big' }),
      sticker({ size: [0.1, 0.2] }),
      sticker({ angle: Number.NaN }),
      sticker({ opacity: 2 }),
      sticker({}, { image: new Image() }),
      messageOf(() => painter.stroke([{ ...at, pressure: Number.NaN }])),
      messageOf(() => painter.sticker(undefined as unknown as StickerPicture, { at })),
      messageOf(() => (painter.sticker as () => void)()),
      sticker({}, {} as StickerPicture),
      sticker({}, 'A' as unknown as StickerPicture),
      messageOf(() => (painter.sticker as (picture: StickerPicture) => void)({ text: 'A', color: '#ff0000' })),
      messageOf(() => (painter.stroke as () => void)()),
      messageOf(() => painter.stroke(at as unknown as StrokePoint[])),
    ];
    const { canUndo } = painter;
    painter.dispose();
    return { errors, canUndo };
  },

  /** What a painter says and does after it has been disposed of. */
  disposedPainter() {
    const { painter, spots } = paintedBall();
    const [spot] = spots([32, 32]) as [StrokePoint];
    painter.stroke([spot]);
    const before = filled(painter).texels;
    painter.dispose();
    const uv = { x: 0.5, y: 0.5 };
    const picture = { text: 'A', color: '#ff0000' };
    const messages = [
      () => painter.stroke([uv]),
      () => painter.stroke([spot]),
      () => painter.erase([uv]),
      () => painter.sticker(picture, { at: uv }),
      () => painter.sticker(picture, { at: spot }),
      () => painter.dispose(),
    ].map(messageOf);
    const after = filled(painter).texels;
    painter.undo();
    const undone = filled(painter).texels;
    painter.layers.dispose();
    return { messages, texels: [before, after], undone };
  },

  /** A pointer on a model whose layers are too many for another one. */
  fullLayers() {
    const layers = createLayers({ renderer, size: 256 });
    for (let i = 0; i < 16; ++i) layers.add(clear(0, 0));
    const { painter } = paintedBall(modelOf(white()), layers);
    const canvas = renderer.domElement;
    document.body.append(canvas);
    const told: string[] = [];
    painter.onError = ({ message }) => told.push(message);
    painter.listen(camera);
    const { left, top } = canvas.getBoundingClientRect();
    const at = { clientX: left + kSize / 2, clientY: top + kSize / 2 };
    const send = () => canvas.dispatchEvent(new PointerEvent('pointerdown', { pointerId: 7, isPrimary: true, ...at }));
    send();
    painter.tool = 'sticker';
    painter.picture = { image: new Image() };
    send();
    const { held } = layers.history;
    painter.dispose();
    layers.dispose();
    canvas.remove();
    return { told, held };
  },

  /** One text twice. Meanwhile its font is loaded: here, one whose letters are solid. */
  lateFont() {
    const { painter } = paintedBall();
    const texels = (): number => {
      painter.sticker({ text: 'III', color: '#ff0000' }, { at: { x: 0.5, y: 0.5 } });
      const found = filled(painter).texels;
      painter.undo();
      return found;
    };
    const before = texels();
    const { fillText } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.fillText = function () {
      this.fillRect(0, 0, this.canvas.width, this.canvas.height);
    };
    const after = texels();
    CanvasRenderingContext2D.prototype.fillText = fillText;
    painter.dispose();
    return { before, after };
  },

  /** What is left of renderers, painters and their canvases when they are disposed of, after garbage was collected. */
  async leftovers() {
    const kept: Record<string, WeakRef<object>[]> = { renderers: [], texels: [], canvases: [] };
    const layers = createLayers({ renderer, size: 256 });
    const { createElement } = document;
    const Owners = Int32Array;
    document.createElement = ((name: string) => {
      const element = createElement.call(document, name);
      if (name === 'canvas') kept['canvases']!.push(new WeakRef(element));
      return element;
    }) as typeof createElement;
    globalThis.Int32Array = new Proxy(Owners, {
      construct(target, args) {
        const made = Reflect.construct(target, args) as Int32Array;
        if (made.length >= 1024 ** 2) kept['texels']!.push(new WeakRef(made));
        return made;
      },
    });
    const use = (): void => {
      const own = new WebGLRenderer();
      const drawn = createLayers({ renderer: own, size: 256 });
      drawn.add(flat(0xdd3311));
      drawn.toImageData(16);
      drawn.dispose();
      own.dispose();
      own.forceContextLoss();
      kept['renderers']!.push(new WeakRef(own));
      const painter = createPainter({ layers, applied: [], cage: cage() });
      painter.stroke([{ x: 0.5, y: 0.5 }]);
      painter.sticker({ text: 'A', color: '#ff0000' }, { at: { x: 0.5, y: 0.5 } });
      painter.dispose();
    };
    try {
      for (let i = 0; i < 3; ++i) use();
    } finally {
      document.createElement = createElement;
      globalThis.Int32Array = Owners;
    }
    layers.toImageData(16); // what comes next may keep the last one
    const made = Object.values(kept).map(({ length }) => length);
    const { collectGarbage } = globalThis as unknown as { collectGarbage(): Promise<void> };
    const countLeft = () =>
      Object.fromEntries(Object.entries(kept).map(([what, refs]) => [what, refs.filter((ref) => ref.deref()).length]));
    let left = countLeft();
    // What one collection frees may have held something else, and contexts tell of their loss when they have time.
    for (let i = 0; i < 50 && Object.values(left).some((count) => count > 0); ++i) {
      await new Promise((resolve) => setTimeout(resolve, 10));
      await collectGarbage();
      left = countLeft();
    }
    layers.dispose();
    return { made, left };
  },

  /** How many listeners painters leave on layers that go on: of one that has painted, and of one that has not. */
  followers() {
    const layers = createLayers({ renderer, size: 256 });
    const { on } = layers;
    let listeners = 0;
    layers.on = ((...given: Parameters<typeof on>) => {
      const stop = on.apply(layers, given);
      ++listeners;
      return () => {
        stop();
        --listeners;
      };
    }) as typeof on;
    const left = [true, false].map((paints) => {
      listeners = 0;
      const painter = createPainter({ layers, applied: [], cage: cage() });
      if (paints) painter.stroke([{ x: 0.5, y: 0.5 }]);
      painter.dispose();
      return listeners;
    });
    layers.dispose();
    return left;
  },

  /** The `touch-action` of an element that painters listen to, after one of them has ended or begun. */
  touchActions() {
    const layers = createLayers({ renderer, size: 256 });
    const [first, second] = [1, 2].map(() => createPainter({ layers, applied: [], cage: cage() })) as [
      Painter,
      Painter,
    ];
    const element = document.createElement('div');
    element.style.touchAction = 'pan-y';
    const stops = [first, second].map((painter) => painter.listen(camera, element)) as [() => void, () => void];
    const after = (run: () => unknown): string => {
      run();
      return element.style.touchAction;
    };
    const ended = [stops[0], stops[0], () => second.dispose()].map(after);
    element.style.touchAction = 'auto'; // by another
    const late = [
      stops[1],
      () => second.dispose(),
      () => second.listen(camera, element),
      () => second.listen(camera, element)(),
    ].map(after);
    const again = [() => first.listen(camera, element), () => first.dispose()].map(after);
    layers.dispose();
    return { ended, late, again };
  },

  /** A part in front of another one that is taken out of the model. */
  removedPart() {
    const [head, hair] = [new Mesh(ball(0.8), white()), new Mesh(ball(), white())];
    const { painter } = paintedBall(new Group().add(head, hair));
    const model = head.parent!;
    const look = () => painter.pick(ray(32, 32))?.mesh;
    const picked = [look() === hair];
    new Scene().add(model);
    picked.push(look() === hair);
    hair.removeFromParent();
    picked.push(look() === head);
    painter.dispose();
    return picked;
  },

  /** How directions of the scene are turned to those of the cage, on models that are as they were painted. */
  toCage() {
    return [1, -1].map((x) => {
      const model = modelOf(white());
      model.scale.x = x;
      const { painter, spots } = paintedBall(model);
      const { toCage } = spots([40, 40])[0] as { toCage: Matrix4 };
      painter.dispose();
      return Math.max(...toCage.elements.map((value, i) => Math.abs(value - new Matrix4().elements[i]!)));
    });
  },

  /** Stickers of a canvas that is drawn anew, and of one picture before and after the graphics context was lost. */
  async stickersAnew() {
    const { painter, look, spots } = paintedBall();
    const [at] = spots([32, 32]) as [StrokePoint];
    const lay = (image: HTMLCanvasElement | ImageBitmap): string => {
      painter.sticker({ image }, { at, size: 0.25 });
      const [red = 0, , blue = 0] = pixelAt(look(), 32, 32);
      painter.undo();
      return red > 2 * blue ? 'red' : blue > 2 * red ? 'blue' : 'none';
    };
    const context = document.createElement('canvas').getContext('2d')!;
    const canvas = ['#ff0000', '#0000ff'].map((color) => {
      context.fillStyle = color;
      context.fillRect(0, 0, 300, 150);
      return lay(context.canvas);
    });
    const picture = await createImageBitmap(context.canvas);
    const [before, again] = [lay(picture), lay(picture)];
    await loseContext();
    const after = lay(picture);
    painter.dispose();
    return { canvas, picture: [before, again, after] };
  },

  /** A stroke over another one while the graphics context is lost. */
  async strokeWhileLost() {
    const { painter, look, spots } = paintedBall();
    const at = spots([32, 32]);
    const stroke = (color: string) => painter.stroke(at, { color, size: 0.2, hardness: 1 });
    stroke('#ff0000');
    const before = pixelAt(look(), 32, 32);
    await loseContext(() => stroke('#0000ff'));
    const after = pixelAt(look(), 32, 32);
    painter.dispose();
    return { before, after };
  },

  /** The texture of new layers, and of given ones. */
  baseTexture() {
    const model = modelOf(white());
    const applied = applyTransfer(model, cage());
    const options = { texture: clear(0xff0000, 255), applied, cage: cage() };
    const own = createPainter({ ...options, renderer });
    const undone = own.undo();
    const { layers } = own;
    createPainter({ ...options, layers });
    return { undone, layers: layers.list.length };
  },

  /** Layers after the graphics context was lost, whose painter had been disposed of. */
  async paintedBefore() {
    const { painter, look, spots } = paintedBall();
    const { layers } = painter;
    painter.stroke(spots([32, 32]), { size: 0.2, hardness: 1 });
    painter.dispose();
    let changes = 0;
    layers.on('change', () => changes++);
    const before = pixelAt(look(), 32, 32);
    await loseContext();
    const after = pixelAt(look(), 32, 32);
    layers.dispose();
    return { before, after, changes };
  },

  /** A model that was moved, turned and posed since it was painted. */
  posed() {
    const geometry = ball();
    const { count } = geometry.getAttribute('position');
    geometry.setAttribute('skinIndex', new BufferAttribute(new Uint16Array(4 * count), 4));
    const weights = Float32Array.from({ length: 4 * count }, (_, i) => (i % 4 === 0 ? 1 : 0));
    geometry.setAttribute('skinWeight', new BufferAttribute(weights, 4));
    const [skinned, bone] = [new SkinnedMesh(geometry, white()), new Bone()];
    skinned.add(bone);
    skinned.bind(new Skeleton([bone]));
    return [modelOf(white()), skinned].map((model) => {
      const { painter, look, spots } = paintedBall(model);
      model.scale.setScalar(0.5);
      model.position.x = 0.3;
      if (model === skinned) bone.rotation.y = Math.PI / 2;
      else model.rotation.y = Math.PI / 2;
      model.updateMatrixWorld(true);
      const seen = (() => {
        const raycaster = new Raycaster(new Vector3(0.3, 0, 4), new Vector3(0, 0, -1));
        return painter.pick(raycaster)!;
      })();
      const up = new Vector3(1, 0, 0).transformDirection(seen.toCage);
      painter.stroke([seen], { size: 0.1, hardness: 1 });
      const pixels = look();
      const x = Math.floor((new Vector3(0.3, 0, 0.5).project(camera).x + 1) * 0.5 * kSize);
      const miss = spots([2, 2])[0];
      painter.dispose();
      return {
        surface: seen.surface!.point.toArray(),
        right: up.toArray(),
        scale: seen.scale,
        pixel: pixelAt(pixels, x, 32),
        missed: miss === undefined,
      };
    });
  },

  /** What pointers do on the model and beside it. */
  pointers() {
    const { painter, look } = paintedBall();
    const canvas = renderer.domElement;
    document.body.append(canvas);
    const { setPointerCapture } = canvas;
    canvas.setPointerCapture = () => {}; // these pointers are made up
    const bare = look();
    let seen = 0;
    const count = (): number => ++seen;
    canvas.addEventListener('pointerdown', count);
    const stop = painter.listen(camera);
    const { left, top } = canvas.getBoundingClientRect();
    const send = (type: string, x: number, y: number, rest: PointerEventInit = {}): void => {
      const at = { clientX: left + x + 0.5, clientY: top + kSize - y - 0.5 };
      const which = { pointerId: 7, isPrimary: true, bubbles: true, cancelable: true };
      canvas.dispatchEvent(new PointerEvent(type, { ...which, ...at, ...rest }));
    };
    const drag = (from: [number, number], to: [number, number], rest?: PointerEventInit): void => {
      send('pointerdown', ...from, rest);
      send('pointermove', ...to, rest);
      send('pointerup', ...to, rest);
    };
    Object.assign(painter.brush, { size: 0.08, hardness: 1 });
    send('pointerdown', 24, 32);
    send('pointermove', 40, 32);
    const during = pixelAt(look(), 32, 32)[1]!;
    send('pointerup', 40, 32);
    const stroke = [24, 32, 40].map((x) => pixelAt(look(), x, 32)[1]!);
    const whole = filled(painter).texels;
    const captured = seen;
    drag([1, 1], [10, 10]);
    const beside = seen - captured;
    painter.tool = 'eraser';
    drag([32, 32], [33, 32]);
    const erased = pixelAt(look(), 32, 32)[1]! > 100;
    painter.undo();
    painter.undo();
    painter.tool = 'brush';
    drag([24, 32], [40, 32], { pointerType: 'pen', pressure: 0.3 });
    const pen = filled(painter).texels;
    painter.undo();
    painter.tool = 'sticker';
    painter.picture = { text: 'II', color: '#ff0000', size: 0.3 };
    drag([20, 32], [32, 32]);
    const sticker = countOf(look(), 0);
    painter.undo();
    painter.tool = 'brush';
    // A second finger takes back what the first began; others see both come down.
    const fingers: number[] = [];
    const penned: number[] = [];
    const note = ({ pointerId }: PointerEvent): void => void fingers.push(pointerId);
    canvas.addEventListener('pointerdown', note);
    send('pointerdown', 24, 32, { pointerType: 'touch' });
    const second = { pointerType: 'touch', pointerId: 8, isPrimary: false };
    send('pointerdown', 30, 32, second);
    const two = [difference(look(), bare)];
    send('pointerup', 24, 32, { pointerType: 'touch' });
    // Nor does one whose first finger was beside the model.
    send('pointerdown', 1, 1, { pointerType: 'touch' });
    drag([30, 32], [40, 32], second);
    send('pointerup', 1, 1, { pointerType: 'touch' });
    two.push(difference(look(), bare));
    // A hand on the screen does not take a pen's stroke back, whichever came first.
    const hand = { pointerType: 'touch', pointerId: 9 };
    for (const [x, y] of [
      [1, 1],
      [30, 32],
    ] as const)
      for (const isFirst of [true, false]) {
        if (isFirst) send('pointerdown', x, y, hand);
        send('pointerdown', 24, 32, { pointerType: 'pen', pressure: 1 });
        if (!isFirst) send('pointerdown', x, y, hand);
        send('pointermove', 40, 32, { pointerType: 'pen', pressure: 1 });
        send('pointerup', 40, 32, { pointerType: 'pen', pressure: 1 });
        send('pointerup', x, y, hand);
        penned.push(filled(painter).texels);
        painter.undo();
      }
    canvas.removeEventListener('pointerdown', note);
    painter.tool = undefined;
    drag([24, 32], [40, 32]);
    stop();
    painter.tool = 'brush';
    drag([24, 32], [40, 32]);
    const left2 = difference(look(), bare);
    canvas.removeEventListener('pointerdown', count);
    canvas.setPointerCapture = setPointerCapture;
    canvas.remove();
    painter.dispose();
    return { during, stroke, whole, pen, captured, beside, erased, sticker, two, fingers, penned, rest: left2 };
  },

  /** How often a fast mouse makes the painter look for what it is on, in one frame. */
  picks() {
    const { painter } = paintedBall(new Mesh(new SphereGeometry(1, 250, 120), white()));
    const canvas = renderer.domElement;
    document.body.append(canvas);
    const { setPointerCapture } = canvas;
    canvas.setPointerCapture = () => {};
    const stop = painter.listen(camera, canvas);
    const { left, top, width, height } = canvas.getBoundingClientRect();
    const eventAt = (type: string, i: number): PointerEvent =>
      new PointerEvent(type, { isPrimary: true, clientX: left + width / 2 + i, clientY: top + height / 2 });
    const moved = eventAt('pointermove', 16);
    moved.getCoalescedEvents = () => Array.from({ length: 16 }, (_, i) => eventAt('pointermove', i + 1));
    canvas.dispatchEvent(eventAt('pointerdown', 0));
    let picks = 0;
    const { pick } = painter;
    painter.pick = (raycaster) => {
      picks++;
      return pick.call(painter, raycaster);
    };
    canvas.dispatchEvent(moved);
    canvas.dispatchEvent(eventAt('pointerup', 16));
    stop();
    canvas.setPointerCapture = setPointerCapture;
    canvas.remove();
    const isPainted = painter.canUndo;
    painter.dispose();
    return { picks, isPainted };
  },

  /** What a painter needs of the renderer stays as it was. */
  rendererState() {
    const { painter, spots } = paintedBall();
    const before = [renderer.getRenderTarget(), renderer.autoClear, renderer.xr.enabled];
    painter.stroke(spots([32, 32]));
    painter.update();
    const after = [renderer.getRenderTarget(), renderer.autoClear, renderer.xr.enabled];
    painter.dispose();
    return before.every((value, i) => value === after[i]);
  },
};
