import { init } from 'cagecast';
import { Application, Asset, BoundingBox, Color, Entity, FILLMODE_FILL_WINDOW, RESOLUTION_AUTO } from 'playcanvas';
import { paintEntity } from './paint.js';

const canvas = document.body.appendChild(document.createElement('canvas'));
const app = new Application(canvas, { graphicsDeviceOptions: { alpha: true } });
app.setCanvasFillMode(FILLMODE_FILL_WINDOW);
app.setCanvasResolution(RESOLUTION_AUTO);
app.start();
const load = (type, url, data, options) =>
  new Promise((resolve, reject) => {
    const asset = new Asset(url, type, { url }, data, options);
    asset.once('load', () => resolve(asset.resource));
    asset.once('error', reject);
    app.assets.add(asset);
    app.assets.load(asset);
  });
const [model, outer, paint] = await Promise.all([
  load('container', 'target.glb', null, { morphPreserveData: true }),
  load('container', 'cage.glb'),
  load('texture', 'paint-tiger.png', { srgb: true }),
  init(),
]);
const head = model.instantiateRenderEntity();
const painted = paintEntity(app.graphicsDevice, head, outer.instantiateRenderEntity(), paint);
app.root.addChild(head);

const box = new BoundingBox();
head.findComponents('render').forEach(({ meshInstances }, r) => {
  for (const { aabb } of meshInstances) r === 0 ? box.copy(aabb) : box.add(aabb);
});
const camera = new Entity('camera');
camera.addComponent('camera', { fov: 35, nearClip: 0.01, farClip: 100, clearColor: new Color(0.87, 0.87, 0.87) });
camera.setPosition(box.center.x, box.center.y, box.center.z + 2.5);
const light = new Entity('light');
light.addComponent('light', { type: 'directional', intensity: 1.5 });
light.setEulerAngles(45, 0, 0);
app.scene.ambientLight = new Color(0.5, 0.5, 0.5);
for (const entity of [camera, light]) app.root.addChild(entity);
let time = 0;
app.on('update', (seconds) => {
  time += seconds;
  head.setEulerAngles(0, 30 * Math.sin(time / 2), 0);
});
document.title = `${painted.length} painted`;
