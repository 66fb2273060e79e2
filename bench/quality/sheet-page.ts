import { init, type TransferResult } from 'cagecast';
import { applyTransfer, type Part } from 'cagecast/three';
import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  DataTexture,
  DirectionalLight,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshStandardMaterial,
  NearestFilter,
  NeutralToneMapping,
  type Object3D,
  PCFShadowMap,
  PerspectiveCamera,
  PlaneGeometry,
  PMREMGenerator,
  Scene,
  ShadowMaterial,
  SRGBColorSpace,
  type Texture,
  TextureLoader,
  Vector3,
  WebGLRenderer,
} from 'three';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

/** What is shown of a model. */
export type Look = 'plain' | 'cage' | 'naive' | 'removed' | 'paper' | 'default';

/** A model, by the addresses of its files. */
export interface Row {
  target: string;
  cage: string;
  paint: string | undefined;
  turn: number;
  rise: number;
  /** Show only this share of its height, at the top, and as much of its width about the middle. Default: all. */
  upper?: number;
  /** Spots of the target that get a dot and their name. Default: none. */
  marks?: Readonly<Record<string, readonly [number, number, number]>>;
}

declare global {
  /** Appends a picture of the model for each look. @throws if a file cannot be read or a transfer fails. */
  function drawRow(row: Row, looks: readonly Look[], size: { width: number; height: number }): Promise<void>;
}

/** How much finer pictures are drawn than shown. */
const oversampling = 2;
const fieldOfView = 24; // degrees
const margin = 0.04; // of the picture's sides
const marginForNames = 0.22;

const renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.setClearColor('#ffffff');
renderer.toneMapping = NeutralToneMapping;
renderer.shadowMap.enabled = true;
renderer.shadowMap.type = PCFShadowMap;

const generator = new PMREMGenerator(renderer);
const surroundings = generator.fromScene(new RoomEnvironment(), 0.04).texture;

globalThis.drawRow = async (row, looks, size) => {
  await init();
  for (const look of looks) {
    const canvas = document.createElement('canvas');
    document.querySelector('main')!.append(canvas);
    await draw(canvas, row, look, size);
  }
};

async function draw(
  canvas: HTMLCanvasElement,
  row: Row,
  look: Look,
  { width, height }: { width: number; height: number },
): Promise<void> {
  const loader = new GLTFLoader();
  const [{ scene: target }, { scene: cage }] = await Promise.all([
    loader.loadAsync(row.target),
    loader.loadAsync(row.cage),
  ]);
  const paint = row.paint === undefined ? checker() : await new TextureLoader().loadAsync(row.paint);
  paint.flipY = false; // as all textures of glTF
  paint.colorSpace = SRGBColorSpace;
  paint.anisotropy = 8;
  // The frame is that of the cage, which is the largest, whatever is shown.
  const frame = new Box3().setFromObject(cage);
  const model = new Group();
  model.add(target);
  dress(target, cage, paint, look);
  if (look === 'cage') model.add(shellOf(cage, paint));

  const scene = new Scene();
  scene.environment = surroundings;
  scene.environmentIntensity = 0.62;
  const scale = 2 / frame.getSize(new Vector3()).length();
  model.scale.setScalar(scale);
  model.position.copy(frame.getCenter(new Vector3())).multiplyScalar(-scale);
  model.updateMatrixWorld();
  model.traverse((object) => {
    if (object instanceof Mesh) object.castShadow = object.receiveShadow = true;
  });
  scene.add(model, ...lightsAndFloor(row.turn, ((frame.min.y - frame.max.y) / 2) * scale));

  renderer.setSize(oversampling * width, oversampling * height, false);
  cage.applyMatrix4(model.matrixWorld);
  const camera = cameraFor(row, cage, width / height);
  renderer.render(scene, camera);
  // Made smaller in one step, with all pixels taken into account.
  const image = await createImageBitmap(renderer.domElement, {
    resizeWidth: width,
    resizeHeight: height,
    resizeQuality: 'high',
  });
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext('2d')!;
  context.drawImage(image, 0, 0);
  if (row.marks === undefined) return;
  const marks = Object.entries(row.marks).map(([name, at]) => {
    const { x, y } = new Vector3(...at).applyMatrix4(model.matrixWorld).project(camera);
    return { name, x: ((1 + x) / 2) * width, y: ((1 - y) / 2) * height };
  });
  drawMarks(context, marks);
}

/** Pixels between the lines of names. */
const lineHeight = 22;

/** Draws a dot for each spot, and a line to its name at the nearer side. */
function drawMarks(context: CanvasRenderingContext2D, marks: readonly { name: string; x: number; y: number }[]): void {
  const { width, height } = context.canvas;
  context.font = '15px ui-monospace, monospace';
  context.textBaseline = 'middle';
  const byHeight = [...marks].sort((a, b) => a.y - b.y);
  for (const isLeft of [true, false]) {
    const own = byHeight.filter(({ x }) => x < width / 2 === isLeft);
    // As near to their dots' height as the names above and below let them.
    let last = -Infinity;
    const heights = own.map(({ y }) => (last = Math.max(y, last + lineHeight)));
    const over = Math.max(0, last + lineHeight / 2 - height);
    own.forEach(({ name, x, y }, i) => {
      const at = Math.max(lineHeight / 2 + i * lineHeight, heights[i]! - over);
      const edge = isLeft ? 8 + context.measureText(name).width + 6 : width - 14 - context.measureText(name).width;
      context.strokeStyle = 'rgb(0 0 0 / 0.35)';
      context.beginPath();
      context.moveTo(edge, at);
      context.lineTo(x, y);
      context.stroke();
      context.fillStyle = '#222';
      context.fillText(name, isLeft ? 8 : edge + 6, at);
      context.fillStyle = '#d02030';
      context.beginPath();
      context.arc(x, y, 4, 0, 2 * Math.PI);
      context.fill();
    });
  }
}

/** Paints the target as the look says. */
function dress(target: Object3D, cage: Object3D, paint: Texture, look: Look): void {
  if (look === 'cage' || look === 'plain') return;
  if (look === 'naive') {
    const { update, result } = applyTransfer(target, cage, { texture: paint, preset: 'paper' });
    update({
      zones: new Uint8Array(result.zones.length),
      cosmeticTriangles: new Uint8Array(result.cosmeticTriangles.length).fill(1),
      segmentStats: result.segmentStats,
    });
    return;
  }
  const texture = look === 'removed' ? faded(paint) : paint;
  const { parts, result } = applyTransfer(target, cage, { texture, preset: look === 'paper' ? 'paper' : 'default' });
  if (look === 'removed') for (const part of parts) part.mesh!.add(removedOf(part, result));
}

/** The same without colours and pale, so that red can be seen on it. */
function faded(paint: Texture): Texture {
  const { width, height } = paint.image as ImageBitmap;
  const canvas = Object.assign(document.createElement('canvas'), { width, height });
  const context = canvas.getContext('2d')!;
  context.filter = 'grayscale(1) contrast(0.4) brightness(1.35)';
  context.drawImage(paint.image as ImageBitmap, 0, 0);
  const pale = new CanvasTexture(canvas);
  pale.flipY = paint.flipY;
  pale.colorSpace = paint.colorSpace;
  pale.anisotropy = paint.anisotropy;
  return pale;
}

/** What may not be painted of a part, in red. */
function removedOf({ geometry, firstTriangle, triangleCount }: Part, { cosmeticTriangles }: TransferResult): Mesh {
  const corners: number[] = [];
  for (let i = 0; i < 3 * triangleCount; ++i) {
    if (cosmeticTriangles[firstTriangle + Math.floor(i / 3)] === 0)
      corners.push(geometry.index ? geometry.index.getX(i) : i);
  }
  const removed = new BufferGeometry();
  for (const name of ['position', 'normal'])
    if (geometry.hasAttribute(name)) removed.setAttribute(name, geometry.getAttribute(name));
  removed.setIndex(new BufferAttribute(Uint32Array.from(corners), 1));
  const red = { color: '#e01020', emissive: '#700008', roughness: 0.6 };
  return new Mesh(removed, new MeshStandardMaterial({ ...red, ...offset(-1) }));
}

/** Moves a material away from the eye in depth, or towards it. */
const offset = (by: number) => ({ polygonOffset: true, polygonOffsetFactor: by, polygonOffsetUnits: by });

/** The cage with the paint on it, and its edges. */
function shellOf(cage: Object3D, paint: Texture): Group {
  const shell = new Group();
  cage.updateWorldMatrix(true, true);
  cage.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    const skin = new Mesh(object.geometry, new MeshStandardMaterial({ map: paint, roughness: 0.7, ...offset(1) }));
    const ink = new LineBasicMaterial({ color: '#1c2430', transparent: true, opacity: 0.55 });
    const lines = new LineSegments(new EdgesGeometry(object.geometry, 0), ink);
    for (const part of [skin, lines]) {
      part.applyMatrix4(object.matrixWorld);
      shell.add(part);
    }
  });
  return shell;
}

/** A key light over the viewer's shoulder, and a floor that catches its shadow. */
function lightsAndFloor(turn: number, height: number): Object3D[] {
  const key = new DirectionalLight(0xfff4e6, 2.1);
  const angle = (turn * Math.PI) / 180 - 0.6;
  key.position.set(2 * Math.sin(angle), 5, 2 * Math.cos(angle));
  key.castShadow = true;
  key.shadow.mapSize.set(2048, 2048);
  key.shadow.radius = 6;
  key.shadow.normalBias = 0.02;
  Object.assign(key.shadow.camera, { left: -1.6, right: 1.6, top: 1.6, bottom: -1.6, near: 1, far: 10 });
  const floor = new Mesh(new PlaneGeometry(12, 12), new ShadowMaterial({ opacity: 0.22 }));
  floor.rotation.x = -Math.PI / 2;
  floor.position.y = height - 0.01;
  floor.receiveShadow = true;
  return [key, floor];
}

/** A camera that sees an object about the origin, as large as the picture allows. */
function cameraFor({ turn, rise, upper = 1, marks }: Row, object: Object3D, aspect: number): PerspectiveCamera {
  const camera = new PerspectiveCamera(fieldOfView, aspect, 0.1, 50);
  const [a, b] = [(turn * Math.PI) / 180, (rise * Math.PI) / 180];
  camera.position.set(Math.sin(a) * Math.cos(b), Math.sin(b), Math.cos(a) * Math.cos(b)).multiplyScalar(8);
  camera.lookAt(0, 0, 0);
  camera.updateMatrixWorld();
  camera.updateProjectionMatrix();
  const seen = new Box3();
  const { min, max } = new Box3().setFromObject(object);
  const height = upper * (max.y - min.y);
  const isShown = ({ x, y }: Vector3): boolean =>
    upper === 1 || (y >= max.y - height && Math.abs(x - (min.x + max.x) / 2) <= height / 2);
  object.traverse((mesh) => {
    if (!(mesh instanceof Mesh)) return;
    const places = mesh.geometry.getAttribute('position');
    for (let v = 0; v < places.count; ++v) {
      const place = new Vector3().fromBufferAttribute(places, v).applyMatrix4(mesh.matrixWorld);
      if (isShown(place)) seen.expandByPoint(place.project(camera));
    }
  });
  // The part of the picture that it takes becomes the whole of it.
  const [middle, size] = [seen.getCenter(new Vector3()), seen.getSize(new Vector3())];
  const share = (Math.max(size.x, size.y) / 2) * (1 + 2 * (marks === undefined ? margin : marginForNames));
  camera.setViewOffset(
    aspect,
    1,
    ((1 + middle.x - share) / 2) * aspect,
    (1 - middle.y - share) / 2,
    share * aspect,
    share,
  );
  return camera;
}

/** Squares in colours that run with U and V. */
function checker(): Texture {
  const size = 32;
  const texels = new Uint8Array(4 * size * size);
  for (let v = 0; v < size; ++v) {
    for (let u = 0; u < size; ++u) {
      const shade = (u + v) % 2 === 0 ? 1 : 0.6;
      texels.set([60 + 190 * (u / size) * shade, 200 * shade, 60 + 190 * (v / size) * shade, 255], 4 * (size * v + u));
    }
  }
  const board = new DataTexture(texels, size, size);
  board.magFilter = NearestFilter;
  board.needsUpdate = true;
  return board;
}
