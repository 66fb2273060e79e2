// Paint with WebGPURenderer, on its WebGL back end, beside what WebGLRenderer draws. Runs in the browser.
import { MToonMaterial } from '@pixiv/three-vrm';
import { MToonNodeMaterial } from '@pixiv/three-vrm/nodes';
import {
  type Applied,
  type ApplyOptions,
  applyTransfer,
  createLayers,
  createPainter,
  type Layers,
} from 'cagecast/three';
import {
  AmbientLight,
  Box3,
  BufferAttribute,
  CanvasTexture,
  Color,
  type ColorSpace,
  DataTexture,
  DirectionalLight,
  Group,
  LinearSRGBColorSpace,
  type Material,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  MeshMatcapMaterial,
  MeshPhongMaterial,
  MeshPhysicalMaterial,
  MeshStandardMaterial,
  MeshToonMaterial,
  type Object3D,
  PerspectiveCamera,
  RenderTarget,
  Scene,
  SRGBColorSpace,
  type Texture,
  TextureLoader,
  Vector3,
  VideoTexture,
  WebGLRenderer,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { color as colorNode, texture as textureNode, uv } from 'three/tsl';
import { MeshStandardNodeMaterial, NodeMaterialInstance, WebGPURenderer } from 'three/webgpu';
import { ball, cage, clear, equal, flat, halves, modelOf, ok, refuses, type Scenes, skinned } from './scenes';

/** Pixels a side of the pictures. */
const kSide = 192; // WebGPU reads rows of a multiple of 64
/** By how much the pictures may differ in the mean over the painted area. */
const kMax = 3;

const webgl = new WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
/** Whether WebGPURenderer draws by WebGL. */
const forceWebGL = location.search !== '?webgpu';
const webgpu = new WebGPURenderer({ antialias: false, forceWebGL });
for (const one of [webgl, webgpu]) one.setSize(kSide, kSide);
await webgpu.init();

const camera = new PerspectiveCamera(40, 1, 0.01, 50);
camera.position.z = 3.2;

/** The differences that were found, for people. */
export const figures: string[] = [];
const context = new OffscreenCanvas(kSide, kSide).getContext('2d', { willReadFrequently: true })!;

/** What a renderer shows of a model. */
async function lookWith(renderer: WebGLRenderer | WebGPURenderer, model: Object3D): Promise<Uint8ClampedArray> {
  const scene = new Scene();
  scene.background = new Color(0x336699);
  const light = new DirectionalLight(0xffffff, 2.5);
  light.position.set(1, 2, 3);
  scene.add(new AmbientLight(0xffffff, 0.6), light, model);
  const draw = () => (renderer as WebGLRenderer).render(scene, camera);
  try {
    if (renderer === webgpu && !forceWebGL) return await read(draw);
    draw();
    context.clearRect(0, 0, kSide, kSide);
    context.drawImage(renderer.domElement, 0, 0);
    return context.getImageData(0, 0, kSide, kSide).data;
  } finally {
    scene.remove(model);
  }
}

/** What is drawn by WebGPU, whose canvas cannot be read where pages are composited by the processor. */
async function read(draw: () => void): Promise<Uint8ClampedArray> {
  const target = new RenderTarget(kSide, kSide, { colorSpace: webgpu.outputColorSpace as ColorSpace });
  webgpu.setRenderTarget(target);
  draw();
  webgpu.setRenderTarget(null);
  const bytes = await webgpu.readRenderTargetPixelsAsync(target, 0, 0, kSide, kSide);
  target.dispose();
  return new Uint8ClampedArray(bytes);
}

type Pixels = Uint8ClampedArray;
interface Looks {
  webgl: Pixels;
  webgpu: Pixels;
}
const looksOf = async (model: Object3D, other = model): Promise<Looks> => ({
  webgl: await lookWith(webgl, model),
  webgpu: await lookWith(webgpu, other),
});

const apart = (a: Pixels, b: Pixels, at: number): number =>
  Math.abs(a[at]! - b[at]!) + Math.abs(a[at + 1]! - b[at + 1]!) + Math.abs(a[at + 2]! - b[at + 2]!);
const pixels = Array.from({ length: kSide * kSide }, (_, i) => 4 * i);

/** The pixels that paint has changed. */
const paintedIn = (now: Pixels, bare: Pixels): number[] => pixels.filter((at) => apart(now, bare, at) > 6);

/** The mean difference of two pictures, of each channel, 0 to 255. */
const meanOf = (a: Pixels, b: Pixels, area: readonly number[]): number =>
  area.reduce((sum, at) => sum + apart(a, b, at) / 3, 0) / area.length;

/** Asserts that both renderers show the same paint. @param bare  What they show without. */
async function same(what: string, model: Object3D, bare: Looks, other = model): Promise<void> {
  const now = await looksOf(model, other);
  const keep = (globalThis as { keepPicture?: (name: string, url: string) => Promise<void> }).keepPicture;
  if (keep) await keep(what, pictureOf([bare.webgl, bare.webgpu, now.webgl, now.webgpu]));
  const area = paintedIn(now.webgl, bare.webgl);
  ok(area.length > 500, `${what}: ${area.length} pixels are painted`);
  const found = meanOf(now.webgl, now.webgpu, area);
  figures.push(`${what}: ${found.toFixed(2)} of 255`);
  ok(found <= kMax, `${what}: the pictures differ by ${found} of 255`);
  ok(paintedIn(now.webgpu, bare.webgpu).length > 0.95 * area.length, `${what}: less is painted`);
}

function pictureOf(list: readonly Pixels[]): string {
  const canvas = Object.assign(document.createElement('canvas'), { width: kSide * list.length, height: kSide });
  list.forEach((one, i) =>
    canvas.getContext('2d')!.putImageData(new ImageData(new Uint8ClampedArray(one), kSide), i * kSide, 0),
  );
  return canvas.toDataURL();
}

/** Asserts that both renderers show what they showed without paint. */
async function bareAgain(model: Object3D, bare: Looks): Promise<void> {
  const now = await looksOf(model);
  for (const name of ['webgl', 'webgpu'] as const) equal(meanOf(now[name], bare[name], pixels), 0, `${name}, disposed`);
}

/** Stripes with colours, soft alpha and a fine pattern. */
function stripes(): Texture {
  const canvas = Object.assign(document.createElement('canvas'), { width: 256, height: 256 });
  const drawing = canvas.getContext('2d')!;
  for (let i = 0; i < 16; ++i) {
    drawing.fillStyle = `hsla(${i * 47}, 80%, 50%, ${0.3 + 0.7 * ((i % 4) / 3)})`;
    drawing.fillRect(16 * i, 0, 12, 256);
    drawing.fillRect(0, 16 * i, 256, 3);
  }
  return Object.assign(new CanvasTexture(canvas), { flipY: false, colorSpace: SRGBColorSpace });
}

/** A normal map of waves. */
function waves(side = 128): DataTexture {
  const data = new Uint8Array(4 * side * side);
  for (let at = 0; at < side * side; ++at) {
    const [x, y] = [at % side, Math.floor(at / side)].map((one) => 0.4 * Math.sin((one / side) * 2 * Math.PI * 4));
    data.set(
      [x!, y!, Math.sqrt(1 - x! * x! - y! * y!), 1].map((value) => 127.5 + 127.5 * value),
      4 * at,
    );
  }
  return Object.assign(new DataTexture(data, side, side), { needsUpdate: true });
}

/** A film of one picture. */
async function video(): Promise<VideoTexture> {
  const canvas = Object.assign(document.createElement('canvas'), { width: 64, height: 64 });
  const drawing = canvas.getContext('2d')!;
  const element = Object.assign(document.createElement('video'), { muted: true, srcObject: canvas.captureStream(30) });
  const paint = setInterval(() => {
    for (const [i, color] of ['#cc2244', '#229944', '#336699', '#ddbb66'].entries()) {
      drawing.fillStyle = color;
      drawing.fillRect(16 * i, 0, 16, 64);
    }
  }, 20);
  await element.play();
  await new Promise((done) => element.requestVideoFrameCallback(done));
  clearInterval(paint);
  element.pause();
  return Object.assign(new VideoTexture(element), { flipY: false, colorSpace: SRGBColorSpace, needsUpdate: true });
}

type Kind = (color: Color) => Material;
const kinds: Record<string, Kind> = {
  basic: (color) => new MeshBasicMaterial({ color }),
  lambert: (color) => new MeshLambertMaterial({ color }),
  phong: (color) => new MeshPhongMaterial({ color, shininess: 60 }),
  standard: (color) => new MeshStandardMaterial({ color, roughness: 0.4 }),
  physical: (color) => new MeshPhysicalMaterial({ color, clearcoat: 1, roughness: 0.6 }),
  matcap: (color) => new MeshMatcapMaterial({ color, matcap: halves(0xffffff, 0x666666) }),
  toon: (color) => new MeshToonMaterial({ color }),
};

/** The lizard's head before the camera, its cage and its paint. */
async function lizard(): Promise<{ model: Group; around: Group; texture: Texture }> {
  const loader = new GLTFLoader();
  const [head, around] = await Promise.all(['target', 'cage'].map((name) => loader.loadAsync(`lizard/${name}.glb`)));
  const texture = await new TextureLoader().loadAsync('lizard/paint-tiger.png');
  Object.assign(texture, { flipY: false, colorSpace: SRGBColorSpace });
  return { model: head!.scene, around: around!.scene, texture };
}

/** Puts a model before the camera, with its cage, which is not drawn. */
function inView(model: Object3D, around: Object3D): Group {
  const box = new Box3().setFromObject(model);
  const { x, y, z } = box.getCenter(new Vector3());
  const scale = 3 / box.getSize(new Vector3()).length();
  const group = new Group().add(model, around);
  around.visible = false;
  group.scale.setScalar(scale);
  group.position.set(-scale * x, -scale * y, -scale * z);
  return group;
}

const painted = (model: Object3D, options: ApplyOptions): Applied => applyTransfer(model, { cage: cage(), ...options });

export const webgpuScenes: Scenes = {
  async 'without the entry, node materials are refused and the console says once what is missing'() {
    const heard: string[] = [];
    const { warn } = console;
    console.warn = (text: string) => void heard.push(text);
    for (const model of [modelOf(new MeshStandardMaterial()), modelOf(new MeshBasicMaterial())]) {
      const bare = await looksOf(model);
      const applied = painted(model, { texture: flat(0xdd3311) });
      const { webgl: one, webgpu: other } = await looksOf(model);
      ok(paintedIn(one, bare.webgl).length > 500, 'the other renderer shows no paint');
      equal(meanOf(other, bare.webgpu, pixels), 0, 'the paint');
      applied.dispose();
    }
    console.warn = warn;
    equal(heard, ['cagecast/three: WebGPURenderer shows paint once the page imports cagecast/three/webgpu']);
    refuses(
      () => painted(modelOf(new MeshStandardNodeMaterial()), { texture: flat(0xdd3311) }),
      /has a node material, which shows options\.texture once the page imports cagecast\/three\/webgpu; else give options\.material$/,
    );
    const { enableLayers } = await import('cagecast/three/webgpu');
    refuses(
      () => createLayers({ renderer: webgpu }),
      /is a WebGPURenderer: call enableLayers\(\) of cagecast\/three\/webgpu once$/,
    );
    enableLayers();
  },

  async 'a head from a file: its paint, soft borders, cut borders, and nothing after dispose'() {
    const { model, around, texture } = await lizard();
    const view = inView(model, around);
    const bare = await looksOf(view);
    const before = meanOf(bare.webgl, bare.webgpu, pixels);
    ok(before < 1, `the bare models differ by ${before}`);
    for (const [what, options] of Object.entries({
      lizard: {},
      'lizard, soft': { feather: 0.05, opacity: 0.7 },
      'lizard, cut': { borders: 'cut' },
    } satisfies Record<string, ApplyOptions>)) {
      const applied = applyTransfer(model, { cage: around, texture, ...options });
      await same(what, view, bare);
      applied.dispose();
    }
    await bareAgain(view, bare);
  },

  async 'paint on each kind of material, with maps and colours of vertices, opaque or not'() {
    for (const [kind, make] of Object.entries(kinds))
      for (const opacity of [1, 0.5]) {
        // WebGPURenderer blends in linear light, the other one as the picture is encoded: here it is in linear light, too.
        for (const one of [webgl, webgpu]) one.outputColorSpace = opacity < 1 ? LinearSRGBColorSpace : SRGBColorSpace;
        const material = make(new Color(0xbbccdd));
        Object.assign(material, {
          opacity,
          transparent: opacity < 1,
          map: halves(0xffffff, 0xbbaa99),
          vertexColors: true,
        });
        const geometry = ball();
        const { count } = geometry.getAttribute('position');
        const colors = Float32Array.from({ length: 3 * count }, (_, i) => 0.5 + 0.5 * ((i % 7) / 6));
        geometry.setAttribute('color', new BufferAttribute(colors, 3));
        const model = modelOf(material, geometry);
        const bare = await looksOf(model);
        const applied = painted(model, { texture: stripes() });
        await same(`${kind}, opacity ${opacity}`, model, bare);
        applied.dispose();
        await bareAgain(model, bare);
      }
    for (const one of [webgl, webgpu]) one.outputColorSpace = SRGBColorSpace;
  },

  async 'changes show in the next frame'() {
    const model = modelOf(new MeshStandardMaterial({ color: 0xbbbbbb }));
    const bare = await looksOf(model);
    const texture = stripes();
    const applied = painted(model, { texture });
    await same('a texture', model, bare);
    texture.offset.set(0.13, 0.2);
    texture.repeat.set(2, 1.5);
    texture.rotation = 0.4;
    await same('a transform of its UVs', model, bare);
    applied.setOpacity(0.4);
    await same('opacity', model, bare);
    applied.setTexture(clear(0xdd3311, 140));
    await same('another texture', model, bare);
    applied.setTexture(null);
    await bareAgain(model, bare);
    applied.setTexture(halves(0xdd3311, 0x1133dd));
    const { zones, cosmeticTriangles, segmentStats } = applied.result;
    applied.setClassification({
      zones,
      segmentStats,
      cosmeticTriangles: cosmeticTriangles.map((one, t) => (t % 9 < 4 ? one : 0)),
    });
    await same('another classification', model, bare);
    const film = await video();
    applied.setTexture(film);
    await same('a video', model, bare);
    applied.setTexture(texture);
    await same('no video', model, bare);
    film.dispose();
    const later = painted(model, { texture });
    await same('a later transfer', model, bare);
    later.dispose();
    applied.dispose();
    await bareAgain(model, bare);
  },

  async 'a material shows paint only on meshes that have it, and another on others'() {
    const material = new MeshStandardMaterial();
    const models = [-0.9, 0, 0.9].map((x) => {
      const mesh = new Mesh(ball(0.4), material);
      mesh.position.x = x;
      return mesh;
    });
    const all = new Group().add(...models);
    const bare = await looksOf(all);
    for (const [m, color] of [0xdd3311, 0x11dd33].entries()) {
      const around = new Mesh(ball(0.45));
      around.position.copy(models[m]!.position);
      applyTransfer(models[m]!, { cage: around, texture: flat(color) });
    }
    await same('three meshes', all, bare);
    const { webgpu: now } = await looksOf(all);
    const third = pixels.filter((at) => (at / 4) % kSide > 0.7 * kSide);
    equal(meanOf(now, bare.webgpu, third), 0, 'the third');
  },

  async 'what moves keeps its paint'() {
    // One for each renderer: WebGPU changes the type of bone indices.
    const both = [skinned(2), skinned(2)];
    const [{ model }, { model: other }] = both as [(typeof both)[0], (typeof both)[0]];
    const bare = await looksOf(model, other);
    for (const one of both) painted(one.model, { texture: stripes() });
    await same('skinned', model, bare, other);
    for (const { model, mesh, bone } of both) {
      mesh.morphTargetInfluences![0] = 0.3;
      bone.rotation.set(0.2, 0.5, 0);
      model.updateMatrixWorld(true);
    }
    // WebGPURenderer moves bones once in each frame of the page.
    for (let i = 0; i < 2; ++i) await new Promise(requestAnimationFrame);
    await same('posed', model, bare, other);
  },

  async 'node materials are painted over their own colour; those without one get an overlay'() {
    const classic = modelOf(new MeshStandardMaterial({ map: halves(0xffffff, 0x8899aa) }));
    const made = new MeshStandardNodeMaterial();
    made.colorNode = textureNode(halves(0xffffff, 0x8899aa), uv());
    const node = modelOf(made);
    const bare = await looksOf(classic, node);
    for (const model of [classic, node]) painted(model, { texture: stripes(), opacity: 0.8 });
    await same('a node material', classic, bare, node);

    const flatColor = new MeshStandardNodeMaterial();
    flatColor.fragmentNode = colorNode(0x888888);
    for (const material of [flatColor, new NodeMaterialInstance(new MeshStandardNodeMaterial())]) {
      const model = modelOf(material);
      const plain = await lookWith(webgpu, model);
      const applied = painted(model, { texture: flat(0xdd3311) });
      ok(paintedIn(await lookWith(webgpu, model), plain).length > 500, material.type);
      equal(applied.overlays.length, 1);
      applied.dispose();
      equal(meanOf(await lookWith(webgpu, model), plain, pixels), 0, material.type);
    }
  },

  async 'MToon of three-vrm for nodes is painted as the other one is'() {
    const look = { lit: new Color(0xeeddcc), shade: new Color(0x664455) };
    const classic = new MToonMaterial({ shadeColorFactor: look.shade });
    classic.uniforms['litFactor']!.value.copy(look.lit);
    const node = new MToonNodeMaterial();
    node.color.copy(look.lit);
    node.shadeColorFactor.copy(look.shade);
    const models = [classic, node].map((material) => modelOf(material as Material));
    const looks = () => looksOf(models[0]!, models[1]!);
    const bare = await looks();
    const applied = models.map((model) => painted(model, { texture: halves(0xdd3311, 0x33bb44) }));
    const check = async (what: string): Promise<void> => {
      const now = await looks();
      const area = paintedIn(now.webgl, bare.webgl);
      const [before, found] = [meanOf(bare.webgl, bare.webgpu, area), meanOf(now.webgl, now.webgpu, area)];
      figures.push(`${what}: ${found.toFixed(2)} of 255, bare ${before.toFixed(2)}`);
      ok(area.length > 500 && found <= before + kMax, [what, area.length, before, found]);
    };
    await check('MToon');
    const stacks = [webgl, webgpu].map((renderer) => createLayers({ renderer }));
    const changes: Record<string, (layers: Layers) => unknown> = {
      tinted: (layers) => layers.setBaseTint('#88ff66'),
      glow: (layers) => layers.add(clear(0x3355aa, 128), { emissive: 0.7 }),
      relief: (layers) => layers.add(flat(0), { blend: 'none', normal: waves() }),
    };
    for (const [what, change] of Object.entries(changes)) {
      stacks.forEach((layers, m) => {
        change(layers);
        layers.update();
        applied[m]!.setTexture(layers.texture);
      });
      await check(`MToon, ${what}`);
    }
    for (const one of applied) one.dispose();
    for (const layers of stacks) layers.dispose();
    equal(meanOf((await looks()).webgpu, bare.webgpu, pixels), 0, 'it, disposed');
  },

  async 'layers, strokes and stickers are drawn as by a WebGLRenderer'() {
    const models = [0, 1].map(() => modelOf(new MeshStandardMaterial({ color: 0xbbbbbb })));
    const bare = await looksOf(models[0]!, models[1]!);
    const around = cage();
    around.geometry.userData = { regions: { left: [[[0, 0], [0.5, 0], [0.5, 1], [0, 1]]] } }; // biome-ignore format: corners
    const painters = [webgl, webgpu].map((renderer, m) =>
      createPainter({ renderer, applied: applyTransfer(models[m]!, { cage: around }), cage: around }),
    );
    const [ground, tint] = [halves(0xdd3311, 0x1133dd), stripes()];
    const check = async (what: string): Promise<void> => {
      for (const painter of painters) painter.update();
      await same(what, models[0]!, bare, models[1]!);
    };
    for (const painter of painters) painter.stroke([{ x: 0.2, y: 0.45 }, { x: 0.3, y: 0.6 }], { color: '#cc2244', size: 0.1 }); // biome-ignore format: points
    await check('a stroke');
    for (const painter of painters) painter.sticker({ text: '07', color: '#ffffff', outline: '#000000' }, { at: { x: 0.22, y: 0.5 }, size: 0.4 }); // biome-ignore format: one call
    await check('a sticker');
    for (const painter of painters) painter.erase([{ x: 0.24, y: 0.5 }], { size: 0.05 });
    await check('erased');
    for (const { layers } of painters) {
      layers.add(ground, { opacity: 0.7, place: 0 });
      layers.add(tint, { blend: 'multiply', tint: '#ffcc99', region: 'left' });
    }
    await check('layers');
    for (const painter of painters) painter.undo();
    await check('undone');
    equal([...painters[1]!.layers.toImageData(16).data], [...painters[0]!.layers.toImageData(16).data]);
    const saved = await painters[1]!.layers.save();
    await painters[1]!.layers.load(JSON.parse(JSON.stringify(saved)));
    await check('saved and loaded');
    refuses(
      () => painters[1]!.layers.add(painters[0]!.layers.texture),
      /texture is drawn by another renderer than the layers, which cannot read it$/,
    );
    for (const painter of painters) {
      painter.dispose();
      painter.layers.dispose();
    }
  },

  async 'roughness, metalness, glow, relief and the base tint are seen as by a WebGLRenderer'() {
    const around = cage();
    around.geometry.userData = { regions: { left: [[[0, 0], [0.5, 0], [0.5, 1], [0, 1]]] } }; // biome-ignore format: corners
    for (const [kind, make] of Object.entries(kinds)) {
      const models = [0, 1].map(() => modelOf(make(new Color(0xbbaa99))));
      const bare = await looksOf(models[0]!, models[1]!);
      const stacks = [webgl, webgpu].map((renderer, m) => {
        const layers = createLayers({ renderer, cage: around });
        applyTransfer(models[m]!, { cage: around, texture: layers.texture, feather: 0.02 });
        layers.add(clear(0xcc8844, 200), { name: 'ground' });
        return layers;
      });
      const check = async (what: string, change: (layers: Layers) => void): Promise<void> => {
        for (const layers of stacks) {
          change(layers);
          layers.update();
        }
        await same(`${kind}, ${what}`, models[0]!, bare, models[1]!);
      };
      await check('a layer', () => {});
      const program = meanOf((await looksOf(models[0]!, models[1]!)).webgpu, bare.webgpu, pixels);
      await check('tinted', (layers) => layers.setBaseTint('#88ff66'));
      await check('glossy metal', (layers) => layers.set(layers.list[0]!, { roughness: 0.2, metalness: 0.9 }));
      // The renderers themselves differ in what a clear coat leaves of light from below.
      const emissive = kind === 'physical' ? 0 : 0.7;
      await check('glow', (layers) => layers.add(flat(0x3355aa), { blend: 'none', emissive, region: 'left' }));
      await check('relief', (layers) => layers.add(flat(0), { blend: 'none', normal: waves(), normalScale: 0.8 }));
      await check('without', (layers) => {
        for (const { id } of layers.list.slice(1)) layers.remove({ id });
        layers.set(layers.list[0]!, { roughness: null, metalness: null });
        layers.setBaseTint('#ffffff');
      });
      equal(
        meanOf((await looksOf(models[0]!, models[1]!)).webgpu, bare.webgpu, pixels),
        program,
        `${kind}, afterwards`,
      );
      for (const layers of stacks) layers.dispose();
    }
  },

  'pointers paint on the canvas of a WebGPURenderer'() {
    const model = modelOf(new MeshStandardMaterial());
    const painter = createPainter({ renderer: webgpu, applied: painted(model, {}), cage: cage() });
    document.body.append(webgpu.domElement);
    equal(painter.pickAt({ clientX: 0, clientY: 0 }, camera), undefined);
    const { left, top, width, height } = webgpu.domElement.getBoundingClientRect();
    model.updateMatrixWorld(true);
    ok(painter.pickAt({ clientX: left + width / 2, clientY: top + height / 2 }, camera)?.uv, 'no spot in the middle');
    webgpu.domElement.remove();
    painter.dispose();
    painter.layers.dispose();
  },

  'what draws layers is freed with the last of them'() {
    const lost: boolean[] = [];
    const all = [0, 1].map(() => createLayers({ renderer: webgpu, size: 256 }));
    const gl = all[0]!.renderer.getContext();
    ok(all[0]!.renderer === all[1]!.renderer && all[0]!.renderer !== (webgpu as unknown), 'each has one of its own');
    for (const layers of all) {
      layers.dispose();
      layers.dispose();
      lost.push(gl.isContextLost());
    }
    equal(lost, [false, true]);
    refuses(() => createLayers({ renderer: {} as never }), /is neither a WebGLRenderer nor a WebGPURenderer$/);
    const { error } = console;
    const { getContext } = HTMLCanvasElement.prototype;
    console.error = () => {}; // three.js says so, too
    HTMLCanvasElement.prototype.getContext = () => null;
    refuses(() => createLayers({ renderer: webgpu }), /layers need WebGL 2, also beside a WebGPURenderer$/);
    HTMLCanvasElement.prototype.getContext = getContext;
    console.error = error;
  },
};
