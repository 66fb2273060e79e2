import { init } from 'cagecast';
import { applyTransfer } from 'cagecast/three';
import {
  AmbientLight,
  CanvasTexture,
  DirectionalLight,
  PerspectiveCamera,
  Raycaster,
  Scene,
  SRGBColorSpace,
  Vector2,
  WebGLRenderer,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

// One picture in the UVs of the cages, which are the same for both avatars.
const picture = Object.assign(document.createElement('canvas'), { width: 1024, height: 1024 });
const brush = picture.getContext('2d');
brush.fillStyle = 'darkorange';
brush.fillRect(0, 0, 1024, 1024);
const texture = new CanvasTexture(picture);
texture.flipY = false; // textures of glTF begin at the top
texture.colorSpace = SRGBColorSpace;

await init();
const load = async (file) => (await new GLTFLoader().loadAsync(file)).scene;
const scene = new Scene().add(new AmbientLight(0xffffff, 1.5), new DirectionalLight(0xffffff, 2));
const names = ['human', 'human-fused'];
const painted = names.map(async (name, i) => {
  const [avatar, cage] = await Promise.all([load(`${name}/target.glb`), load(`${name}/cage.glb`)]);
  const applied = applyTransfer(avatar, cage, { texture });
  avatar.position.x = i - 0.5;
  scene.add(avatar);
  return applied;
});
const [{ channel, parts }] = await Promise.all(painted);

const camera = new PerspectiveCamera(35, innerWidth / innerHeight, 0.01, 100);
camera.position.set(0, 0, 4);
const renderer = new WebGLRenderer({ antialias: true, alpha: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
renderer.setAnimationLoop(() => renderer.render(scene, camera));

// A dot where the pointer is, on both: the UV of the paint is a place in the picture.
addEventListener('pointermove', ({ clientX, clientY }) => {
  const ray = new Raycaster();
  ray.setFromCamera(new Vector2((2 * clientX) / innerWidth - 1, 1 - (2 * clientY) / innerHeight), camera);
  const uv = ray.intersectObject(scene)[0]?.[`uv${channel}`];
  if (!uv) return;
  brush.fillStyle = 'royalblue';
  brush.fillRect(1024 * uv.x - 40, 1024 * uv.y - 40, 80, 80);
  texture.needsUpdate = true;
});
document.title = `${parts.length} painted`;
