// Brush, eraser, stickers and pointers. Runs in the browser.
import {
  type Applied,
  applyTransfer,
  createLayers,
  createPainter,
  type Layers,
  modelMasks,
  type Painter,
  type StrokePoint,
} from 'cagecast/three';
import {
  Bone,
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
  Texture,
  Vector3,
  WebGLRenderer,
} from 'three';
import {
  ball,
  cage,
  camera,
  clear,
  countOf,
  difference,
  draw,
  equal,
  filled,
  flat,
  kSize,
  loseContext,
  modelOf,
  near,
  ok,
  pixelAt,
  ray,
  renderer,
  type Scenes,
  skinned,
} from './scenes';

const white = (): MeshBasicMaterial => new MeshBasicMaterial({ color: 0xbbbbbb });
const kMiddle = { x: 0.5, y: 0.5 };

interface Painted {
  applied: Applied;
  painter: Painter;
  /** The model as it is drawn now. */
  look(): number[];
  /** The spots of the model at some pixels. */
  spots(...at: readonly (readonly [number, number])[]): StrokePoint[];
}

function paintedBall(model: Object3D = modelOf(white()), layers?: Layers): Painted {
  const applied = applyTransfer(model, { cage: cage() });
  const painter = createPainter({ renderer, layers, applied, cage: cage() });
  painter.brush.color = '#ff0000';
  const look = (): number[] => {
    painter.update();
    return draw(model).pixels;
  };
  const spots: Painted['spots'] = (...at) => at.map(([x, y]) => painter.pick(ray(x, y))!);
  return { applied, painter, look, spots };
}

const isRed = ([r, g]: number[]): boolean => r! > 200 && g! < 40;

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

/** Pointers that are made up, on the renderer's canvas, which is on the page while something runs. */
function withPointers(
  run: (send: (type: string, x: number, y: number, rest?: PointerEventInit) => PointerEvent) => void,
): void {
  const canvas = renderer.domElement;
  document.body.append(canvas);
  const { setPointerCapture } = canvas;
  canvas.setPointerCapture = () => {};
  const { left, top } = canvas.getBoundingClientRect();
  try {
    run((type, x, y, rest) => {
      const at = { clientX: left + x + 0.5, clientY: top + kSize - y - 0.5 };
      const which = { pointerId: 7, isPrimary: true, bubbles: true, cancelable: true };
      const event = new PointerEvent(type, { ...which, ...at, ...rest });
      canvas.dispatchEvent(event);
      return event;
    });
  } finally {
    canvas.setPointerCapture = setPointerCapture;
    canvas.remove();
  }
}

const strokes: Scenes = {
  'a stroke can be undone and repeated; the eraser leaves nothing of it, not even its soft edge'() {
    const { painter, look, spots } = paintedBall();
    const bare = look();
    const path = spots([24, 32], [40, 32]);
    painter.stroke(path, { size: 0.1, hardness: 1 });
    const painted = look();
    const [on, off] = [pixelAt(painted, 32, 32), pixelAt(painted, 32, 48)];
    ok(isRed(on) && off[0] === off[1], [on, off]);
    equal([painter.undo(), difference(look(), bare)], ['stroke', 0]);
    equal([painter.redo(), difference(look(), painted)], ['stroke', 0]);
    painter.undo();
    const isStill = { target: renderer.getRenderTarget(), autoClear: renderer.autoClear, xr: renderer.xr.enabled };
    // Over and over, and softly.
    painter.stroke(path, { size: 0.15, hardness: 0, opacity: 0.6 });
    const soft = filled(painter);
    ok(soft.texels > 1000, soft);
    near([soft.most], [0.6 * 255]);
    painter.erase(path, { size: 0.15, hardness: 0, opacity: 0.6 });
    equal(filled(painter).texels, 0);
    painter.undo();
    equal(filled(painter).texels, soft.texels);
    painter.erase(spots([40, 32]), { size: 0.05, hardness: 1 });
    const half = filled(painter).texels;
    ok(half > 0.3 * soft.texels && half < soft.texels, [half, soft.texels]);
    equal(painter.layers.list.length, 1);
    const is = { target: renderer.getRenderTarget(), autoClear: renderer.autoClear, xr: renderer.xr.enabled };
    equal(is, isStill, 'the renderer');
    painter.dispose();
  },

  'mirrored strokes paint both sides, and pressure makes them wider'() {
    const { painter, look, spots } = paintedBall();
    painter.stroke(spots([20, 32]), { size: 0.1, hardness: 1, mirror: true });
    const pixels = look();
    for (const x of [20, 43]) ok(isRed(pixelAt(pixels, x, 32)), pixelAt(pixels, x, 32));
    painter.undo();
    const [from, to] = spots([16, 32], [48, 32]) as [StrokePoint, StrokePoint];
    const style = { size: 0.2, hardness: 1 };
    painter.stroke([from, to], style);
    const full = filled(painter).texels;
    painter.undo();
    painter.stroke([{ ...from, pressure: 0.1 }, to], style);
    const thin = filled(painter).texels;
    ok(thin > 0.2 * full && thin < 0.8 * full, `${thin} of ${full}`);
    const pressed = look();
    // Near its ends.
    const [thinner, wider] = [20, 44].map(
      (x) =>
        Array.from({ length: kSize }, (_, y) => pixelAt(pressed, x, y)).filter(([r, g]) => r! > 200 && g! < 80).length,
    ) as [number, number];
    ok(thinner > 0 && wider > 2 * thinner, [thinner, wider]);
    painter.dispose();
  },

  'models that were moved, turned and posed are painted where they are seen'() {
    const inside = new SkinnedMesh(skinned().mesh.geometry, white());
    const bone = new Bone();
    inside.add(bone);
    inside.bind(new Skeleton([bone]));
    for (const model of [modelOf(white()), inside]) {
      const { painter, look, spots } = paintedBall(model);
      model.scale.setScalar(0.5);
      model.position.x = 0.3;
      (model === inside ? bone : model).rotation.y = Math.PI / 2;
      model.updateMatrixWorld(true);
      const seen = painter.pick(new Raycaster(new Vector3(0.3, 0, 4), new Vector3(0, 0, -1)))!;
      // Turned by a quarter about y, what was on the left is in front.
      near(seen.surface!.point.toArray(), [-1.1, 0, 0], 0.05);
      near(new Vector3(1, 0, 0).transformDirection(seen.toCage).toArray(), [0, 0, 1], 0.05);
      near([seen.scale], [0.5], 0.01);
      painter.stroke([seen], { size: 0.1, hardness: 1 });
      const x = Math.floor((new Vector3(0.3, 0, 0.5).project(camera).x + 1) * 0.5 * kSize);
      ok(isRed(pixelAt(look(), x, 32)), pixelAt(look(), x, 32));
      equal(spots([2, 2]), [undefined]);
      painter.dispose();
    }
  },

  'directions on a model, mirrored or not, are those of the cage'() {
    for (const x of [1, -1]) {
      const model = modelOf(white());
      model.scale.x = x;
      const { painter, spots } = paintedBall(model);
      const { toCage } = spots([40, 40])[0] as { toCage: Matrix4 };
      near(toCage.elements, new Matrix4().elements, 1e-6);
      painter.dispose();
    }
  },

  'a part that was taken out of a model in a scene is not picked'() {
    const [head, hair] = [new Mesh(ball(0.8), white()), new Mesh(ball(), white())];
    const { painter } = paintedBall(new Group().add(head, hair));
    const look = () => painter.pick(ray(32, 32))?.mesh;
    ok(look() === hair, 'not the hair');
    new Scene().add(head.parent!);
    ok(look() === hair, 'not the hair, in a scene');
    hair.removeFromParent();
    ok(look() === head, 'not the head');
    painter.dispose();
  },

  'the texture below new layers cannot be undone; given layers stay as they are'() {
    const applied = applyTransfer(modelOf(white()), { cage: cage() });
    const options = { texture: clear(0xff0000, 255), applied, cage: cage() };
    const { layers } = createPainter({ ...options, renderer });
    equal([layers.undo(), layers.list.length], [undefined, 1]);
    createPainter({ ...options, layers });
    equal(layers.list.length, 1);
  },
};

/** A canvas, red above and blue below. */
function redAboveBlue(): HTMLCanvasElement {
  const context = document.createElement('canvas').getContext('2d')!;
  context.canvas.width = context.canvas.height = 64;
  for (const [color, y] of [
    ['#ff0000', 0],
    ['#0000ff', 32],
  ] as const) {
    context.fillStyle = color;
    context.fillRect(0, y, 64, 32);
  }
  return context.canvas;
}
const nameOf = ([r, , b]: number[]): string => (r! > 2 * b! ? 'red' : b! > 2 * r! ? 'blue' : 'none');

const stickers: Scenes = {
  'text and images lie upright on the model, or turned'() {
    const { painter, look, spots } = paintedBall();
    const [at] = spots([32, 32]);
    painter.sticker({ text: 'III', color: '#ff0000' }, { at: at!, size: 0.25 });
    const reds = countOf(look(), 0);
    ok(reds > 5, `${reds} red pixels`);
    painter.undo();
    for (const [angle, ends] of [
      [0, ['red', 'blue']],
      [Math.PI, ['blue', 'red']],
    ] as const) {
      painter.sticker({ image: redAboveBlue() }, { at: at!, size: 0.25, angle });
      const pixels = look();
      equal(
        [36, 28].map((y) => nameOf(pixelAt(pixels, 32, y))),
        ends,
      );
      painter.undo();
    }
    painter.dispose();
  },

  async 'an image that the page shows in another size is a sticker, and a mask, of its own shape'() {
    const { painter } = paintedBall();
    const image = await shownImage(128, 32);
    painter.sticker({ image }, { at: kMiddle, size: 0.1 });
    const { data, width } = painter.layers.toImageData();
    const texels = Array.from({ length: width * width }, (_, i) => i).filter((i) => data[4 * i + 3]! >= 128);
    const [columns, rows] = [(i: number) => i % width, (i: number) => Math.floor(i / width)].map(
      (place) => new Set(texels.map(place)).size,
    ) as [number, number];
    // Four times as wide as high, in texels of a ball, which are twice as wide as high.
    ok(columns > 1.7 * rows && columns < 2.3 * rows, [columns, rows]);
    const { triangles } = modelMasks(ball(), { never: new Texture(image) });
    ok(
      triangles!.every((mask) => mask === -1),
      'not all is masked',
    );
    image.remove();
    painter.dispose();
  },

  'a text that is laid again has the font that was loaded meanwhile'() {
    const { painter } = paintedBall();
    const texels = (): number => {
      painter.sticker({ text: 'III', color: '#ff0000' }, { at: kMiddle });
      const found = filled(painter).texels;
      painter.undo();
      return found;
    };
    const before = texels();
    const { fillText } = CanvasRenderingContext2D.prototype;
    // One whose letters are solid.
    CanvasRenderingContext2D.prototype.fillText = function () {
      this.fillRect(0, 0, this.canvas.width, this.canvas.height);
    };
    const after = texels();
    CanvasRenderingContext2D.prototype.fillText = fillText;
    ok(before > 0 && after > 1.2 * before, `${after} texels after ${before}`);
    painter.dispose();
  },

  async 'stickers show a canvas as it is now, and their picture after the graphics context was lost'() {
    const { painter, look, spots } = paintedBall();
    const [at] = spots([32, 32]);
    const lay = (image: HTMLCanvasElement | ImageBitmap): string => {
      painter.sticker({ image }, { at: at!, size: 0.25 });
      const seen = nameOf(pixelAt(look(), 32, 32));
      painter.undo();
      return seen;
    };
    const context = document.createElement('canvas').getContext('2d')!;
    for (const [color, name] of Object.entries({ '#ff0000': 'red', '#0000ff': 'blue' })) {
      context.fillStyle = color;
      context.fillRect(0, 0, 300, 150);
      equal(lay(context.canvas), name);
    }
    const picture = await createImageBitmap(context.canvas);
    equal([lay(picture), lay(picture)], ['blue', 'blue']);
    await loseContext();
    equal(lay(picture), 'blue');
    painter.dispose();
  },
};

const lives: Scenes = {
  'a painter that was disposed of paints no more, and what it has painted can be undone'() {
    const { painter, spots } = paintedBall();
    const [spot] = spots([32, 32]);
    painter.stroke([spot]);
    const { texels } = filled(painter);
    painter.dispose();
    const picture = { text: 'A', color: '#ff0000' };
    for (const at of [kMiddle, spot!]) {
      painter.stroke([at]);
      painter.erase([at]);
      painter.sticker(picture, { at });
    }
    painter.dispose();
    ok(texels > 0 && filled(painter).texels === texels, [texels, filled(painter)]);
    painter.undo();
    equal(filled(painter).texels, 0);
    painter.layers.dispose();
  },

  async 'what was painted outlives its painter, and the graphics context'() {
    const { painter, look, spots } = paintedBall();
    const { layers } = painter;
    painter.stroke(spots([32, 32]), { size: 0.2, hardness: 1 });
    painter.dispose();
    let changes = 0;
    layers.on('change', () => changes++);
    const before = pixelAt(look(), 32, 32);
    equal(nameOf(before), 'red');
    await loseContext();
    equal(pixelAt(look(), 32, 32), before);
    ok(changes > 0, 'who draws on demand gets no word');
    layers.dispose();
  },

  async 'a stroke while the graphics context is lost leaves what was painted'() {
    const { painter, look, spots } = paintedBall();
    const at = spots([32, 32]);
    const stroke = (color: string) => painter.stroke(at, { color, size: 0.2, hardness: 1 });
    stroke('#ff0000');
    const before = pixelAt(look(), 32, 32);
    equal(nameOf(before), 'red');
    await loseContext(() => stroke('#0000ff'));
    equal(pixelAt(look(), 32, 32), before);
    painter.dispose();
  },

  async 'renderers and painters leave nothing behind when they are disposed of'() {
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
      painter.stroke([kMiddle]);
      painter.sticker({ text: 'A', color: '#ff0000' }, { at: kMiddle });
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
    ok(Math.min(...made) >= 3, made);
    const { collectGarbage } = globalThis as unknown as { collectGarbage(): Promise<void> };
    const left = () => Object.values(kept).flatMap((refs) => refs.filter((ref) => ref.deref())).length;
    // What one collection frees may have held something else, and contexts tell of their loss when they have time.
    for (let i = 0; i < 50 && left() > 0; ++i) {
      await new Promise((resolve) => setTimeout(resolve, 10));
      await collectGarbage();
    }
    equal(left(), 0, 'what is left');
    layers.dispose();
  },

  'painters that have painted nothing leave no listener on their layers'() {
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
    for (const paints of [true, false]) {
      const before = listeners;
      const painter = createPainter({ layers, applied: [], cage: cage() });
      if (paints) painter.stroke([kMiddle]);
      painter.dispose();
      equal(listeners - before, Number(paints), 'the number of listeners');
    }
    layers.dispose();
  },
};

const pointers: Scenes = {
  'painters that listen to one element leave it as it was once the last has ended; none begins when disposed of'() {
    const layers = createLayers({ renderer, size: 256 });
    const [first, second] = [1, 2].map(() => createPainter({ layers, applied: [], cage: cage() })) as [
      Painter,
      Painter,
    ];
    const element = document.createElement('div');
    element.style.touchAction = 'pan-y';
    const stops = [first, second].map((painter) => painter.listen(camera, element)) as [() => void, () => void];
    const after = (runs: (() => unknown)[], expected: string[]): void => {
      for (const [i, run] of runs.entries()) {
        run();
        equal(element.style.touchAction, expected[i], `touch-action after ${run}`);
      }
    };
    after([stops[0], stops[0], () => second.dispose()], ['none', 'none', 'pan-y']);
    element.style.touchAction = 'auto'; // by another
    const late = () => second.listen(camera, element);
    after([stops[1], () => second.dispose(), late, () => late()()], ['auto', 'auto', 'auto', 'auto']);
    after([() => first.listen(camera, element), () => first.dispose()], ['none', 'auto']);
    layers.dispose();
  },

  'why a pointer cannot paint is reported, such as that there are too many layers'() {
    const layers = createLayers({ renderer, size: 256 });
    for (let i = 0; i < 16; ++i) layers.add(clear(0, 0));
    const { painter } = paintedBall(modelOf(white()), layers);
    const reported: string[] = [];
    painter.on('error', ({ message }) => void reported.push(message));
    withPointers((send) => {
      painter.listen(camera);
      send('pointerdown', 32, 32);
      painter.tool = 'sticker';
      painter.picture = { image: new Image() };
      send('pointerdown', 32, 32);
    });
    equal(reported.length, 2);
    ok(/already 16 layers/.test(reported[0]!) && /the image is not loaded yet$/.test(reported[1]!), reported);
    equal(layers.history.held, false);
    painter.dispose();
    layers.dispose();
  },

  'a fast mouse does not make the painter look for what it is on at each of its points'() {
    const { painter } = paintedBall(new Mesh(new SphereGeometry(1, 250, 120), white()));
    withPointers((send) => {
      painter.listen(camera);
      const { pick } = painter;
      let picks = 0;
      painter.pick = (raycaster) => {
        picks++;
        return pick.call(painter, raycaster);
      };
      send('pointerdown', 24, 32);
      picks = 0;
      const { getCoalescedEvents } = PointerEvent.prototype;
      PointerEvent.prototype.getCoalescedEvents = function () {
        const { clientX, clientY } = this;
        return Array.from({ length: 16 }, (_, i) => new PointerEvent('', { clientX: clientX - 15 + i, clientY }));
      };
      send('pointermove', 40, 32);
      PointerEvent.prototype.getCoalescedEvents = getCoalescedEvents;
      ok(picks <= 7, `${picks} times on a model of 60,000 triangles`);
      send('pointerup', 40, 32);
    });
    equal(painter.canUndo, true);
    painter.dispose();
  },

  'pointers paint, erase and place stickers; beside the model they are left to others'() {
    const { painter, look } = paintedBall();
    const bare = look();
    const green = (x: number) => pixelAt(look(), x, 32)[1]!;
    const seen: number[] = [];
    const note = ({ pointerId }: PointerEvent): void => void seen.push(pointerId);
    renderer.domElement.addEventListener('pointerdown', note);
    const stop = painter.listen(camera);
    withPointers((send) => {
      const drag = (from: [number, number], to: [number, number], rest?: PointerEventInit): void => {
        send('pointerdown', ...from, rest);
        send('pointermove', ...to, rest);
        send('pointerup', ...to, rest);
      };
      Object.assign(painter.brush, { size: 0.08, hardness: 1 });
      send('pointerdown', 24, 32);
      send('pointermove', 40, 32);
      ok(green(32) < 40, `${green(32)} while the pointer is down`);
      send('pointerup', 40, 32);
      for (const x of [24, 32, 40]) ok(green(x) < 40, `${green(x)} at ${x}`);
      equal(seen, [], 'what others see of it');
      const whole = filled(painter).texels;
      drag([1, 1], [10, 10]);
      equal(seen.splice(0), [7], 'what others see beside the model');
      painter.tool = 'eraser';
      drag([32, 32], [33, 32]);
      ok(green(32) > 100, `${green(32)} after erasing`);
      painter.undo();
      painter.undo();
      painter.tool = 'brush';
      drag([24, 32], [40, 32], { pointerType: 'pen', pressure: 0.3 });
      const pen = filled(painter).texels;
      ok(pen > 0 && pen < 0.6 * whole, `${pen} of ${whole}`);
      painter.undo();
      painter.tool = 'sticker';
      painter.picture = { text: 'II', color: '#ff0000', size: 0.3 };
      drag([20, 32], [32, 32]);
      const reds = countOf(look(), 0);
      ok(reds > 5, `${reds} red pixels of a sticker`);
      painter.undo();

      // A second finger takes back what the first began; others see both come down.
      painter.tool = 'brush';
      const touch = { pointerType: 'touch' };
      const second = { ...touch, pointerId: 8, isPrimary: false };
      send('pointerdown', 24, 32, touch);
      send('pointerdown', 30, 32, second);
      equal(difference(look(), bare), 0);
      send('pointerup', 24, 32, touch);
      // Nor does one paint whose first finger was beside the model.
      send('pointerdown', 1, 1, touch);
      drag([30, 32], [40, 32], second);
      send('pointerup', 1, 1, touch);
      equal(difference(look(), bare), 0);
      equal(seen.splice(0), [7, 8, 7, 8], 'what others see of two fingers');
      // A hand on the screen does not take a pen's stroke back, whichever came first.
      const hand = { ...touch, pointerId: 9 };
      const pressed = { pointerType: 'pen', pressure: 1 };
      for (const [x, y] of [
        [1, 1],
        [30, 32],
      ] as const)
        for (const isFirst of [true, false]) {
          if (isFirst) send('pointerdown', x, y, hand);
          send('pointerdown', 24, 32, pressed);
          if (!isFirst) send('pointerdown', x, y, hand);
          send('pointermove', 40, 32, pressed);
          send('pointerup', 40, 32, pressed);
          send('pointerup', x, y, hand);
          equal(filled(painter).texels, whole, 'the texels that a pen has painted');
          painter.undo();
        }
      ok(!seen.includes(7), 'others see the pen');
      painter.tool = undefined;
      drag([24, 32], [40, 32]);
      stop();
      painter.tool = 'brush';
      drag([24, 32], [40, 32]);
      equal(difference(look(), bare), 0);
    });
    renderer.domElement.removeEventListener('pointerdown', note);
    painter.dispose();
  },
};

export const painterScenes: Scenes = { ...strokes, ...stickers, ...lives, ...pointers };
