// Builds the models that the page draws, and reads what it has drawn. Runs in the browser.
import {
  AmbientLight,
  BufferAttribute,
  Color,
  DataTexture,
  DirectionalLight,
  Group,
  type Material,
  Mesh,
  type Object3D,
  PerspectiveCamera,
  Scene,
  SphereGeometry,
  SRGBColorSpace,
  WebGLRenderer,
} from 'three';

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

/** A texture of two colours by turns, four columns wide: on a ball the first is seen on the left and the second on the right. */
export function halves(left: number, right: number): DataTexture {
  const [a, b] = [flat(left), flat(right)].map(({ image }) => [...(image.data as Uint8Array).subarray(0, 4)]);
  const texture = new DataTexture(Uint8Array.from([...a!, ...b!, ...a!, ...b!]), 4, 1);
  texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
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
