import { init } from 'cagecast';
import { applyTransfer } from 'cagecast/three';
import { createPainter } from 'cagecast/three/paint';
import {
  AmbientLight,
  DirectionalLight,
  PerspectiveCamera,
  Scene,
  SRGBColorSpace,
  TextureLoader,
  WebGLRenderer,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const load = async (file) => (await new GLTFLoader().loadAsync(file)).scene;
// The cages of both avatars have the same UVs, so one picture is for both.
const names = ['human', 'human-fused'];
const [avatars, cages, texture] = await Promise.all([
  Promise.all(names.map((name) => load(`${name}/target.glb`))),
  Promise.all(names.map((name) => load(`${name}/cage.glb`))),
  new TextureLoader().loadAsync('human/paint-harlequin.png'),
  init(),
]);
texture.flipY = false; // textures of glTF begin at the top
texture.colorSpace = SRGBColorSpace;
const applied = avatars.map((avatar, i) => applyTransfer(avatar, cages[i]));
avatars.forEach((avatar, i) => {
  avatar.position.x = i - 0.5;
});

const scene = new Scene().add(...avatars, new AmbientLight(0xffffff, 1.5), new DirectionalLight(0xffffff, 2));
const camera = new PerspectiveCamera(35, innerWidth / innerHeight, 0.01, 100);
camera.position.set(0, 0, 4);
const renderer = new WebGLRenderer({ antialias: true, alpha: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);

// What is painted on one shows on the other.
const painter = createPainter({ renderer, texture, applied, cage: cages[0] });
Object.assign(painter.brush, { color: '#2040ff', size: 0.1 });
painter.listen(camera);
renderer.setAnimationLoop(() => {
  painter.update();
  renderer.render(scene, camera);
});
document.title = `${applied.length} painted`;
