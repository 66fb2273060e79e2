// The page that draws frames with and without paint. Runs in the browser.
import { init } from 'cagecast';
import { applyTransfer } from 'cagecast/three';
import {
  AmbientLight,
  BufferAttribute,
  DataTexture,
  DirectionalLight,
  Group,
  Mesh,
  MeshStandardMaterial,
  PerspectiveCamera,
  Scene,
  SphereGeometry,
  SRGBColorSpace,
  type Texture,
  WebGLRenderer,
} from 'three';

/** What the second of two equal models has more than the first. */
export type Extra = 'paint' | 'a texture of three.js' | 'nothing';

/** What the model is made of. */
export interface Kind {
  parts: number;
  /** Morph targets of each part, all of them with some influence. */
  morphs: number;
  /** Whether the materials have maps, as those of avatars do. */
  maps: boolean;
}

const renderer = new WebGLRenderer({ antialias: false });
renderer.setSize(16, 16);
const camera = new PerspectiveCamera(40, 1, 0.1, 20);
camera.position.z = 4;

function ball(radius: number, morphs: number): SphereGeometry {
  const geometry = new SphereGeometry(radius, 6, 4);
  // As loaders make them.
  for (const [name, { array, itemSize }] of Object.entries(geometry.attributes))
    geometry.setAttribute(name, new BufferAttribute(array, itemSize));
  const { array } = geometry.getAttribute('position');
  if (morphs > 0) {
    geometry.morphTargetsRelative = true;
    geometry.morphAttributes.position = Array.from(
      { length: morphs },
      (_, m) =>
        new BufferAttribute(
          Float32Array.from(array, (x, i) => (i % 3 === m % 3 ? 0.1 * x : 0)),
          3,
        ),
    );
  }
  return geometry;
}

function flat(...color: [number, number, number]): Texture {
  const texture = new DataTexture(new Uint8Array([...color, 255]), 1, 1);
  texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
}

function model({ parts, morphs, maps }: Kind): Scene {
  const group = new Group();
  for (let i = 0; i < parts; ++i) {
    const material = new MeshStandardMaterial({
      ...(maps && { map: flat(204, 204, 204), normalMap: flat(128, 128, 255), roughnessMap: flat(0, 128, 0) }),
    });
    const part = new Mesh(ball(0.15, morphs), material);
    part.morphTargetInfluences?.fill(0.5);
    const angle = (2 * Math.PI * i) / parts;
    part.position.set(0.85 * Math.cos(angle), 0.85 * Math.sin(angle), 0.3 * Math.sin(5 * angle));
    group.add(part);
  }
  const light = new DirectionalLight(0xffffff, 2);
  light.position.set(2, 1, 2);
  return new Scene().add(group, light, new AmbientLight(0xffffff, 0.5));
}

let scenes: [Scene, Scene];

/** Makes the scenes. */
async function make(kind: Kind, extra: Extra): Promise<void> {
  await init();
  scenes = [model(kind), model(kind)];
  const [texture, second] = [flat(255, 0, 0), scenes[1].children[0]!];
  if (extra === 'paint') {
    const cage = new Mesh(new SphereGeometry(1.1, 24, 16));
    applyTransfer(second, cage, { texture, threshold: 0 });
  } else if (extra === 'a texture of three.js') {
    // The UVs are there already, and all parts have the same texture: less cannot be read for what is to be seen.
    for (const { material } of second.children as Mesh<SphereGeometry, MeshStandardMaterial>[])
      material[kind.maps ? 'emissiveMap' : 'map'] = texture;
  }
}

/** Draws frames, each of which is waited for. @returns the milliseconds that each took this thread. */
function draw(which: 0 | 1, frames: number): number[] {
  const gl = renderer.getContext();
  const times: number[] = [];
  for (let i = 0; i < frames; ++i) {
    const began = performance.now();
    renderer.render(scenes[which], camera);
    times.push(performance.now() - began);
    gl.finish();
  }
  return times;
}

Object.assign(window, { make, draw });
