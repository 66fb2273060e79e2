import assert from 'node:assert/strict';
import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { NodeIO } from '@gltf-transform/core';
import type { Browser } from 'playwright-core';
import { PNG } from 'pngjs';
import { build } from 'vite';
import { launchChromium } from '../../support/chromium.js';
import { serve } from '../../support/serve.js';
import { hostTools, installPacked, linkPackages } from './install.js';

/** A square picture has so many pixels on a side. */
const kSide = 384;
/** How far colours may differ in the mean, of 255. */
const kMax = 3;

const common = `
import { init } from 'cagecast';
const query = new URLSearchParams(location.search);
const borders = query.get('borders') ?? 'triangle';
const model = query.has('posed') ? 'posed.glb' : 'target.glb';
const canvas = Object.assign(document.body.appendChild(document.createElement('canvas')), { width: ${kSide}, height: ${kSide} });
const { center, distance } = { center: [0, 0.02, 0], distance: 1.4 };
await init();
`;

/** Pages that show the same without light, and without smooth edges: the model's colours, and the paint mixed into them. */
const kPages: Record<string, string> = {
  three: `${common}
import { applyTransfer } from 'cagecast/three';
import { MeshBasicMaterial, PerspectiveCamera, Scene, SRGBColorSpace, TextureLoader, WebGLRenderer } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
const load = (file) => new GLTFLoader().loadAsync(file);
const [head, cage, texture] = await Promise.all([load(model), load('cage.glb'), new TextureLoader().loadAsync('paint-tiger.png')]);
texture.flipY = false;
texture.colorSpace = SRGBColorSpace;
head.scene.traverse((mesh) => {
  if (mesh.isMesh) mesh.material = new MeshBasicMaterial({ map: mesh.material.map, side: mesh.material.side });
});
const { setTexture } = applyTransfer(head, { cage, texture, borders });
if (query.has('bare')) setTexture(null);
head.scene.traverse(({ morphTargetInfluences: shapes }) => shapes?.fill(1));
const camera = new PerspectiveCamera(35, 1, 0.01, 100);
camera.position.set(center[0], center[1], center[2] + distance);
const renderer = new WebGLRenderer({ canvas, preserveDrawingBuffer: true });
renderer.setClearColor('#dddddd');
renderer.render(new Scene().add(head.scene), camera);
document.title = 'done';
`,
  babylon: `${common}
import { Color4, Engine, FreeCamera, LoadAssetContainerAsync, Scene, Texture, Vector3 } from '@babylonjs/core';
import '@babylonjs/loaders/glTF/index.js';
import { paintMeshes } from '../babylon/paint.js';
const engine = new Engine(canvas, false, { preserveDrawingBuffer: true, useExactSrgbConversions: true });
const scene = new Scene(engine);
scene.useRightHandedSystem = query.has('right');
scene.clearColor = new Color4(0.867, 0.867, 0.867, 1);
const [head, cage] = await Promise.all([model, 'cage.glb'].map((file) => LoadAssetContainerAsync(file, scene)));
const paint = new Texture('paint-tiger.png', scene, { invertY: false, useSRGBBuffer: true });
paint.anisotropicFilteringLevel = 1;
for (const material of head.materials) {
  material.unlit = true;
  material.albedoTexture.anisotropicFilteringLevel = 1;
}
paintMeshes(head.meshes, cage.meshes, paint, { borders });
for (const { morphTargetManager: shapes } of head.meshes) if (shapes) shapes.getTarget(0).influence = 1;
head.addAllToScene();
// The loader mirrors models in a left-handed scene.
const x = scene.useRightHandedSystem ? center[0] : -center[0];
const camera = new FreeCamera('camera', new Vector3(x, center[1], center[2] + distance), scene);
camera.setTarget(new Vector3(x, center[1], center[2]));
camera.fov = (35 * Math.PI) / 180;
camera.minZ = 0.01;
camera.maxZ = 100;
await scene.whenReadyAsync();
scene.render();
document.title = 'done';
`,
  playcanvas: `${common}
import { Application, Asset, Color, Entity, FILLMODE_NONE, RESOLUTION_FIXED, SHADERLANGUAGE_GLSL, ShaderChunks, TONEMAP_LINEAR } from 'playcanvas';
import { paintEntity } from '../playcanvas/paint.js';
const app = new Application(canvas, { graphicsDeviceOptions: { antialias: false, preserveDrawingBuffer: true } });
app.setCanvasFillMode(FILLMODE_NONE, ${kSide}, ${kSide});
app.setCanvasResolution(RESOLUTION_FIXED, ${kSide}, ${kSide});
app.autoRender = false;
// PlayCanvas raises colours to 1 / 2.2, which is sRGB about: exactly here, as the others do.
const chunks = ShaderChunks.get(app.graphicsDevice, SHADERLANGUAGE_GLSL);
const srgb = 'mix(1.055 * pow(color, vec3(1.0 / 2.4)) - 0.055, 12.92 * color, vec3(lessThanEqual(color, vec3(0.0031308))))';
chunks.set('gammaPS', chunks.get('gammaPS').replace('pow(color + 0.0000001, vec3(1.0 / 2.2))', srgb));
app.start();
const load = (type, url, data) =>
  new Promise((resolve, reject) => {
    const asset = new Asset(url, type, { url }, data);
    asset.once('load', () => resolve(asset.resource));
    asset.once('error', reject);
    app.assets.add(asset);
    app.assets.load(asset);
  });
const [container, outer, paint] = await Promise.all([
  load('container', model),
  load('container', 'cage.glb'),
  load('texture', 'paint-tiger.png', { srgb: true }),
]);
const head = container.instantiateRenderEntity();
for (const { meshInstances } of head.findComponents('render'))
  for (const { material } of meshInstances) {
    Object.assign(material, { useSkybox: false, useMetalness: false, specular: new Color(0, 0, 0) });
    material.update();
  }
paintEntity(app.graphicsDevice, head, outer.instantiateRenderEntity(), paint, { borders });
app.root.addChild(head);
for (const { meshInstances } of head.findComponents('render'))
  for (const { morphInstance } of meshInstances) morphInstance?.setWeight(0, 1);
// Light that is the same from everywhere: what is seen is the colour of the surface.
app.scene.ambientLight = new Color(1, 1, 1);
const camera = new Entity('camera');
camera.addComponent('camera', { fov: 35, nearClip: 0.01, farClip: 100, clearColor: new Color(0.867, 0.867, 0.867), toneMapping: TONEMAP_LINEAR });
camera.setPosition(center[0], center[1], center[2] + distance);
app.root.addChild(camera);
app.renderNextFrame = true;
app.once('frameend', () => {
  document.title = 'done';
});
`,
};
const kExamples = ['babylon', 'playcanvas'];
const kEngines = ['@babylonjs/core', '@babylonjs/loaders', 'playcanvas'];

/** The model with bones, one of which is turned, and with a morph target. */
async function posed(): Promise<Uint8Array> {
  const io = new NodeIO();
  const document = await io.read('examples/samples/lizard/target.glb');
  const [root, buffer] = [document.getRoot(), document.getRoot().listBuffers()[0]!];
  const accessor = (type: 'VEC3' | 'VEC4' | 'MAT4', array: Float32Array<ArrayBuffer> | Uint8Array<ArrayBuffer>) =>
    document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const skin = document.createSkin();
  const still = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  skin.setInverseBindMatrices(accessor('MAT4', Float32Array.from([...still, ...still])));
  const turned = document.createNode('turned').setRotation([0, 0, Math.sin(0.2), Math.cos(0.2)]);
  for (const joint of [document.createNode('still'), turned]) {
    skin.addJoint(joint);
    root.listScenes()[0]!.addChild(joint);
  }
  for (const node of root.listNodes().filter((one) => one.getMesh())) {
    node.setSkin(skin);
    node.getMesh()!.setWeights([0]);
    for (const primitive of node.getMesh()!.listPrimitives()) {
      const positions = primitive.getAttribute('POSITION')!;
      const count = positions.getCount();
      const [joints, weights, deltas] = [
        new Uint8Array(4 * count),
        new Float32Array(4 * count),
        new Float32Array(3 * count),
      ];
      for (let v = 0; v < count; ++v) {
        const [x = 0, y = 0] = positions.getElement(v, [] as number[]);
        const pull = Math.min(Math.max(0.5 + 2 * y, 0), 1);
        joints.set([0, 1], 4 * v);
        weights.set([1 - pull, pull], 4 * v);
        deltas[3 * v] = 0.3 * x;
      }
      primitive.setAttribute('JOINTS_0', accessor('VEC4', joints)).setAttribute('WEIGHTS_0', accessor('VEC4', weights));
      primitive.addTarget(document.createPrimitiveTarget('wide').setAttribute('POSITION', accessor('VEC3', deltas)));
    }
  }
  return io.writeBinary(document);
}

const user = installPacked();
let browser: Browser;
let site: Awaited<ReturnType<typeof serve>>;

before(async () => {
  const sources = join(user, 'examples');
  for (const name of kExamples)
    cpSync(`examples/${name}`, join(sources, name), {
      recursive: true,
      filter: (path) => !path.includes('node_modules'),
    });
  mkdirSync(join(sources, 'compared'));
  for (const [name, script] of Object.entries(kPages)) {
    writeFileSync(join(sources, 'compared', `${name}.js`), script);
    const page = `<!doctype html><style>body { margin: 0 } canvas { display: block }</style><script type="module" src="${name}.js"></script>`;
    writeFileSync(join(sources, 'compared', `${name}.html`), page);
  }
  linkPackages(user, ['three']);
  linkPackages(user, kEngines, hostTools);
  const input = [
    ...kExamples.map((name) => join(sources, name, 'index.html')),
    ...Object.keys(kPages).map((name) => join(sources, 'compared', `${name}.html`)),
  ];
  const out = join(user, 'out');
  await build({
    root: sources,
    configFile: false,
    base: './',
    logLevel: 'error',
    publicDir: false,
    build: { target: 'es2022', minify: false, outDir: out, chunkSizeWarningLimit: 1e5, rolldownOptions: { input } },
  });
  for (const folder of [...kExamples, 'compared'])
    for (const file of readdirSync('examples/samples/lizard'))
      symlinkSync(resolve('examples/samples/lizard', file), join(out, folder, file));
  writeFileSync(join(out, 'compared/posed.glb'), await posed());
  site = await serve(out);
  browser = await launchChromium({ drawing: true });
});
after(async () => {
  await browser?.close();
  site?.close();
  rmSync(user, { recursive: true, force: true });
});

/**
 * Opens a page, and waits for its title, and until its picture is as it should be.
 * @returns what it shows.
 */
async function shown(path: string, title = /^done$/, isRight: (picture: PNG) => boolean = () => true): Promise<PNG> {
  const page = await browser.newPage({ viewport: { width: kSide, height: kSide } });
  const faults: string[] = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error' && !/favicon|404/.test(message.text())) faults.push(message.text());
  });
  // The server of tests knows scripts and pages only.
  await page.route('**/*.css', async (route) =>
    route.fulfill({ response: await route.fetch(), contentType: 'text/css' }),
  );
  await page.goto(`${site.origin}/${path}`);
  const end = Date.now() + 60000;
  while (!title.test(await page.title()) && faults.length === 0 && Date.now() < end) await setTimeout(50);
  assert.deepEqual(faults, [], path);
  assert.match(await page.title(), title, path);
  let picture = await page.screenshot();
  while (!isRight(PNG.sync.read(picture)) && Date.now() < end) picture = await page.screenshot();
  assert.deepEqual(faults, [], path);
  await page.close();
  const { CAGECAST_PICTURES: folder } = process.env;
  if (folder) writeFileSync(join(folder, `${path.replace(/\W+/g, '-')}.png`), picture);
  return PNG.sync.read(picture);
}

/** How many pixels have a colour as orange as the paint, which nothing else has. */
function orange({ data }: PNG): number {
  let count = 0;
  for (let at = 0; at < data.length; at += 4)
    if (data[at]! > 120 && data[at]! > 1.6 * data[at + 2]! && data[at]! > 1.15 * data[at + 1]!) ++count;
  return count;
}

/** The mean difference of colours where a mask says so, of 255. */
function difference(one: PNG, two: PNG, mask: Uint8Array): number {
  let [sum, count] = [0, 0];
  mask.forEach((is, pixel) => {
    if (!is) return;
    for (let k = 4 * pixel; k < 4 * pixel + 3; ++k) sum += Math.abs(one.data[k]! - two.data[k]!);
    count += 3;
  });
  return sum / count;
}

/** 1 for each pixel whose colour differs by more than rounding. */
const differing = (one: PNG, two: PNG): Uint8Array =>
  Uint8Array.from({ length: kSide * kSide }, (_, pixel) =>
    Number([0, 1, 2].some((k) => Math.abs(one.data[4 * pixel + k]! - two.data[4 * pixel + k]!) > 2)),
  );

describe('the paint in other engines', () => {
  test('the examples have a package of their own, short scripts, and a row in the README', () => {
    const readme = readFileSync('examples/README.md', 'utf8');
    const tested = JSON.parse(readFileSync('tests/release/hosts/package.json', 'utf8')).devDependencies;
    for (const name of kExamples) {
      const { dependencies, scripts } = JSON.parse(readFileSync(`examples/${name}/package.json`, 'utf8'));
      assert.ok(dependencies.cagecast && scripts.start, name);
      for (const engine of Object.keys(dependencies).filter((one) => kEngines.includes(one)))
        assert.equal(dependencies[engine], tested[engine], engine);
      assert.ok(readFileSync(`examples/${name}/main.js`, 'utf8').split('\n').length <= 61, name);
      assert.ok(readme.includes(`(${name})`), name);
    }
  });

  for (const name of kExamples)
    test(`the example ${name} shows the paint`, async () => {
      const picture = await shown(`${name}/index.html`, /^[1-9]\d* painted$/, (one) => orange(one) >= 400);
      assert.ok(orange(picture) >= 400, `${orange(picture)} pixels`);
    });

  const kCompared: Record<string, string[]> = {
    'at rest': ['babylon.html?right', 'playcanvas.html?'],
    'with cut borders, bones and a morph target': [
      'babylon.html?posed&borders=cut',
      'playcanvas.html?posed&borders=cut',
    ],
  };
  for (const [what, pages] of Object.entries(kCompared))
    describe(`is the same as in three.js: ${what}`, () => {
      let [painted, bare]: PNG[] = [];
      before(async () => {
        const query = pages[1]!.split('?')[1]!;
        painted = await shown(`compared/three.html?${query}`);
        bare = await shown(`compared/three.html?bare&${query}`);
      });

      for (const page of pages)
        test(page, async (context) => {
          const other = await shown(`compared/${page}`);
          const mask = differing(painted!, bare!);
          const area = mask.reduce((sum, is) => sum + is, 0);
          assert.ok(area > 0.05 * kSide * kSide, `${area} pixels are painted`);
          const [inside, outside] = [mask, mask.map((is) => 1 - is)].map((where) => difference(painted!, other, where));
          context.diagnostic(
            `${inside!.toFixed(2)} of 255 on ${area} painted pixels, ${outside!.toFixed(2)} elsewhere`,
          );
          assert.ok(inside! <= kMax && outside! <= kMax, `${inside} and ${outside}`);
        });
    });
});
