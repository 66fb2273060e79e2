// Layers of paint in one texture. Runs in the browser.
import { applyTransfer } from 'cagecast/three';
import { DataTexture, MeshBasicMaterial, SRGBColorSpace, Texture, WebGLRenderer } from 'three';
import {
  type Blend,
  createLayers,
  createPainter,
  LayerPainter,
  type Layers,
  type Painter,
  type SavedLayers,
} from '#three';
import {
  cage,
  clear,
  colorsOf,
  difference,
  draw,
  equal,
  filled,
  flat,
  halves,
  loseContext,
  modelOf,
  near,
  ok,
  pixelAt,
  refuses,
  renderer,
  type Scenes,
} from './scenes';

const texelOf = ({ data }: ImageData): number[] => [...data.subarray(0, 4)];
/** How large the image of a data URL is. */
async function sizeOf(url: string): Promise<string> {
  const { width, height } = await createImageBitmap(await (await fetch(url)).blob());
  return `${width} × ${height}`;
}
/** Two colours, the first on the left. */
function halvesOf(left: number, right: number): DataTexture {
  const texels = Array.from({ length: 64 * 64 }, (_, i) => (i % 64 < 32 ? left : right));
  const texture = new DataTexture(
    new Uint8Array(texels.flatMap((c) => [c >> 16, (c >> 8) & 255, c & 255, 255])),
    64,
    64,
  );
  return Object.assign(texture, { colorSpace: SRGBColorSpace, needsUpdate: true });
}
const plain = () => modelOf(new MeshBasicMaterial({ color: 0xbbbbbb }));
const decode = (byte: number): number =>
  byte <= 0.04045 * 255 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4;
const encode = (share: number): number =>
  255 * (share <= 0.0031308 ? 12.92 * share : 1.055 * share ** (1 / 2.4) - 0.055);
const formulas: Record<Blend, (below: number, layer: number) => number> = {
  normal: (_, layer) => layer,
  multiply: (below, layer) => below * layer,
  screen: (below, layer) => below + layer - below * layer,
  add: (below, layer) => Math.min(1, below + layer),
};

interface LayerStyle {
  color: readonly [number, number, number, number];
  blend: Blend;
  opacity: number;
  tint: string;
}

/** What layers look like, by “Compositing and Blending Level 1” in linear light. */
function blended(layers: readonly LayerStyle[]): number[] {
  let [color, alpha] = [[0, 0, 0], 0];
  for (const { color: own, blend, opacity, tint } of layers) {
    const layerAlpha = (opacity * own[3]) / 255;
    const whole = layerAlpha + alpha * (1 - layerAlpha);
    color = color.map((below, k) => {
      const layer = decode(own[k]!) * decode(Number.parseInt(tint.slice(1 + 2 * k, 3 + 2 * k), 16));
      const mixed = (1 - alpha) * layer + alpha * formulas[blend](below, layer);
      return whole === 0 ? 0 : (layerAlpha * mixed + (1 - layerAlpha) * alpha * below) / whole;
    });
    alpha = whole;
  }
  return [...color.map(encode), 255 * alpha];
}

export const layerScenes: Scenes = {
  'sixteen layers blend by the formulas of their modes; a seventeenth is refused; all can be undone'() {
    const blends = Object.keys(formulas) as Blend[];
    for (const blend of blends) {
      const two = createLayers({ renderer, size: 256 });
      const colors = [
        { color: [230, 180, 120, 255], blend: 'normal' as const, opacity: 1, tint: '#ffffff' },
        { color: [200, 220, 140, 255], blend, opacity: 0.9, tint: '#ffcc99' },
      ] satisfies LayerStyle[];
      for (const {
        color: [r, g, b, a],
        ...style
      } of colors)
        two.add(clear((r! << 16) + (g! << 8) + b!, a!), style);
      near(texelOf(two.toImageData(16)), blended(colors), 1);
      two.dispose();
    }
    const layers = createLayers({ renderer, size: 256 });
    const styles = Array.from(
      { length: 16 },
      (_, i): LayerStyle => ({
        color: [(i * 97) % 256, (i * 53 + 80) % 256, (i * 29 + 30) % 256, 255 - 13 * i],
        blend: i === 0 ? 'normal' : blends[i % 4]!,
        opacity: 1 - 0.04 * i,
        tint: i % 3 === 0 ? '#ffffff' : '#ffcc99',
      }),
    );
    const added = styles.map(({ color: [r, g, b, a], ...style }) =>
      layers.add(clear((r << 16) + (g << 8) + b, a), style),
    );
    const look = () => texelOf(layers.toImageData(16));
    const all = look();
    near(all, blended(styles));
    refuses(() => layers.add(flat(0)), /^There are already 16 layers, the maximum\. Remove one first\.$/);
    layers.move(added[15]!, 0);
    near(look(), blended([styles[15]!, ...styles.slice(0, 15)]));
    equal([layers.undo(), look()], ['moving Layer 16', all]);
    layers.set(added[15]!, { visible: false });
    layers.remove(added[14]!);
    near(look(), blended(styles.slice(0, 14)));
    layers.undo();
    layers.undo();
    equal([look(), layers.list.length, layers.toImageData().width], [all, 16, 256]);
    layers.dispose();
  },

  'a renderer with a reversed depth buffer draws layers, strokes, stickers and filled triangles'() {
    const own = new WebGLRenderer({ reversedDepthBuffer: true } as object);
    const layers = createLayers({ renderer: own, size: 256 });
    layers.add(flat(0xdd3311));
    near(texelOf(layers.toImageData(16)), [0xdd, 0x33, 0x11, 255]);
    layers.dispose();
    const painter = createPainter({ renderer: own, applied: [], cage: cage() });
    const filler = new LayerPainter(painter.layers);
    filler.setCage({
      positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]),
      indices: new Uint32Array([0, 1, 2]),
      uvs: new Float32Array([0, 0, 1, 0, 0, 1]),
    });
    const at = { x: 0.5, y: 0.5 };
    const fill = () => {
      filler.begin('fill', { color: '#ff0000', opacity: 1, hardness: 1, erases: false });
      filler.fill([0, 0, 1, 0, 0, 1]);
      filler.end();
    };
    for (const paint of [
      () => painter.stroke([at], { size: 0.1 }),
      () => painter.sticker({ text: 'III', color: '#ff0000' }, { at }),
      fill,
    ]) {
      paint();
      ok(filled(painter).texels > 100, filled(painter));
      painter.undo();
    }
    filler.dispose();
    painter.dispose();
    painter.layers.dispose();
    own.dispose();
    own.forceContextLoss();
  },

  'an update that fails is made up for by the next one'() {
    const layers = createLayers({ renderer, size: 256 });
    layers.add(flat(0xdd3311));
    const { render } = renderer;
    renderer.render = () => {
      throw new Error('not now');
    };
    refuses(() => layers.update(), /^not now$/);
    renderer.render = render;
    equal(layers.update(), true);
    near(texelOf(layers.toImageData(16)), [0xdd, 0x33, 0x11, 255]);
    layers.dispose();
  },

  'a layer with a region is seen within it only, with its strokes, and beside others'() {
    const around = cage();
    const [left, right] = [0, 0.5].map((u) => [[u, 0], [u + 0.5, 0], [u + 0.5, 1], [u, 1]]); // biome-ignore format: corners
    around.geometry.userData = { regions: { left: [left], right: [right] } };
    const layers = createLayers({ renderer, cage: around, size: 256 });
    for (let i = 0; i < 10; ++i) layers.add(clear(0, 0));
    layers.add(flat(0xdd3311), { region: 'left' });
    layers.add(flat(0x1133dd), { region: 'right', opacity: 0.5 });
    const at = (u: number) => [...layers.toImageData().data.subarray(4 * (128 * 256 + u), 4 * (128 * 256 + u) + 4)];
    near([...at(64), ...at(192)], [0xdd, 0x33, 0x11, 255, 0x11, 0x33, 0xdd, 128], 1);
    layers.set(layers.list[10]!, { region: null });
    near([...at(64), at(192)[3]!], [0xdd, 0x33, 0x11, 255, 255], 1);
    layers.undo();
    for (const { id } of layers.list.slice(0, 3)) layers.remove({ id });
    const painter = createPainter({ renderer, layers, applied: [], cage: around });
    painter.addLayer();
    layers.set(layers.list.at(-1)!, { region: 'left' });
    painter.stroke(
      [0.25, 0.75].map((x) => ({ x, y: 0.5 })),
      { color: '#00ff00', size: 2, hardness: 1 },
    );
    near([...at(64), ...at(192)], [0, 255, 0, 255, 0x11, 0x33, 0xdd, 128], 1);
    painter.dispose();
    layers.dispose();
  },

  async 'saved layers look the same on another model, and are painted on further'() {
    const around = cage();
    around.geometry.userData = { regions: { left: [[[0, 0], [0.5, 0], [0.5, 1], [0, 1]]] } }; // biome-ignore format: corners
    const first = createPainter({ renderer, applied: [], cage: around });
    first.layers.add(halves(0xdd3311, 0x1133dd), { name: 'ground', tint: '#ffccee' });
    first.stroke(
      [
        { x: 0.3, y: 0.4 },
        { x: 0.6, y: 0.6 },
      ],
      { color: '#118800', size: 0.3, opacity: 0.7 },
    );
    first.sticker({ text: '07', color: '#ffffff', outline: '#000000' }, { at: { x: 0.4, y: 0.5 }, size: 0.4 });
    first.layers.add(clear(0xeecc44, 150), { blend: 'multiply', opacity: 0.6, region: 'left' });
    first.layers.add(flat(0), { visible: false });
    const saved: SavedLayers = JSON.parse(JSON.stringify(await first.layers.save()));
    const model = plain();
    const second = createPainter({ renderer, applied: applyTransfer(model, { cage: around }), cage: around });
    second.layers.add(flat(0x00ff00));
    await second.layers.load(saved);
    const look = ({ layers }: Painter) => [...layers.toImageData(256).data];
    near(look(second), look(first), 3);
    const styles = ({ layers }: Painter) => layers.list.map(({ id: _, sheet: __, ...style }) => style);
    equal(styles(second), styles(first));
    const before = look(first);
    for (const one of [first, second]) {
      one.erase([{ x: 0.45, y: 0.5 }], { size: 0.1, opacity: 1 });
      equal(one.layers.list.length, 4);
    }
    near(look(second), look(first), 4);
    ok(difference(look(first), before) > 20, 'nothing is erased');
    await loseContext();
    near(look(second), look(first), 4);
    second.undo();
    equal(second.undo(), 'loading layers');
    equal(second.layers.list.length, 1);
    for (const one of [first, second]) {
      one.dispose();
      one.layers.dispose();
    }
  },

  async 'saved images have the size that they had, and each is there once'() {
    const of = async (add: (layers: Layers) => void) => {
      const layers = createLayers({ renderer });
      add(layers);
      const look = [...layers.toImageData(8).data];
      const saved: SavedLayers = JSON.parse(JSON.stringify(await layers.save()));
      const sizes = await Promise.all((saved.images ?? []).map(sizeOf));
      layers.dispose();
      const again = createLayers({ renderer });
      await again.load(saved);
      near([...again.toImageData(8).data], look, 2);
      again.dispose();
      return { saved, sizes, places: saved.layers.map(({ image }) => image) };
    };
    const dot = () => new DataTexture(new Uint8Array([200, 40, 80, 128]), 1, 1);
    const dots = await of((layers) => {
      const [one, other] = [dot(), dot()].map((texture) =>
        Object.assign(texture, { colorSpace: SRGBColorSpace, needsUpdate: true }),
      );
      for (const texture of [one!, other!, one!]) layers.add(texture);
    });
    equal([dots.places, dots.sizes], [[0, 0, 0], ['1 × 1']]);
    ok(JSON.stringify(dots.saved).length < 1000, `${JSON.stringify(dots.saved).length} characters`);

    // Neither square, nor the right way up, nor as the GPU has it; a relief beside it.
    const wide = halves(0xdd3311, 0x1133dd);
    const relief = Object.assign(new DataTexture(new Uint8Array([128, 128, 255, 255, 128, 128, 255, 255]), 2, 1), {
      needsUpdate: true,
    });
    const canvas = new OffscreenCanvas(3, 5);
    Object.assign(canvas.getContext('2d')!, { fillStyle: '#11aa44' }).fillRect(0, 0, 3, 2);
    const drawn = Object.assign(new Texture(canvas), { colorSpace: SRGBColorSpace, needsUpdate: true });
    const mixed = await of((layers) => {
      layers.add(wide, { normal: relief });
      layers.add(drawn);
    });
    equal(
      [mixed.places, mixed.sizes],
      [
        [0, 2],
        ['4 × 1', '2 × 1', '3 × 5'],
      ],
    );
    equal(mixed.saved.layers[0]!.normal, 1);

    const large = new DataTexture(new Uint8Array(4 * 4096 * 16).fill(255), 4096, 16);
    Object.assign(large, { colorSpace: SRGBColorSpace, needsUpdate: true });
    equal((await of((layers) => layers.add(large))).sizes, ['2048 × 8']);
  },

  'a layer lies as its texture does by itself, upside down or not'() {
    for (const flipY of [false, true]) {
      const texture = new DataTexture(
        Uint8Array.from({ length: 256 }, (_, at) => [at < 128 ? 255 : 0, 0, at < 128 ? 0 : 255, 255][at % 4]!),
        1,
        64,
      );
      Object.assign(texture, { flipY, colorSpace: SRGBColorSpace, needsUpdate: true });
      const [layered, textured] = [plain(), plain()];
      const layers = createLayers({ renderer });
      layers.add(texture);
      layers.update();
      applyTransfer(layered, { cage: cage(), texture: layers.texture });
      applyTransfer(textured, { cage: cage(), texture });
      const [a, b] = [draw(layered).pixels, draw(textured).pixels];
      const red = (pixels: number[]) => [20, 44].map((y) => pixelAt(pixels, 32, y)[0]! > 100);
      for (const pixels of [a, b]) equal(red(pixels), [!flipY, flipY]);
      layers.dispose();
    }
  },

  async 'a layer lies where it is moved, turned and scaled to; it is kept, undone, and not painted on there'() {
    const layers = createLayers({ renderer, size: 256 });
    // Red on the left of green.
    const layer = layers.add(halvesOf(0xff0000, 0x00ff00));
    const drawn = (x: number, y: number): number[] => {
      const { data } = layers.toImageData(256);
      const at = 4 * (256 * Math.floor(256 * y) + Math.floor(256 * x));
      return [...data.subarray(at, at + 4)];
    };
    const [kRed, kGreen, kNone] = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 0, 0]]; // biome-ignore format: colours
    const lies = (places: readonly [x: number, y: number, color: number[] | undefined][]) => {
      for (const [x, y, color] of places) near(drawn(x, y), color!, 1);
    };
    lies([[0.1, 0.5, kRed], [0.9, 0.5, kGreen]]); // biome-ignore format: places
    layers.set(layer, { offset: [0.25, 0] });
    lies([[0.1, 0.5, kNone], [0.4, 0.5, kRed], [0.9, 0.5, kGreen]]); // biome-ignore format: places
    layers.set(layer, { offset: [0, 0], scale: 0.5 });
    lies([[0.1, 0.5, kNone], [0.4, 0.5, kRed], [0.6, 0.5, kGreen], [0.5, 0.1, kNone]]); // biome-ignore format: places
    layers.set(layer, { rotation: Math.PI / 2 }); // clockwise: what was on the left is above
    lies([[0.5, 0.4, kRed], [0.5, 0.6, kGreen]]); // biome-ignore format: places
    layers.set(layer, { scale: 0.5, rotation: Math.PI, center: [0.25, 0.25] });
    lies([[0.3, 0.2, kRed], [0.05, 0.2, kGreen], [0.6, 0.6, kNone]]); // biome-ignore format: places

    const before = [...layers.toImageData(64).data];
    const other = createLayers({ renderer, size: 256 });
    await other.load(JSON.parse(JSON.stringify(await layers.save())));
    equal([...other.toImageData(64).data].join(), before.join());
    const { center, scale, rotation } = other.list[0]!;
    equal([center, scale, rotation], [[0.25, 0.25], 0.5, Math.PI]);
    equal(layers.undo(), 'changing scale, rotation, center of Layer 1');
    equal(layers.list[0]!.rotation, Math.PI / 2);
    layers.redo();
    equal([...layers.toImageData(64).data].join(), before.join());
    const { programs } = renderer.info;
    const count = programs!.length;
    for (let i = 0; i < 5; ++i) {
      layers.set(layer, { rotation: i, offset: [0.01 * i, 0] }, { undoable: false });
      ok(layers.update(), 'nothing was drawn');
    }
    equal(programs!.length, count, 'the number of programs');

    const around = cage();
    const applied = applyTransfer(plain(), { cage: around, texture: layers.texture });
    const painter = createPainter({ renderer, layers, applied, cage: around });
    painter.stroke([{ x: 0.5, y: 0.5 }], { color: '#0000ff', size: 0.2 });
    equal(layers.list.length, 2);
    layers.set(layers.list[1]!, { offset: [0.2, 0] });
    ok(drawn(0.7, 0.5)[2]! > 200, drawn(0.7, 0.5));
    painter.stroke([{ x: 0.5, y: 0.5 }], { color: '#0000ff', size: 0.2 });
    equal(layers.list.length, 3, 'the number of layers');
    layers.dispose();
    other.dispose();
  },

  'a texture of colours without a colour space is told of once'() {
    const heard: string[] = [];
    const { warn } = console;
    console.warn = (text: string) => void heard.push(text);
    const textures = [1, 2].map((n) => Object.assign(flat(0xdd3311), { colorSpace: '', name: `paint ${n}` }));
    const layers = createLayers({ renderer });
    layers.add(textures[0]!);
    for (let i = 0; i < 2; ++i) layers.toImageData(16);
    const model = plain();
    applyTransfer(model, { cage: cage(), texture: textures[1]! });
    for (let i = 0; i < 2; ++i) draw(model);
    console.warn = warn;
    equal(
      heard.map((text) => /"(paint \d)" has no colour space/.exec(text)?.[1]),
      ['paint 1', 'paint 2'],
    );
    layers.dispose();
  },

  'an image of the colours alone is told of once for what it lacks'() {
    const heard: string[] = [];
    const { warn } = console;
    console.warn = (text: string) => void heard.push(text);
    const layers = createLayers({ renderer, size: 256 });
    const layer = layers.add(flat(0xdd3311));
    const read = () => {
      for (let i = 0; i < 2; ++i) layers.toImageData(16);
    };
    read();
    layers.set(layer, { roughness: 0.1, emissive: 1 });
    read();
    layers.set(layer, { roughness: null, visible: false });
    layers.setBaseTint('#ff8800');
    read();
    console.warn = warn;
    layers.dispose();
    equal(
      heard.map((text) => /toImageData has the colours only/.test(text)),
      [true],
    );
  },

  'a layer that is added with all that another one has stays a layer of its own'() {
    const layers = createLayers({ renderer, size: 256 });
    const first = layers.add(flat(0xff0000), { name: 'red' });
    layers.add(flat(0x0000ff), { ...first, name: 'copy' });
    near(texelOf(layers.toImageData(16)), [0, 0, 255, 255]);
    layers.dispose();
  },

  'one stack is shown on several models as a texture would be, and drawn again only after a change'() {
    const layers = createLayers({ renderer });
    const models = [plain(), plain()];
    const applied = models.map((model) => applyTransfer(model, { cage: cage() }));
    for (const one of applied) one.setTexture(layers.texture);
    const layer = layers.add(clear(0xdd3311, 120));
    const textured = plain();
    applyTransfer(textured, { cage: cage(), texture: clear(0xdd3311, 120) });
    const looksLike = (model: ReturnType<typeof plain>, most: number) => {
      layers.update();
      for (const one of models) near(draw(one).pixels, draw(model).pixels, most);
    };
    looksLike(textured, 2);
    layers.set(layer, { opacity: 0 });
    looksLike(plain(), 0);
    equal(layers.update(), false);

    const texture = new DataTexture(new Uint8Array(16), 2, 2);
    texture.colorSpace = SRGBColorSpace;
    layers.add(texture);
    layers.update();
    (texture.image.data as Uint8Array).set([0, 1, 2, 3].flatMap(() => [255, 0, 0, 255]));
    texture.needsUpdate = true;
    layers.update();
    for (const model of models) ok(colorsOf(model)[0]! > 100, colorsOf(model));
    ok(difference(draw(models[0]!).pixels, draw(models[1]!).pixels) === 0, 'the models differ');
    for (const one of applied) one.dispose();
    layers.dispose();
  },
};
