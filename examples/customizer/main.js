import { init } from 'cagecast';
import { applyTransfer } from 'cagecast/three';
import { createLayers } from 'cagecast/three/layers';
import { createPainter } from 'cagecast/three/paint';
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const load = (file) => new GLTFLoader().loadAsync(file);
const [head, cage, stripes] = await Promise.all([
  load('target.glb'),
  load('cage.glb'),
  new THREE.TextureLoader().loadAsync('paint-tiger.png'),
  init(),
]);
stripes.flipY = false; // textures of glTF begin at the top
stripes.colorSpace = THREE.SRGBColorSpace;

const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
const camera = new THREE.PerspectiveCamera(35, innerWidth / innerHeight, 0.01, 100);
const scene = new THREE.Scene().add(head.scene, new THREE.HemisphereLight(0xffffff, 0x888888, 3));
const controls = new OrbitControls(camera, renderer.domElement);
new THREE.Box3().setFromObject(head.scene).getCenter(controls.target);
camera.position.copy(controls.target).z += 2.5;

const layers = createLayers({ renderer });
const base = layers.add(stripes, { name: 'stripes' });
const applied = applyTransfer(head.scene, cage.scene);
const painter = createPainter({ layers, applied, cage: cage.scene });
painter.picture = { text: 'Rrr!', color: '#ffffff', size: 0.3 };
painter.listen(camera); // what is not on the model turns it

const control = (id) => document.getElementById(id);
control('tool').oninput = ({ target }) => (painter.tool = target.value);
control('color').oninput = ({ target }) => (painter.brush.color = painter.picture.color = target.value);
control('size').oninput = ({ target }) => (painter.brush.size = Number(target.value));
control('mirror').oninput = ({ target }) => (painter.brush.mirror = target.checked);
control('stripes').oninput = ({ target }) => layers.set(base, { opacity: Number(target.value) });
control('undo').onclick = () => painter.undo();
control('redo').onclick = () => painter.redo();
control('save').onclick = () => {
  const canvas = Object.assign(document.createElement('canvas'), { width: 1024, height: 1024 });
  canvas.getContext('2d').putImageData(layers.toImageData(1024), 0, 0);
  Object.assign(document.createElement('a'), { href: canvas.toDataURL(), download: 'paint.png' }).click();
};

renderer.setAnimationLoop(() => {
  controls.update();
  painter.update();
  renderer.render(scene, camera);
  document.title = `${layers.list.length} layers`;
});
