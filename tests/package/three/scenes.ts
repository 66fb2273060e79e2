// Models, views and assertions of all scenes. Runs in the browser.
import type { Painter } from 'cagecast/three';
import {
  AmbientLight,
  Bone,
  BufferAttribute,
  Color,
  DataTexture,
  DirectionalLight,
  Group,
  type Material,
  Mesh,
  MeshStandardMaterial,
  type Object3D,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Skeleton,
  SkinnedMesh,
  SphereGeometry,
  SRGBColorSpace,
  Vector2,
  WebGLRenderer,
} from 'three';

/** Scenes by name: each throws an error with what it found instead. */
export type Scenes = Record<string, () => void | Promise<void>>;

/** Lets the test that has opened the page run its scenes. */
export const offer = (scenes: Scenes): unknown =>
  Object.assign(globalThis, {
    names: Object.keys(scenes),
    /** Runs a scene. @returns its error, if it fails. */
    run: async (name: string): Promise<string | undefined> => {
      try {
        await scenes[name]!();
        return undefined;
      } catch (error) {
        return String((error as Error).stack ?? error);
      }
    },
  });

/** @param found  What was found, for the message. */
export function ok(condition: unknown, found: unknown): asserts condition {
  if (!condition) throw new Error(`found: ${typeof found === 'string' ? found : JSON.stringify(found)}`);
}

/** Compares plain data. */
export function equal(found: unknown, expected: unknown, what = 'it'): void {
  const [is, should] = [found, expected].map((value) => JSON.stringify(value));
  ok(is === should, `${what} is ${is}, not ${should}`);
}

/** Compares numbers one by one. @param most  By how much they may differ. */
export const near = (found: readonly number[], expected: readonly number[], most = 3): void =>
  ok(
    found.every((value, k) => Math.abs(value - expected[k]!) <= most),
    `${found} is not ${expected}`,
  );

/** Asserts that a call fails with a message. */
export function refuses(call: () => unknown, message: RegExp): void {
  let found = 'no error';
  try {
    call();
  } catch (error) {
    found = (error as Error).message;
  }
  ok(message.test(found), `${found} is not ${message}`);
}

/** Pixels on each side of what is drawn. */
export const kSize = 64;

export const renderer = new WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
renderer.setSize(kSize, kSize);
renderer.info.autoReset = false;

export const camera = new PerspectiveCamera(40, 1, 0.1, 20);
camera.position.z = 4;

/** A closed ball; its vertices have UVs, and morph targets where asked. */
export function ball(radius = 1, morphs = 0): SphereGeometry {
  const geometry = new SphereGeometry(radius, 24, 16);
  const { array } = geometry.getAttribute('position');
  if (morphs > 0) {
    geometry.morphTargetsRelative = true;
    geometry.morphAttributes.position = Array.from(
      { length: morphs },
      (_, m) =>
        new BufferAttribute(
          Float32Array.from(array, (x, i) => (i % 3 === m % 3 ? 0.8 * x : 0)),
          3,
        ),
    );
  }
  return geometry;
}

/** A ball around the models, which is the cage of all of them. */
export const cage = (): Mesh => new Mesh(ball(1.1));

/** A model of one mesh. */
export const modelOf = (material: Material, geometry = ball()): Group => new Group().add(new Mesh(geometry, material));

/** A texture of one colour, given as sRGB. */
export function flat(color: number): DataTexture {
  const { r, g, b } = new Color(color).convertLinearToSRGB();
  const texel = [r, g, b].map((value) => Math.round(255 * value));
  const texture = new DataTexture(
    Uint8Array.from({ length: 16 }, (_, i) => [...texel, 255][i % 4]!),
    2,
    2,
  );
  texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
}

/** A texture of one colour with alpha, given as sRGB. */
export function clear(color: number, alpha: number): DataTexture {
  const texture = flat(color);
  const data = texture.image.data as Uint8Array;
  for (let at = 3; at < data.length; at += 4) data[at] = alpha;
  return texture;
}

/** Texels with paint, and the highest of their alphas. */
export function filled(painter: Painter): { texels: number; most: number } {
  const alphas = painter.layers.toImageData().data.filter((_, at) => at % 4 === 3);
  return { texels: alphas.filter((alpha) => alpha > 0).length, most: alphas.reduce((a, b) => Math.max(a, b)) };
}

/** A texture of two colours by turns, four columns wide: on a ball the first is seen on the left and the second on the right. */
export function halves(left: number, right: number): DataTexture {
  const [a, b] = [flat(left), flat(right)].map(({ image }) => [...(image.data as Uint8Array).subarray(0, 4)]);
  const texture = new DataTexture(Uint8Array.from([...a!, ...b!, ...a!, ...b!]), 4, 1);
  texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
}

export const white = (): MeshStandardMaterial => new MeshStandardMaterial({ color: 0xbbbbbb });

/** A ball with one bone, and as many morph targets as asked. */
export function skinned(morphs = 0): { model: Group; mesh: SkinnedMesh; bone: Bone } {
  const geometry = ball(1, morphs);
  const { count } = geometry.getAttribute('position');
  const weights = Float32Array.from({ length: 4 * count }, (_, i) => Number(i % 4 === 0));
  geometry.setAttribute('skinIndex', new BufferAttribute(new Uint16Array(4 * count), 4));
  geometry.setAttribute('skinWeight', new BufferAttribute(weights, 4));
  const [mesh, bone] = [new SkinnedMesh(geometry, white()), new Bone()];
  mesh.frustumCulled = false;
  const model = new Group().add(bone, mesh);
  mesh.bind(new Skeleton([bone]));
  return { model, mesh, bone };
}

/** Draws a model under a light from the side. @returns 4 numbers per pixel, and the number of draw calls. */
export function draw(model: Object3D, layer = 0, from = camera): { pixels: number[]; calls: number } {
  const light = new DirectionalLight(0xffffff, 2);
  light.position.set(2, 1, 2);
  light.layers.enableAll();
  const scene = new Scene().add(model, light, new AmbientLight(0xffffff, 0.5));
  scene.background = new Color(0x336699);
  from.layers.set(layer);
  renderer.info.reset();
  renderer.render(scene, from);
  const { calls } = renderer.info.render;
  const gl = renderer.getContext();
  const bytes = new Uint8Array(4 * kSize * kSize);
  gl.readPixels(0, 0, kSize, kSize, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  model.removeFromParent();
  return { pixels: [...bytes], calls };
}

/** The largest difference of two pictures, in levels of 255. */
export const difference = (a: readonly number[], b: readonly number[]): number =>
  a.reduce((most, value, i) => Math.max(most, Math.abs(value - b[i]!)), 0);

/** How many pixels of a picture are of a colour: red, green or blue, the greatest by far. */
export function countOf(pixels: readonly number[], channel: 0 | 1 | 2): number {
  let count = 0;
  for (let at = 0; at < pixels.length; at += 4) {
    const others = [0, 1, 2].filter((k) => k !== channel).map((k) => pixels[at + k]!);
    if (pixels[at + channel]! > 40 && pixels[at + channel]! > 2 * Math.max(...others)) ++count;
  }
  return count;
}

/** How many pixels of a model are red, green and blue. */
export const colorsOf = (model: Object3D, layer = 0, from = camera): number[] => {
  const { pixels } = draw(model, layer, from);
  return ([0, 1, 2] as const).map((channel) => countOf(pixels, channel));
};

/** The colour that most of a model has: red, green, blue, or none. */
export function lookOf(model: Object3D): string {
  const seen = colorsOf(model).map((count) => count > 100);
  return ['red', 'green', 'blue'].filter((_, channel) => seen[channel]).join() || 'none';
}

/** What a pixel of a picture is, 0 to 255. */
export const pixelAt = (pixels: readonly number[], x: number, y: number): number[] =>
  pixels.slice(4 * (y * kSize + x), 4 * (y * kSize + x) + 3);

/** The colour in the middle of the picture. */
export const middleOf = (model: Object3D): number[] => pixelAt(draw(model).pixels, kSize / 2, kSize / 2);

/** A ray through a pixel of the picture. */
export function ray(x: number, y: number): Raycaster {
  const raycaster = new Raycaster();
  camera.updateMatrixWorld();
  raycaster.setFromCamera(new Vector2((2 * (x + 0.5)) / kSize - 1, (2 * (y + 0.5)) / kSize - 1), camera);
  return raycaster;
}

/** The calls of WebGL that a frame takes, once everything is on the GPU. */
export function commandsOf(model: Object3D): number {
  const gl = renderer.getContext();
  const own = gl as unknown as Record<string, unknown>;
  const methods = Object.entries(Object.getOwnPropertyDescriptors(Object.getPrototypeOf(gl))).filter(
    ([, { value }]) => typeof value === 'function',
  );
  renderer.render(model, camera);
  let count = 0;
  for (const [name, { value }] of methods)
    own[name] = (...args: unknown[]) => {
      ++count;
      return value.apply(gl, args);
    };
  renderer.render(model, camera);
  for (const [name] of methods) delete own[name];
  return count;
}

/** Loses the graphics context, and gets it back. @param meanwhile  What is done without it. */
export async function loseContext(meanwhile = (): void => {}): Promise<void> {
  // It cannot be restored before the event has ended.
  const event = (name: string) =>
    new Promise((done) => renderer.domElement.addEventListener(name, () => setTimeout(done), { once: true }));
  const lost = event('webglcontextlost');
  renderer.forceContextLoss();
  await lost;
  meanwhile();
  const restored = event('webglcontextrestored');
  renderer.forceContextRestore();
  await restored;
}
