import { applyTransferAsync, deserialize, serialize } from 'cagecast/three';
import {
  AmbientLight,
  Box3,
  DirectionalLight,
  Group,
  PerspectiveCamera,
  Scene,
  SRGBColorSpace,
  TextureLoader,
  WebGLRenderer,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const load = (file) => new GLTFLoader().loadAsync(file);
const [head, paint] = await Promise.all([load('target.glb'), new TextureLoader().loadAsync('paint-tiger.png')]);
paint.flipY = false; // textures of glTF begin at the top
paint.colorSpace = SRGBColorSpace;

const camera = new PerspectiveCamera(35, innerWidth / innerHeight, 0.01, 100);
camera.position.z = 2.5;
const pivot = new Group().add(camera, new DirectionalLight(0xffffff, 2));
new Box3().setFromObject(head.scene).getCenter(pivot.position);
const scene = new Scene().add(head.scene, pivot, new AmbientLight(0xffffff, 1.5));
const renderer = new WebGLRenderer({ antialias: true, alpha: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
// The camera moves from the beginning: the transfer does not keep the page from drawing. The head must stay where the cage is.
renderer.setAnimationLoop((time) => {
  pivot.rotation.y = Math.sin(time / 2000) / 2;
  renderer.render(scene, camera);
});

// The first visit makes the transfer in a worker and keeps it. Later visits need neither the worker nor the cage.
const cache = await caches.open('cagecast');
async function applyKept() {
  const kept = await cache.match('transfer');
  try {
    const saved = kept && deserialize(new Uint8Array(await kept.arrayBuffer()));
    return saved && (await applyTransferAsync(head, { saved, texture: paint }));
  } catch {
    return undefined; // it is of another version of the package or of the model
  }
}
async function applyAnew() {
  const cage = await load('cage.glb');
  const onProgress = (share) => {
    document.title = `${Math.round(100 * share)} %`;
  };
  const made = await applyTransferAsync(head, { cage, texture: paint, onProgress });
  await cache.put('transfer', new Response(serialize(made)));
  return made;
}
const applied = (await applyKept()) ?? (await applyAnew());
document.title = `${applied.parts.length} painted`;
