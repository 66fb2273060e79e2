import { init } from 'cagecast';
import { applyTransfer } from 'cagecast/three';
import {
  AmbientLight,
  Box3,
  DirectionalLight,
  PerspectiveCamera,
  Scene,
  SRGBColorSpace,
  TextureLoader,
  WebGLRenderer,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const load = (file) => new GLTFLoader().loadAsync(file);
const [head, cage, paint] = await Promise.all([
  load('target.glb'),
  load('cage.glb'),
  new TextureLoader().loadAsync('paint-tiger.png'),
  init(),
]);
paint.flipY = false; // textures of glTF begin at the top
paint.colorSpace = SRGBColorSpace;
const { parts } = applyTransfer(head, { cage, texture: paint });

const scene = new Scene().add(head.scene, new AmbientLight(0xffffff, 1.5), new DirectionalLight(0xffffff, 2));
const camera = new PerspectiveCamera(35, innerWidth / innerHeight, 0.01, 100);
new Box3().setFromObject(head.scene).getCenter(camera.position).z += 2.5;
const renderer = new WebGLRenderer({ antialias: true, alpha: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
renderer.setAnimationLoop((time) => {
  head.scene.rotation.y = Math.sin(time / 2000) / 2;
  renderer.render(scene, camera);
});
document.title = `${parts.length} painted`;
