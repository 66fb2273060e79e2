import { VRMLoaderPlugin, VRMUtils } from '@pixiv/three-vrm';
import { applyTransferAsync } from 'cagecast/three';
import {
  AmbientLight,
  Box3,
  DirectionalLight,
  PerspectiveCamera,
  Scene,
  SRGBColorSpace,
  TextureLoader,
  Timer,
  WebGLRenderer,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const loader = new GLTFLoader().register((parser) => new VRMLoaderPlugin(parser));
const [avatar, cage, paint] = await Promise.all([
  loader.loadAsync('avatar.vrm'),
  loader.loadAsync('cage.glb'),
  new TextureLoader().loadAsync('paint-harlequin.png'),
]);
paint.flipY = false; // textures of glTF begin at the top
paint.colorSpace = SRGBColorSpace;
const { vrm } = avatar.userData;
VRMUtils.combineSkeletons(vrm.scene);
const { parts } = await applyTransferAsync(vrm.scene, { cage, texture: paint });

const scene = new Scene().add(vrm.scene, new AmbientLight(0xffffff, 1.5), new DirectionalLight(0xffffff, 2));
const camera = new PerspectiveCamera(35, innerWidth / innerHeight, 0.01, 100);
new Box3().setFromObject(vrm.scene).getCenter(camera.position).z += 2.5;
const renderer = new WebGLRenderer({ antialias: true, alpha: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
const timer = new Timer();
renderer.setAnimationLoop((time) => {
  timer.update(time);
  vrm.humanoid.getNormalizedBoneNode('hips').rotation.y = Math.sin(time / 2000) / 2;
  vrm.update(timer.getDelta());
  renderer.render(scene, camera);
});
document.title = `${parts.length} painted`;
