import { init } from 'cagecast';
import { bakeTexture, layOver } from 'cagecast/engines';
import { applyTransfer, createPainter, extract } from 'cagecast/three';
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const [head, cage] = await Promise.all(['target.glb', 'cage.glb'].map((file) => new GLTFLoader().loadAsync(file)));
const stripes = await new THREE.TextureLoader().loadAsync('paint-tiger.png');
await init();
Object.assign(stripes, { flipY: false, colorSpace: THREE.SRGBColorSpace }); // as textures of glTF are

const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
const camera = new THREE.PerspectiveCamera(35, innerWidth / innerHeight, 0.01, 100);
const scene = new THREE.Scene().add(head.scene, new THREE.HemisphereLight(0xffffff, 0x888888, 3));
const controls = new OrbitControls(camera, renderer.domElement);
new THREE.Box3().setFromObject(head.scene).getCenter(controls.target);
camera.position.copy(controls.target).z += 2.5;

const model = extract(head); // as it is in the file: painting adds vertices
const applied = applyTransfer(head, { cage });
const painter = createPainter({ renderer, texture: stripes, applied, cage });
const { layers } = painter;
const [base] = layers.list; // the stripes
painter.picture = { text: 'Rrr!', color: '#ffffff', size: 0.3 };
painter.listen(camera); // what is not on the model turns it

const control = (id) => document.getElementById(id);
control('tool').oninput = ({ target }) => (painter.tool = target.value);
control('color').oninput = ({ target }) => (painter.brush.color = painter.picture.color = target.value);
control('size').oninput = ({ target }) => (painter.brush.size = Number(target.value));
control('mirror').oninput = ({ target }) => (painter.brush.mirror = target.checked);
control('stripes').oninput = ({ target }) => layers.set(base, { opacity: Number(target.value) });
layers.on('change', () => (control('stripes').value = layers.list[0].opacity)); // undo changes it, too
for (const step of ['undo', 'redo']) control(step).onclick = () => painter[step]();
control('save').onclick = () => {
  const context = Object.assign(document.createElement('canvas'), { width: 1024, height: 1024 }).getContext('2d');
  context.drawImage(head.scene.getObjectByName('skin').material.map.image, 0, 0, 1024, 1024);
  const parts = model.parts.filter(({ name }) => name === 'skin'); // those that this texture is for
  const baked = bakeTexture(model.mesh, applied.result, layers.toImageData(), { width: 1024, parts });
  const { data } = layOver(context.getImageData(0, 0, 1024, 1024), baked);
  context.putImageData(new ImageData(data, 1024), 0, 0);
  Object.assign(document.createElement('a'), { href: context.canvas.toDataURL(), download: 'skin.png' }).click();
};

addEventListener('resize', () => {
  renderer.setSize(innerWidth, innerHeight);
  Object.assign(camera, { aspect: innerWidth / innerHeight }).updateProjectionMatrix();
});
renderer.setAnimationLoop(() => {
  controls.update();
  painter.update();
  renderer.render(scene, camera);
  document.title = `${layers.list.length} layers`;
});
