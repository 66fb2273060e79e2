// Layers of paint in one texture. Runs in the browser.
import { applyTransfer } from 'cagecast/three';
import { type Blend, createLayers, createPainter, LayerPainter } from 'cagecast/three/paint';
import { DataTexture, MeshBasicMaterial, SRGBColorSpace, WebGLRenderer } from 'three';
import {
  cage,
  clear,
  colorsOf,
  difference,
  draw,
  equal,
  filled,
  flat,
  modelOf,
  near,
  ok,
  refuses,
  renderer,
  type Scenes,
} from './scenes';

const texelOf = ({ data }: ImageData): number[] => [...data.subarray(0, 4)];
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
