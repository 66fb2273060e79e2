// What three.js shows of layers, and of a file with them in its own textures. Runs in the browser.
import { paintGlb } from 'cagecast/gltf';
import { applyTransfer, createLayers, type Layers } from 'cagecast/three';
import {
  CanvasTexture,
  DataTexture,
  type Group,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  SphereGeometry,
  SRGBColorSpace,
  type Texture,
} from 'three';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { clear, draw, flat, halves, ok, renderer, type Scenes } from './scenes';

/** How far colours may differ in the mean, of 255: the model's textures have other texels than the layers. */
const kMost = 1;
/** Texels a side. */
const kSide = 256;

/** A texture of a function of u and v, which gives 4 bytes. */
function textureOf(texel: (u: number, v: number) => readonly number[], isData = false): DataTexture {
  const data = new Uint8Array(4 * kSide * kSide);
  for (let i = 0; i < kSide * kSide; ++i)
    data.set(texel(((i % kSide) + 0.5) / kSide, (Math.floor(i / kSide) + 0.5) / kSide), 4 * i);
  const texture = new DataTexture(data, kSide, kSide);
  if (!isData) texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
}

/** A soft disc of a colour about the middle of what is seen of a ball. */
const disc = (color: readonly number[]): Texture =>
  textureOf((u, v) => [...color, 255 * Math.min(1, Math.max(0, 8 * (0.12 - Math.hypot(u - 0.27, v - 0.5))))]);
/** The same as a picture, which exporters can draw. */
function pictureOf(texel: (u: number, v: number) => readonly number[], isData = false): Texture {
  const canvas = Object.assign(document.createElement('canvas'), { width: kSide, height: kSide });
  const { data } = textureOf(texel, isData).image;
  canvas.getContext('2d')!.putImageData(new ImageData(new Uint8ClampedArray(data as Uint8Array), kSide), 0, 0);
  const texture = new CanvasTexture(canvas);
  texture.flipY = false;
  if (!isData) texture.colorSpace = SRGBColorSpace;
  return texture;
}
const skin = () => pictureOf((u, v) => [200, 150 + 30 * Math.sin(40 * u), 120 + 30 * Math.cos(30 * v), 255]);
const bumps = (across = 8) =>
  pictureOf((u) => {
    const x = 0.5 * Math.sin(across * 6.28 * u);
    return [127.5 * (1 + x), 128, 127.5 * (1 + Math.sqrt(1 - x * x)), 255];
  }, true);

async function exported(material: MeshStandardMaterial | MeshBasicMaterial): Promise<Uint8Array> {
  const mesh = new Mesh(new SphereGeometry(1, 48, 32), material);
  return new Uint8Array((await new GLTFExporter().parseAsync(mesh, { binary: true })) as ArrayBuffer);
}

/** A model, whose textures are filtered as those of layers are. */
async function loaded(bytes: Uint8Array): Promise<Group> {
  const { scene, parser } = await new GLTFLoader().parseAsync(bytes.slice().buffer, '');
  for (const { map, normalMap, roughnessMap, emissiveMap } of (await parser.getDependencies(
    'material',
  )) as MeshStandardMaterial[])
    for (const texture of [map, normalMap, roughnessMap, emissiveMap]) if (texture) texture.anisotropy = 8;
  return scene;
}

/** The mean difference of two pictures, in levels of 255, where one of them shows the model. */
function meanDifference(a: readonly number[], b: readonly number[]): number {
  const [r, g, bl] = a;
  let [sum, count] = [0, 0];
  for (let at = 0; at < a.length; at += 4) {
    if (a[at] === r && a[at + 1] === g && a[at + 2] === bl) continue;
    for (let k = 0; k < 3; ++k) sum += Math.abs(a[at + k]! - b[at + k]!);
    count += 3;
  }
  return sum / count;
}

/** Compares what layers show on a model with what the file shows that has them in its textures. */
async function compare(
  material: MeshStandardMaterial | MeshBasicMaterial,
  add: (layers: Layers) => void,
): Promise<void> {
  const file = await exported(material);
  const around = new SphereGeometry(1.1, 24, 16);
  const regions = { left: [[[0, 0], [0.27, 0], [0.27, 1], [0, 1]]] } as const; // biome-ignore format: corners
  around.userData = { regions };
  const cage = new Mesh(around);
  const layers = createLayers({ renderer, cage });
  add(layers);
  const live = await loaded(file);
  applyTransfer(live, { cage }).setTexture(layers.texture);
  const bare = draw(await loaded(file)).pixels;
  layers.update();
  const shown = draw(live).pixels;
  const { attributes, index } = around;
  const { bytes, left } = await paintGlb(file, {
    size: 1024,
    look: JSON.parse(JSON.stringify(await layers.save())),
    cage: {
      positions: attributes['position']!.array as Float32Array,
      indices: index!.array as Uint16Array,
      uvs: attributes['uv']!.array as Float32Array,
      regions,
    } as never,
  });
  layers.dispose();
  ok(left.length === (material.map ? 0 : 1), left);
  const written = draw(await loaded(bytes)).pixels;
  const [change, apart] = [meanDifference(bare, shown), meanDifference(written, shown)];
  ok(change > 2 * kMost, `only ${change} levels are changed`);
  ok(apart <= kMost, `${apart} levels apart, of ${change} that are changed`);
}

const standard = (more: ConstructorParameters<typeof MeshStandardMaterial>[0] = {}) =>
  new MeshStandardMaterial({ map: skin(), roughness: 0.9, ...more });

export const lookScenes: Scenes = {
  'a file shows the colours of layers, their opacity, tints, blend modes and regions': () =>
    compare(standard(), (layers) => {
      layers.add(disc([255, 60, 60]), { opacity: 0.7, tint: '#80ff80' });
      layers.add(halves(0x4060ff, 0xffffff), { blend: 'multiply', region: 'left' });
      layers.add(clear(0x302000, 120), { blend: 'add' });
      layers.add(clear(0x004040, 200), { blend: 'screen' });
      layers.add(flat(0x000000), { visible: false });
    }),
  'a file shows the base tint, also of a colour that its material multiplies': () =>
    compare(standard({ color: 0xffcc99 }), (layers) => {
      layers.setBaseTint('#6a90c8');
      layers.add(disc([20, 200, 60]));
    }),
  'a file shows gloss and metal, of colours and without': () =>
    compare(standard(), (layers) => {
      layers.add(disc([250, 20, 60]), { roughness: 0.25 });
      layers.add(halves(0xffffff, 0xffffff), { blend: 'none', region: 'left', metalness: 1, roughness: 0.5 });
    }),
  'a file shows gloss on a material that has a texture of it'() {
    const ramp = pictureOf((u) => [0, 255 * u, 255, 255], true);
    return compare(
      standard({ roughnessMap: ramp, metalnessMap: ramp, metalness: 1, roughness: 1 }),
      (layers) => void layers.add(flat(0xffffff), { blend: 'none', region: 'left', roughness: 0.5, metalness: 0.4 }),
    );
  },
  'a file shows what glows, stronger than white, and what covers it': () =>
    compare(standard({ emissive: 0x101830 }), (layers) => {
      layers.add(clear(0x2050ff, 180), { emissive: 0.6, region: 'left' });
      layers.add(disc([255, 120, 10]), { emissive: 3 });
      layers.add(clear(0x101010, 128), { region: 'left' });
    }),
  'a file shows relief, also on that of its own': () =>
    compare(standard({ normalMap: bumps(3) }), (layers) => {
      layers.add(flat(0xffffff), { blend: 'none', normal: bumps(), normalScale: 0.8 });
    }),
  'a file shows layers that were moved, turned and scaled, with their relief': () =>
    compare(standard(), (layers) => {
      const place = { offset: [0.04, -0.1], rotation: 0.6, center: [0.27, 0.5] } as const;
      layers.add(halves(0xff4040, 0x40ff40), { ...place, scale: 0.3, normal: bumps(), normalScale: 0.7 });
      layers.add(disc([40, 40, 255]), { offset: [-0.05, 0.1], scale: 1.5, center: [0.27, 0.5], roughness: 0.2 });
    }),
  'a file shows all of it on a material without a texture, by a copy of its surface': () =>
    compare(new MeshStandardMaterial({ color: 0xc0a090, roughness: 0.9, metalness: 0.1 }), (layers) => {
      layers.setBaseTint('#8090ff');
      layers.add(disc([255, 60, 60]), { roughness: 0.2, emissive: 0.5, offset: [0.02, 0.05] });
      layers.add(halves(0xffffff, 0xffffff), { blend: 'none', region: 'left', metalness: 1, normal: bumps() });
    }),
  'a file without light shows the colours': () =>
    compare(new MeshBasicMaterial({ map: skin() }), (layers) => {
      layers.setBaseTint('#b0c0ff');
      layers.add(disc([255, 60, 60]), { roughness: 0.2, emissive: 2 });
    }),
};
