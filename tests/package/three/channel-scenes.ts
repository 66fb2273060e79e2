// What layers make of the surface besides its colour, and the tint beneath them. Runs in the browser.
import {
  applyTransfer,
  createLayers,
  createPainter,
  type Layers,
  type LayersOptions,
  type NewLayer,
} from 'cagecast/three';
import {
  Color,
  DataTexture,
  type Group,
  LinearFilter,
  type Material,
  type Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  MeshMatcapMaterial,
  MeshPhongMaterial,
  MeshStandardMaterial,
  MeshToonMaterial,
  PointLight,
  Scene,
  Texture,
  Vector2,
} from 'three';
import {
  cage,
  camera,
  clear,
  difference,
  draw,
  equal,
  flat,
  halves,
  kSize,
  loseContext,
  modelOf,
  ok,
  pixelAt,
  refuses,
  renderer,
  type Scenes,
} from './scenes';

const kColor = 0x884422;
const matt = (color: number | Color = 0xbbbbbb): MeshStandardMaterial =>
  new MeshStandardMaterial({ color, roughness: 1 });

/** A cage of whose regions one is the left half of what is seen. */
function around(): Mesh {
  const one = cage();
  one.geometry.userData = { regions: { left: [[[0, 0], [0.25, 0], [0.25, 1], [0, 1]]] } }; // biome-ignore format: corners
  return one;
}

/** A ball with layers. */
function painted(material: Material = matt(), options: Partial<LayersOptions> = {}, feather = 0) {
  const one = around();
  const layers = createLayers({ renderer, cage: one, ...options });
  const model = modelOf(material);
  const applied = applyTransfer(model, { cage: one, feather });
  applied.setTexture(layers.texture);
  const look = (): number[] => {
    layers.update();
    return draw(model).pixels;
  };
  return { layers, model, applied, look };
}

/** What a layer looks like on a matt ball. */
function lookWith(style: NewLayer, texture: Texture = flat(kColor)): number[] {
  const { layers, look } = painted();
  layers.add(texture, style);
  const pixels = look();
  layers.dispose();
  return pixels;
}

const lookOf = (material: Material): number[] => draw(modelOf(material)).pixels;

/** The mean difference where a ball is seen, of each channel, 0 to 255. */
function mean(a: readonly number[], b: readonly number[]): number {
  const bare = draw(modelOf(new MeshBasicMaterial({ color: 0 }))).pixels;
  const area = bare.flatMap((_, at) => (at % 4 < 3 && bare[4 * Math.floor(at / 4) + 2]! < 10 ? [at] : []));
  return area.reduce((sum, at) => sum + Math.abs(a[at]! - b[at]!), 0) / area.length;
}

/** The pixels of the left half of a picture, or of the right one; those in the middle are of neither. */
const halfOf = (pixels: readonly number[], isLeft: boolean): number[] =>
  pixels.filter((_, at) => {
    const x = Math.floor(at / 4) % kSize;
    return isLeft ? x < kSize / 2 - 2 : x > kSize / 2 + 2;
  });

/** What is seen by a light of one's own, or none. */
function seenBy(model: Group, light?: PointLight): number[] {
  const scene = new Scene().add(model);
  if (light) scene.add(light);
  renderer.render(scene, camera);
  const gl = renderer.getContext();
  const bytes = new Uint8Array(4 * kSize * kSize);
  gl.readPixels(0, 0, kSize, kSize, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  model.removeFromParent();
  return [...bytes];
}

/** A normal map of bumps. */
function bumps(flipY = false, side = 128): DataTexture {
  const data = new Uint8Array(4 * side * side);
  for (let y = 0; y < side; ++y)
    for (let x = 0; x < side; ++x) {
      const at = (one: number): number => 0.5 * Math.sin((one / side) * 2 * Math.PI * 5);
      const [a, b] = [at(x), 0.7 * at(y + 3)];
      const c = Math.sqrt(1 - a * a - b * b);
      data.set([a, b, c].map((value) => Math.round(127.5 + 127.5 * value)).concat(255), 4 * (y * side + x));
    }
  const texture = new DataTexture(data, side, side);
  return Object.assign(texture, { flipY, minFilter: LinearFilter, magFilter: LinearFilter, needsUpdate: true });
}

const programOf = (model: Group): unknown => {
  const { material } = model.children[0] as Mesh;
  return (renderer.properties.get(material) as { currentProgram: unknown }).currentProgram;
};

export const channelScenes: Scenes = {
  'a glossy layer has a highlight under a point light, within its region only'() {
    const { layers, model } = painted(matt(0x888888));
    const light = new PointLight(0xffffff, 30);
    light.position.set(-1.2, 0.8, 3);
    const bare = seenBy(model, light);
    const layer = layers.add(flat(0xffffff), { blend: 'none', region: 'left' });
    layers.update();
    equal(difference(seenBy(model, light), bare), 0, 'without a channel, the difference');
    layers.set(layer, { roughness: 0.2 });
    layers.update();
    const glossy = seenBy(model, light);
    const brighter = halfOf(glossy, true).filter((value, at) => value > halfOf(bare, true)[at]! + 30).length;
    ok(brighter > 40, `${brighter} values are brighter`);
    equal(difference(halfOf(glossy, false), halfOf(bare, false)), 0, 'the other half differs');
    layers.dispose();
  },

  'roughness and metalness are those of a material that has them, in part where a layer is not opaque'() {
    for (const [style, reference] of [
      [{ roughness: 0.3 }, { color: kColor, roughness: 0.3 }],
      [{ metalness: 1 }, { color: kColor, roughness: 1, metalness: 1 }],
      [
        { metalness: 0.8, roughness: 0.25 },
        { color: kColor, roughness: 0.25, metalness: 0.8 },
      ],
      [
        { roughness: 0.2, opacity: 0.5, blend: 'none' },
        { color: 0xbbbbbb, roughness: 0.6 },
      ],
      [
        { metalness: 1, opacity: 0.5, blend: 'none' },
        { color: 0xbbbbbb, roughness: 1, metalness: 0.5 },
      ],
    ] as const) {
      const apart = difference(lookWith(style), lookOf(new MeshStandardMaterial(reference)));
      ok(apart <= 3, `${JSON.stringify(style)}: ${apart} of 255`);
    }
    // Of two layers, each with one of both, and a third with neither.
    const { layers, look } = painted();
    layers.add(flat(0x00ff00), { metalness: 1 });
    layers.add(flat(0x0000ff), { roughness: 0.4 });
    layers.add(flat(kColor), { opacity: 0.999 });
    const both = lookOf(new MeshStandardMaterial({ color: kColor, roughness: 0.4, metalness: 1 }));
    ok(difference(look(), both) <= 3, difference(look(), both));
    layers.dispose();
  },

  'a layer glows in its own colour without light; an opaque layer covers that, others do not'() {
    const { layers, model } = painted();
    const glow = layers.add(flat(kColor), { emissive: 0.6, tint: '#ffddee' });
    const seen = () => {
      layers.update();
      return seenBy(model);
    };
    const emissive = new Color(kColor).multiply(new Color('#ffddee'));
    const reference = (emissiveIntensity: number, color = emissive) =>
      seenBy(modelOf(new MeshStandardMaterial({ emissive: color, emissiveIntensity })));
    ok(difference(seen(), reference(0.6)) <= 2, difference(seen(), reference(0.6)));
    layers.set(glow, { emissive: 3 });
    ok(difference(seen(), reference(3)) <= 2, difference(seen(), reference(3)));
    layers.set(glow, { opacity: 0.5 });
    ok(difference(seen(), reference(1.5)) <= 2, difference(seen(), reference(1.5)));
    layers.set(glow, { opacity: 1, emissive: 1 });
    const cover = layers.add(clear(0x112233, 128));
    ok(difference(seen(), reference(1 - 128 / 255)) <= 2, 'a layer that covers half of it');
    layers.set(cover, { blend: 'multiply' });
    ok(difference(seen(), reference(1)) <= 2, 'a layer that multiplies');
    layers.set(cover, { blend: 'none', emissive: 0.5 });
    const sum = emissive.clone().add(new Color(0x112233).multiplyScalar((0.5 * 128) / 255));
    ok(difference(seen(), reference(1, sum)) <= 2, 'two that glow');
    layers.dispose();
  },

  'a normal map looks as on a material, upside down or not, strong or weak, and with many layers'() {
    const bare = lookOf(matt(kColor));
    for (const flipY of [false, true])
      for (const normalScale of [1, 0.5, -1.5]) {
        const normalMap = bumps(flipY);
        const scale = new Vector2(normalScale, flipY ? normalScale : -normalScale);
        const reference = lookOf(
          new MeshStandardMaterial({ color: kColor, roughness: 1, normalMap, normalScale: scale }),
        );
        const look = lookWith({ normal: normalMap, normalScale });
        const [apart, effect] = [mean(look, reference), mean(reference, bare)];
        ok(effect > 2, `the bumps change ${effect}`);
        ok(apart <= 2, `flipY ${flipY}, scale ${normalScale}: ${apart} of 255, of ${effect}`);
      }
    // Before it is loaded it is flat; one of two channels has no blue.
    const late = new Texture() as DataTexture;
    const { layers, look } = painted();
    layers.add(flat(kColor), { normal: late });
    equal(difference(look(), lookWith({})), 0, 'before the normal map is loaded, the difference');
    const packed = bumps();
    (packed.image.data as Uint8Array).forEach((_, at, data) => {
      if (at % 4 === 2) data[at] = 0;
    });
    Object.assign(late, {
      isDataTexture: true,
      image: packed.image,
      flipY: false,
      unpackAlignment: 1,
      needsUpdate: true,
    });
    const apart = difference(look(), lookWith({ normal: bumps() }));
    ok(apart <= 3, `a packed one: ${apart}`);
    layers.dispose();
  },

  'of many layers, which take several passes, each counts'() {
    const half = clear(kColor, 128);
    const [low, high] = [bumps(), bumps(true, 64)];
    // From the lowest: one covers all, others cover nothing, and one covers half of it.
    const lookOfAll = (between: number): number[] => {
      const { layers, look } = painted();
      const nothing = { normal: high, roughness: 0, metalness: 1, emissive: 1 };
      layers.add(flat(kColor), { normal: low, normalScale: 0.7, roughness: 0.3, metalness: 0.5, emissive: 0.2 });
      for (let i = 0; i < between; ++i) layers.add(clear(0xffffff, 0), nothing);
      layers.add(half, { normal: high, roughness: 0.9, metalness: 0 });
      const pixels = look();
      layers.dispose();
      return pixels;
    };
    const two = lookOfAll(0);
    for (const between of [5, 11, 14]) {
      const apart = mean(lookOfAll(between), two);
      ok(apart <= 0.5, `${between + 2} layers: ${apart}`);
    }
  },

  'materials without roughness ignore it; they show glow and relief as far as they are lit'() {
    const normal = bumps();
    for (const [material, glows, tilts] of [
      [new MeshBasicMaterial(), false, false],
      [new MeshLambertMaterial(), true, true],
      [new MeshPhongMaterial(), true, true],
      [new MeshToonMaterial(), true, true],
      [new MeshMatcapMaterial({ matcap: halves(0xffffff, 0x333333) }), false, true],
    ] as const) {
      const { layers, look } = painted(material);
      const layer = layers.add(flat(kColor));
      const plain = look();
      const differs = (style: Partial<NewLayer>): boolean => {
        layers.set(layer, style);
        return difference(look(), plain) > 10;
      };
      equal(
        [
          differs({ roughness: 0, metalness: 1 }),
          differs({ roughness: null, metalness: null, emissive: 1 }),
          differs({ emissive: 0, normal }),
        ],
        [false, glows, tilts],
        material.type,
      );
      layers.dispose();
    }
  },

  'saved layers have all channels and the tint; steps take them back'() {
    return withAll(async (layers, look) => {
      const before = look();
      const saved = JSON.parse(JSON.stringify(await layers.save()));
      const other = painted();
      await other.layers.load(saved);
      const apart = difference(other.look(), before);
      ok(apart <= 2, `loaded: ${apart}`);
      equal(other.layers.baseTint, '#ffaa88');
      equal(JSON.parse(JSON.stringify(await other.layers.save())).layers[1].roughness, 0.2);
      equal(other.layers.undo(), 'loading layers');
      equal(other.layers.baseTint, '#ffffff');
      equal(difference(other.look(), lookOf(matt())), 0, 'the bare one');
      other.layers.redo();
      equal(other.layers.baseTint, '#ffaa88');
      ok(difference(other.look(), before) <= 2, 'loaded again');
      other.layers.dispose();
      await loseContext();
      const again = difference(look(), before);
      ok(again <= 1, `after the context was lost: ${again}`);
    });
  },

  'without channels and tint, the picture, the program and the textures are those of before'() {
    const { layers, model, look } = painted();
    const ground = layers.add(flat(kColor));
    const bare = look();
    const [program, { textures }] = [programOf(model), { ...renderer.info.memory }];
    for (const style of [
      { roughness: 0.1 },
      { metalness: 1 },
      { emissive: 1 },
      { normal: bumps(), normalScale: 0.5 },
    ] as Partial<NewLayer>[]) {
      layers.set(ground, style);
      ok(difference(look(), bare) > 5, JSON.stringify(style));
      ok(programOf(model) !== program, 'the program is the same');
      equal(layers.undo(), `changing ${Object.keys(style).join(', ')} of Layer 1`);
      equal(difference(look(), bare), 0, `the difference after ${Object.keys(style)}`);
      ok(programOf(model) === program, 'the program is another');
      for (const { normal } of [style]) normal?.dispose();
      equal(renderer.info.memory.textures, textures);
    }
    layers.setBaseTint('#ff0000');
    layers.set(ground, { visible: false });
    ok(difference(look(), lookOf(matt())) > 5, 'no tint is seen');
    layers.setBaseTint('#ffffff');
    layers.set(ground, { visible: true });
    equal(difference(look(), bare), 0);
    ok(programOf(model) === program, 'the program is another');
    // A layer that is not seen needs nothing.
    layers.add(flat(0), { roughness: 0, visible: false });
    layers.add(flat(0), { emissive: 1, opacity: 0 });
    look();
    ok(
      programOf(model) === program && renderer.info.memory.textures === textures,
      'layers that are not seen cost something',
    );
    layers.dispose();
  },

  'the base tint multiplies the colour of the model beneath the layers, as far as it is painted'() {
    for (const make of [
      (color: Color) => new MeshBasicMaterial({ color }),
      (color: Color) => new MeshLambertMaterial({ color }),
      (color: Color) => new MeshPhongMaterial({ color }),
      (color: Color) => new MeshStandardMaterial({ color }),
      (color: Color) => new MeshToonMaterial({ color }),
    ]) {
      const { layers, applied, look } = painted(make(new Color(0xccbbaa)));
      const bare = look();
      layers.setBaseTint('#dd8844');
      const reference = lookOf(make(new Color(0xccbbaa).multiply(new Color('#dd8844'))));
      ok(difference(look(), reference) <= 1, difference(look(), reference));
      applied.setOpacity(0);
      equal(difference(look(), bare), 0, 'the difference at opacity 0');
      applied.setOpacity(1);
      layers.add(flat(kColor));
      ok(difference(look(), lookOf(make(new Color(kColor)))) <= 2, 'a layer that covers it');
      layers.undo();
      ok(difference(look(), reference) <= 1, 'the tint alone');
      equal([layers.undo(), layers.baseTint], ['changing the base tint', '#ffffff']);
      equal(difference(look(), bare), 0);
      layers.redo();
      layers.add(flat(0), { visible: false });
      for (const tint of ['#111111', '#222222', '#333333']) layers.setBaseTint(tint);
      layers.undo();
      equal(layers.baseTint, '#dd8844');
      layers.dispose();
    }
  },

  'a brush paints what its layer has; a stroke in progress shows it'() {
    const one = around();
    const model = modelOf(matt());
    const painter = createPainter({ renderer, applied: applyTransfer(model, { cage: one }), cage: one });
    const { layers } = painter;
    const look = () => {
      painter.update();
      return draw(model).pixels;
    };
    painter.addLayer();
    layers.set(layers.list[0]!, { metalness: 1, roughness: 0.3 });
    const bare = look();
    painter.stroke([{ x: 0.2, y: 0.4 }, { x: 0.2, y: 0.6 }], { color: '#bbbbbb', size: 0.3, hardness: 1 }); // biome-ignore format: points
    const metal = lookOf(new MeshStandardMaterial({ color: 0xbbbbbb, metalness: 1, roughness: 0.3 }));
    const now = look();
    const at = (pixels: readonly number[], x: number) => pixelAt(pixels, x, kSize / 2);
    ok(difference(at(now, 24), at(metal, 24)) <= 3, [at(now, 24), at(metal, 24)]);
    equal(at(now, 50), at(bare, 50));
    painter.undo();
    equal(difference(look(), bare), 0, 'the stroke that was undone');
    painter.dispose();
    layers.dispose();
  },

  'values that do not fit are refused with their name'() {
    const layers = createLayers({ renderer, size: 256 });
    const layer = layers.add(flat(kColor));
    for (const [style, message] of [
      [{ roughness: 1.5 }, /roughness is 1\.5, not a number from 0 to 1, or null$/],
      [{ metalness: '1' }, /metalness is "1", not a number from 0 to 1, or null$/],
      [{ emissive: -1 }, /emissive is -1, not a number from 0 to 10$/],
      [{ emissive: null }, /emissive is null, not a number from 0 to 10$/],
      [{ normal: {} }, /normal is .*, not a Texture of data, without a colour space, or null$/],
      [{ normal: flat(0) }, /normal is .*, not a Texture of data, without a colour space, or null$/],
      [{ normalScale: Number.NaN }, /normalScale is NaN, not a finite number$/],
      [{ blend: 'some' }, /blend is "some", not one of normal, multiply, screen, add, none$/],
    ] as [NewLayer, RegExp][]) {
      refuses(() => layers.set(layer, style), message);
      refuses(() => layers.add(flat(0), style), message);
    }
    refuses(() => layers.setBaseTint('red'), /baseTint is "red", not a colour such as #ff8800$/);
    equal([layers.list.length, layers.baseTint], [1, '#ffffff']);
    layers.dispose();
  },
};

/** Runs a test with layers that have all that there is. */
async function withAll(run: (layers: Layers, look: () => number[]) => Promise<void>): Promise<void> {
  const { layers, look } = painted();
  layers.setBaseTint('#ffaa88');
  layers.add(clear(kColor, 140), { normal: bumps(), normalScale: 0.8 });
  layers.add(flat(0xffffff), { blend: 'none', region: 'left', roughness: 0.2, metalness: 0.7 });
  layers.add(clear(0x22aa44, 90), { emissive: 1.5, normal: bumps(true) });
  await run(layers, look);
  layers.dispose();
}
