import {
  Color4,
  Engine,
  FreeCamera,
  HemisphericLight,
  LoadAssetContainerAsync,
  Scene,
  Texture,
  Vector3,
} from '@babylonjs/core';
import '@babylonjs/loaders/glTF/index.js';
import { init } from 'cagecast';
import { paintMeshes } from './paint.js';

const canvas = document.body.appendChild(document.createElement('canvas'));
const engine = new Engine(canvas, true, { useExactSrgbConversions: true });
const scene = new Scene(engine);
scene.clearColor = new Color4(0.87, 0.87, 0.87, 1);
const load = (file) => LoadAssetContainerAsync(file, scene);
const [head, cage] = await Promise.all([load('target.glb'), load('cage.glb'), init()]);
// Textures of glTF begin at the top; the GPU decodes sRGB.
const paint = new Texture('paint-tiger.png', scene, { invertY: false, useSRGBBuffer: true });
const painted = paintMeshes(head.meshes, cage.meshes, paint);
head.addAllToScene();

const { min, max } = head.meshes[0].getHierarchyBoundingVectors();
const center = min.add(max).scale(0.5);
const camera = new FreeCamera('camera', center.add(new Vector3(0, 0, 2.5)), scene);
camera.setTarget(center);
camera.fov = (35 * Math.PI) / 180;
camera.minZ = 0.01;
new HemisphericLight('light', new Vector3(0, 1, 1), scene).intensity = 1.5;
addEventListener('resize', () => engine.resize());
engine.runRenderLoop(() => {
  head.meshes[0].rotate(Vector3.Up(), Math.cos(performance.now() / 2000) / 240);
  scene.render();
});
document.title = `${painted.length} painted`;
