import type { Classification, CutTarget } from 'cagecast';
import {
  type AnimationClip,
  AnimationMixer,
  Box3,
  Group,
  MathUtils,
  type Matrix4,
  Mesh,
  MOUSE,
  NeutralToneMapping,
  type Object3D,
  PCFShadowMap,
  PerspectiveCamera,
  type Ray,
  Raycaster,
  Spherical,
  type Texture,
  TOUCH,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { requireGraphics } from '../platform/graphics';
import { clearError, showError } from '../platform/page';
import { disposeModel, type Model } from '../scene/load-model';
import type { SplitProjection } from '../scene/transfer-messages';
import { kFirstView, showsPaint, type View } from '../scene/view-state';
import { CageLines } from './cage-lines';
import { type Angle, aspectOf, type Crowd, type FreePart, fittingDistance, freePartOf, frontOf } from './framing';
import { Highlight } from './overlay/highlight';
import { kLooks, type Look, Overlay } from './overlay/overlay';
import { pick, type Spot } from './pick';
import { Pointing, type Tool } from './pointing';
import { Studio } from './studio';

const kFieldOfView = 28; // degrees
const kHome = new Spherical(1, MathUtils.degToRad(80), MathUtils.degToRad(14));
const kLevel = MathUtils.degToRad(84); // of the views from the front and from the side
const kNear = 5; // of a camera that looks at one of several models
const kFar = 12; // the greatest distance of the camera, from one model
const kFarthest = 60; // and from several
const kPortrait = 0.85; // the radius of what small pictures show, in radii of a model
const kSway = MathUtils.degToRad(40); // amplitude of the idle rotation
const kSwaySeconds = 16; // its period
const kLongestFrame = 0.25; // seconds: limits the rotation per frame, so that a slow frame causes no jump
const kTurnSeconds = 12; // of a whole turn of the turntable
const kPicturePixels = 2; // of a saved picture, per pixel of the page
const kHighlight = '#22d3ff';
const kKeyStep = MathUtils.degToRad(6);
const kKeyNearer = 1 / 1.1; // of the distance
const kKeyMove = 40; // pixels
const kMiddle = new Vector3(); // of the model

/** Somebody to take a picture of. */
interface Sitter {
  /** The model, scaled to a diagonal of 2 about the origin; undefined for the one on the stage. */
  holder: Object3D | undefined;
  overlay: Pick<Overlay, 'show'> | undefined;
  /** Where it looks, as `frontOf`. */
  front: number;
  look: Look;
}

/** What is on the stage, to be drawn elsewhere. */
interface Lent {
  /** Scaled and moved to a diagonal of 2 about the origin. */
  stage: Group;
  model: Object3D;
  /** Where it looks, as `frontOf`. */
  front: number;
  environment: Texture | null;
  giveBack(): void;
}

/** Shows a target with its paint and its cage, and lets the user turn it. Draws only when something changed. */
export class Viewer {
  /** The renderer; features may use it to render textures. Call `redraw` afterwards. */
  readonly renderer: WebGLRenderer;
  /** Objects of features, in the space of the transferred target. */
  readonly marks = new Group();
  readonly #canvas: HTMLCanvasElement;
  readonly #studio: Studio;
  readonly #camera = new PerspectiveCamera(kFieldOfView, 1, 0.05, 100);
  readonly #controls: OrbitControls;
  readonly #pointing: Pointing;
  #view = kFirstView;
  #model: Model | undefined;
  #overlay: Overlay | undefined;
  #cage: CageLines | undefined;
  #highlight: Highlight | undefined;
  #paint: Texture | undefined;
  #frame = 0;
  #stale = true;
  readonly #preparations: (() => void)[] = [];
  /** Seconds of idle rotation so far; undefined if it is off. */
  #swayed: number | undefined;
  #drawn = 0;
  /** When the controls were updated last. */
  #turned = 0;
  /** Whether the user moved the camera. */
  #moved = false;
  /** The distance at which the whole model is visible, for the current size. */
  #far = 1;
  #free: FreePart = { width: 1, height: 1, top: 0, bottom: 0, fill: 1 };
  /** The model's vertices in the studio. */
  #points: Float32Array = new Float32Array();
  /** Where the model looks: radians around it. */
  #front = 0;
  /** Where the middle of the model is, but for the shift of the crowd. */
  readonly #place0 = new Vector3();
  #crowd: Crowd | undefined;
  #mixer: AnimationMixer | undefined;
  #played = 0;
  #isLent = false;

  /** @throws Error where the browser has no WebGL 2. */
  constructor(canvas: HTMLCanvasElement) {
    this.#canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: true });
    // Checking for errors waits for each shader to compile: seconds, on a slow machine.
    this.renderer.debug.checkShaderErrors = import.meta.env.DEV;
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.toneMappingExposure = 1.05;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.#studio = new Studio();
    this.#studio.stage.add(this.marks);

    // Before the controls, so that it sees pointers first.
    this.#pointing = new Pointing(
      canvas,
      (x, y) => this.pick(x, y),
      (turns) => this.#setTurning(turns),
    );
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.touches.TWO = TOUCH.DOLLY_ROTATE;
    this.#controls.enableDamping = true;
    this.#controls.dampingFactor = 0.12;
    this.#controls.autoRotateSpeed = 60 / kTurnSeconds;
    this.#controls.zoomToCursor = true;
    this.#controls.maxTargetRadius = 1; // inside the model
    this.#controls.minDistance = 0.8;
    this.#controls.maxDistance = kFar;
    this.#controls.maxPolarAngle = MathUtils.degToRad(150);
    this.#controls.addEventListener('change', () => this.redraw());
    this.#controls.addEventListener('start', () => this.#markMoved());
    canvas.addEventListener('keydown', (event) => this.#onKey(event));
    canvas.addEventListener('webglcontextlost', () =>
      showError(
        'The browser has reset the graphics. The picture comes back by itself; if not, save the project and reload the page.',
      ),
    );
    canvas.addEventListener('webglcontextrestored', () => {
      clearError();
      this.redraw();
    });
    this.home();
    // Fires at once with the current size.
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement!);
    this.#watchRatio();
  }

  /** Shows another target; call `classify` next. Frees the previous one, unless it is the same. */
  setTarget(model: Model, projection: SplitProjection): void {
    this.highlight(undefined);
    this.#overlay?.dispose();
    if (model !== this.#model) this.#place(model);
    this.#overlay = new Overlay(model.mesh, projection, this.#paint);
    this.redraw();
  }

  /** Updates the projection of the current target, which has moved; call `classify` next. */
  move(projection: SplitProjection): void {
    if (!this.#overlay) return;
    this.highlight(undefined);
    this.#overlay.setProjection(projection);
    this.redraw();
  }

  /** Plays an animation of the target in place of the current one; undefined returns to the rest pose. */
  play(clip: AnimationClip | undefined): void {
    this.#mixer?.stopAllAction();
    this.#mixer = undefined;
    if (clip && this.#model) {
      this.#mixer = new AnimationMixer(this.#model.scene);
      this.#mixer.clipAction(clip).play();
      this.#played = performance.now();
    }
    this.redraw();
  }

  /** Highlights triangles of the target. @param marks 1 for each of them; undefined highlights none. */
  highlight(marks: Uint8Array | undefined): void {
    if (marks && this.#model) this.#highlight ??= new Highlight(this.#model.mesh, kHighlight, 0.5, 0.35);
    this.#highlight?.show(marks);
    this.redraw();
  }

  /** Sets the colours for the look `colors`. @param colors 3 bytes per triangle corner, sRGB. */
  setColors(colors: Uint8Array): void {
    this.#overlay?.setColors(colors);
    this.redraw();
  }

  /** Sets the texture of the look `checker`. */
  setChecker(checker: Texture): void {
    this.#overlay?.setChecker(checker);
    this.redraw();
  }

  /** The spot of the target at a position on the screen. @param x,y Client coordinates. */
  pick(x: number, y: number): Spot | undefined {
    return this.#model && pick(this.#model.mesh, this.eyeRay(x, y));
  }

  /** The ray from the eye through a position on the screen, in the studio. @param x,y Client coordinates. */
  eyeRay(x: number, y: number): Raycaster {
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    this.#camera.updateMatrixWorld(); // it may have moved since the last frame
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * (x - left)) / width - 1, 1 - (2 * (y - top)) / height), this.#camera);
    return ray;
  }

  /** Where a position of the target is on the screen, in client coordinates. */
  project(point: Vector3): { x: number; y: number } {
    this.#camera.updateMatrixWorld();
    this.marks.updateWorldMatrix(true, false);
    const { x, y } = this.marks.localToWorld(point.clone()).project(this.#camera);
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    return { x: left + ((1 + x) / 2) * width, y: top + ((1 - y) / 2) * height };
  }

  /** The ray through a position on the screen, in the target's space. @param x,y Client coordinates. */
  rayAt(x: number, y: number): Ray {
    this.marks.updateWorldMatrix(true, false);
    return this.eyeRay(x, y).ray.applyMatrix4(this.marks.matrixWorld.clone().invert());
  }

  /** Screen pixels per unit of length of the target. @param seen A position in the studio, as in `Spot`. */
  pixelsAt(seen: Vector3): number {
    const depth = seen.clone().applyMatrix4(this.#camera.matrixWorldInverse).z;
    return (
      (this.#studio.stage.scale.x * this.#canvas.clientHeight) /
      (-2 * depth * Math.tan(MathUtils.degToRad(kFieldOfView / 2)))
    );
  }

  /** Where points of the target are seen, in pixels from the upper left corner of the view. */
  toStage(points: readonly Vector3[]): { x: number; y: number }[] {
    const { clientWidth, clientHeight } = this.#canvas;
    this.#camera.updateMatrixWorld();
    return points.map((point) => {
      const { x, y } = this.#studio.stage.localToWorld(point.clone()).project(this.#camera);
      return { x: ((x + 1) / 2) * clientWidth, y: ((1 - y) / 2) * clientHeight };
    });
  }

  /** Whether a surface of the target faces the camera. */
  faces(point: Vector3, normal: Vector3): boolean {
    return this.#studio.stage.worldToLocal(this.#camera.position.clone()).sub(point).dot(normal) > 0;
  }

  /** The direction of the view's upper edge, in the target's space. */
  get up(): Vector3 {
    return new Vector3().setFromMatrixColumn(this.#camera.matrixWorld, 1);
  }

  /** The centre of the free part of the view, in client coordinates. */
  get center(): { x: number; y: number } {
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    return { x: left + width / 2, y: top + (height + this.#free.top - this.#free.bottom) / 2 };
  }

  /** Whether other models are shown beside the one on the stage. */
  get showsCrowd(): boolean {
    return this.#crowd !== undefined;
  }

  /** Shows other models beside the one on the stage; undefined shows it alone. Call it again when the crowd has changed. */
  setCrowd(crowd: Crowd | undefined): void {
    const isOther = crowd !== this.#crowd;
    if (isOther) this.#crowd?.object.removeFromParent();
    this.#crowd = crowd;
    if (crowd) this.#studio.scene.add(crowd.object);
    this.#studio.showFloor(!crowd);
    this.#controls.maxDistance = crowd ? kFarthest : kFar;
    this.#controls.enablePan = this.#controls.zoomToCursor = !crowd;
    this.#far = this.#fullDistance;
    if (isOther || !this.#moved) this.home();
    else this.redraw();
  }

  /** Draws a small picture of each of some models, alone, and then all as before. @returns Addresses of the pictures. */
  takePictures(sitters: readonly Sitter[], pixels: number): string[] {
    for (const prepare of this.#preparations) prepare();
    const { stage } = this.#studio;
    const { clientWidth, clientHeight } = this.#canvas;
    const ratio = this.renderer.getPixelRatio();
    if (this.#crowd) this.#crowd.object.visible = false;
    this.#cage?.show(false);
    this.marks.visible = false;
    this.#studio.showFloor(false);
    stage.position.copy(this.#place0);
    this.renderer.setScissorTest(false);
    this.renderer.setViewport(0, 0, pixels / ratio, pixels / ratio);
    const pictures = sitters.map((sitter) => this.#takePicture(sitter, pixels));
    this.renderer.setViewport(0, 0, clientWidth, clientHeight);
    stage.visible = true;
    this.marks.visible = true;
    if (this.#crowd) this.#crowd.object.visible = true;
    this.#studio.showFloor(!this.#crowd);
    this.#draw(); // now, or what was drawn for the pictures would be seen
    return pictures;
  }

  #takePicture({ holder, overlay = this.#overlay, front, look }: Sitter, pixels: number): string {
    const { stage, scene } = this.#studio;
    const camera = new PerspectiveCamera(kFieldOfView, 1, 0.05, 50);
    const distance = kPortrait / Math.sin(MathUtils.degToRad(kFieldOfView / 2));
    camera.position.setFromSphericalCoords(distance, kHome.phi, front + kHome.theta);
    camera.lookAt(0, 0, 0);
    stage.visible = !holder;
    const parent = holder?.parent;
    if (holder) scene.add(holder);
    holder?.position.set(0, 0, 0);
    holder?.rotation.set(0, 0, 0);
    overlay?.show(look);
    this.#studio.follow(camera);
    this.renderer.render(scene, camera);
    holder?.removeFromParent();
    if (holder) parent?.add(holder);
    const picture = document.createElement('canvas');
    picture.width = picture.height = pixels;
    const top = this.#canvas.height - pixels;
    picture.getContext('2d')!.drawImage(this.#canvas, 0, top, pixels, pixels, 0, 0, pixels, pixels);
    return picture.toDataURL();
  }

  /** Calls `prepare` before each frame, to update textures. */
  beforeDraw(prepare: () => void): void {
    this.#preparations.push(prepare);
  }

  /** Sets the tool for the pointer; undefined turns the model. */
  setTool(tool: Tool | undefined): void {
    this.#pointing.tool = tool;
    if (tool) this.sway(false);
  }

  /** Sets what taps are for while the pointer turns the model. */
  setIdleTool(tool: Pick<Tool, 'tap'>): void {
    this.#pointing.idle = tool;
  }

  get hasTool(): boolean {
    return this.#pointing.tool !== undefined;
  }

  /** Shows another cage, in the space of the target. */
  setCage(model: Model): void {
    this.#cage?.dispose();
    this.#cage = new CageLines(model.mesh);
    this.#studio.stage.add(this.#cage.object);
    this.redraw();
  }

  /** Shows the cage where its vertices are now. */
  followCage(): void {
    this.#cage?.update();
    this.redraw();
  }

  /** Shows the cage moved; it stays where it is. */
  moveCage(matrix: Matrix4): void {
    if (!this.#cage) return;
    this.#cage.object.matrixAutoUpdate = false;
    this.#cage.object.matrix.copy(matrix);
    this.redraw();
  }

  /** Sets the paint. If it is a render target's texture, call `redraw` after it changed. */
  setPaint(paint: Texture): void {
    this.#paint = paint;
    this.#overlay?.setPaint(paint);
    this.redraw();
  }

  /** Shows the zones. */
  classify(classification: Classification): void {
    this.#overlay?.classify(classification);
    this.redraw();
  }

  /** Shows the cut target until it moves or is replaced; undefined shows its own triangles. */
  async setCut(cut: CutTarget | undefined): Promise<void> {
    await this.#overlay?.setCut(cut);
    this.redraw();
  }

  setView(view: View): void {
    this.#view = view;
    this.#studio.setLight(view.light);
    this.#studio.setBackground(view.background);
    this.redraw();
  }

  /** Turns the model round and round, but for while the user turns it. */
  set turntable(on: boolean) {
    this.sway(false);
    this.#controls.autoRotate = on;
    this.redraw();
  }

  /** Lends what is on the stage, painted, to be drawn by `renderer`; nothing is drawn here until it is given back. */
  lend(): Lent {
    for (const prepare of this.#preparations) prepare();
    const { stage, scene } = this.#studio;
    this.#isLent = true;
    this.renderer.setScissorTest(false);
    this.renderer.shadowMap.needsUpdate = true;
    this.#overlay?.show('result');
    this.#cage?.show(false);
    this.marks.visible = false;
    stage.position.copy(this.#place0);
    const giveBack = (): void => {
      scene.add(stage);
      this.marks.visible = true;
      this.#isLent = false;
      this.#resize();
    };
    return { stage, model: this.#model!.scene, front: this.#front, environment: scene.environment, giveBack };
  }

  /** What is seen, without controls, as a PNG. @throws Error if the browser cannot draw or encode it. */
  async picture(): Promise<Blob> {
    requireGraphics(this.renderer);
    const ratio = this.renderer.getPixelRatio();
    this.renderer.setPixelRatio(Math.max(ratio, kPicturePixels));
    this.#draw();
    const blob = await new Promise<Blob | null>((done) => this.#canvas.toBlob(done));
    this.renderer.setPixelRatio(ratio);
    this.#draw();
    if (!blob) throw new Error('the browser cannot encode the picture');
    return blob;
  }

  /** Switches the idle rotation, which ends when the user moves the camera. */
  sway(on: boolean): void {
    if (on === (this.#swayed !== undefined)) return;
    this.#swayed = on ? 0 : undefined;
    this.redraw();
  }

  /** Resets the camera to show the whole model. */
  home(): void {
    this.#moved = false;
    this.#look({ phi: kHome.phi, theta: this.#front + kHome.theta, radius: this.#fullDistance }, kMiddle);
  }

  /** Shows the whole model from its front or its side, or as large as it fits from where the camera is. */
  face(side: 'front' | 'side' | 'fit'): void {
    this.#markMoved();
    const angle = this.#orbit;
    if (side !== 'fit') angle.set(1, kLevel, this.#front + (side === 'side' ? Math.PI / 2 : 0));
    const radius = fittingDistance(this.#free, kFieldOfView, this.#pointsFrom(angle), angle, true);
    this.#look({ phi: angle.phi, theta: angle.theta, radius }, kMiddle);
  }

  /** The camera angle chosen by the user; undefined by default. */
  get angle(): Angle | undefined {
    if (!this.#moved) return undefined;
    const { radius, phi, theta } = this.#orbit;
    return { turn: MathUtils.radToDeg(theta), tilt: MathUtils.radToDeg(phi), near: this.#fullDistance / radius };
  }

  /** Sets the camera angle, within the limits of the controls. */
  lookFrom({ turn, tilt, near }: Angle): void {
    this.#markMoved();
    const [phi, theta] = [MathUtils.degToRad(tilt), MathUtils.degToRad(turn)];
    this.#look({ radius: this.#fullDistance / near, phi, theta }, kMiddle);
  }

  /** Where the camera is, from what it looks at. */
  get #orbit(): Spherical {
    return new Spherical().setFromVector3(this.#camera.position.clone().sub(this.#controls.target));
  }

  /** The distance at which the whole model is visible. */
  get #fullDistance(): number {
    const home = new Spherical(1, kHome.phi, this.#front + kHome.theta);
    return fittingDistance(this.#free, kFieldOfView, this.#pointsFrom(home), home, this.#crowd !== undefined);
  }

  /** What is to be in the view. */
  #pointsFrom({ theta }: Spherical): Float32Array {
    return this.#crowd?.extent(theta, aspectOf(this.#free)) ?? this.#points;
  }

  /** Looks at the middle of a crowd from afar, and at the model on the stage from near. */
  #shift(): void {
    const { stage } = this.#studio;
    stage.position.copy(this.#place0);
    if (!this.#crowd) return;
    const { radius, theta } = this.#orbit;
    const near = Math.min(kNear, this.#far / 2);
    const share = MathUtils.smoothstep(radius, near, 0.9 * this.#far);
    const middle = this.#crowd.middle(theta).multiplyScalar(-share);
    stage.position.add(middle);
    this.#crowd.object.position.copy(middle);
    this.#crowd.face(this.#camera);
  }

  /** The user moves the camera from now on. */
  #markMoved(): void {
    this.sway(false);
    this.#moved = true;
  }

  #place(model: Model): void {
    this.play(undefined);
    if (this.#model) {
      this.#highlight?.dispose();
      this.#highlight = undefined;
      this.#model.scene.removeFromParent();
      disposeModel(this.#model);
    }
    this.#model = model;
    const { stage } = this.#studio;
    const box = new Box3().setFromObject(model.scene, true);
    const size = box.getSize(new Vector3());
    const scale = 2 / Math.max(size.length(), Number.MIN_VALUE);
    stage.scale.setScalar(scale);
    stage.position.copy(box.getCenter(this.#place0).multiplyScalar(-scale));
    stage.add(model.scene);
    model.scene.traverse((object) => {
      if (object instanceof Mesh) object.castShadow = object.receiveShadow = true;
    });
    this.#studio.setFloor((-size.y * scale) / 2);
    this.#points = model.mesh.positions.map((value, i) => scale * value + stage.position.getComponent(i % 3));
    this.#front = frontOf(model);
    if (this.#crowd) return; // which is arranged anew next
    this.#far = this.#fullDistance;
    this.home();
  }

  /** @param target What is looked at, in the studio. */
  #look({ radius, phi, theta }: Pick<Spherical, 'radius' | 'phi' | 'theta'>, target = this.#controls.target): void {
    this.#withoutDamping(() => {
      this.#controls.target.copy(target);
      this.#camera.position.setFromSphericalCoords(radius, phi, theta).add(target);
      this.#controls.update();
    });
  }

  /** Sets whether one finger or the main button turns the model; two fingers always do. */
  #setTurning(turns: boolean): void {
    this.#controls.touches.ONE = turns ? TOUCH.ROTATE : null;
    this.#controls.mouseButtons.LEFT = turns ? MOUSE.ROTATE : null;
  }

  /** Moves the camera without damping, and ends a glide in progress. */
  #withoutDamping(move: () => void): void {
    this.#controls.enableDamping = false;
    this.#controls.update(); // otherwise the rest of the glide would be added to the move
    move();
    this.#controls.enableDamping = true;
    this.redraw();
  }

  #onKey(event: KeyboardEvent): void {
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.#controls.rotateLeft(kKeyStep),
      ArrowRight: () => this.#controls.rotateLeft(-kKeyStep),
      ArrowUp: () => this.#controls.rotateUp(kKeyStep),
      ArrowDown: () => this.#controls.rotateUp(-kKeyStep),
      '+': () => this.#controls.dollyIn(kKeyNearer),
      '=': () => this.#controls.dollyIn(kKeyNearer),
      '-': () => this.#controls.dollyOut(kKeyNearer),
      'Shift ArrowLeft': () => this.#controls.pan(kKeyMove, 0),
      'Shift ArrowRight': () => this.#controls.pan(-kKeyMove, 0),
      'Shift ArrowUp': () => this.#controls.pan(0, kKeyMove),
      'Shift ArrowDown': () => this.#controls.pan(0, -kKeyMove),
      Home: () => this.home(),
      '0': () => this.face('fit'),
      '1': () => this.face('front'),
      '2': () => this.face('side'),
    };
    const action = actions[event.shiftKey && event.key.startsWith('Arrow') ? `Shift ${event.key}` : event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.#markMoved();
    this.#withoutDamping(action);
  }

  /** On another screen the page may have other pixels, but the same size. */
  #watchRatio(): void {
    this.#resize();
    const pixels = matchMedia(`(resolution: ${devicePixelRatio}dppx)`);
    pixels.addEventListener('change', () => this.#watchRatio(), { once: true });
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#canvas.parentElement!;
    if (width === 0 || height === 0 || this.#isLent) return;
    const before = this.#camera.aspect;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#free = freePartOf(this.#canvas);
    // Centre the model in the free part.
    this.#camera.setViewOffset(width, height, 0, (this.#free.bottom - this.#free.top) / 2, width, height);
    const far = this.#far;
    this.#far = this.#fullDistance;
    // Such as when a phone hides its address bar: keep the user's angle and magnification.
    if (this.#moved) {
      const { radius, phi, theta } = this.#orbit;
      this.#look({ radius: (radius * this.#far) / far, phi, theta });
    } else if (before !== this.#camera.aspect) this.home();
    // Resizing cleared the canvas: draw now to avoid flicker.
    this.#draw();
  }

  /** Waits until all requested changes are drawn. */
  async drawn(): Promise<void> {
    const frame = (): Promise<unknown> => new Promise((done) => requestAnimationFrame(done));
    await frame();
    await frame();
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    // A lost context cannot sync, and draws nothing.
    if (!sync) return;
    gl.flush();
    while (gl.getSyncParameter(sync, gl.SYNC_STATUS) === gl.UNSIGNALED) await frame();
    gl.deleteSync(sync);
  }

  /** Requests a new frame. */
  redraw(): void {
    this.#stale = true;
    this.#frame ||= requestAnimationFrame((now) => this.#onFrame(now));
  }

  #onFrame(now: number): void {
    this.#frame = 0;
    if (this.#swayed !== undefined && this.#model) {
      // Starts with the first frame.
      if (this.#drawn > 0) this.#swayed += Math.min(kLongestFrame, Math.max(0, now - this.#drawn) / 1000);
      this.#drawn = now;
      const phase = Math.sin(this.#swayed * ((2 * Math.PI) / kSwaySeconds));
      const { radius, phi } = this.#orbit;
      this.#look({ radius, phi, theta: this.#front + kHome.theta - kSway * phase });
    }
    if (this.#mixer) {
      this.#mixer.update(Math.max(0, now - this.#played) / 1000);
      this.#played = now;
      this.redraw();
    }
    // Damping goes on for a few frames after a drag; each change requests the next frame.
    this.#controls.update(this.#controls.autoRotate ? Math.min(kLongestFrame, (now - this.#turned) / 1000) : null);
    this.#turned = now;
    if (this.#stale) this.#draw();
  }

  #draw(): void {
    this.#stale = false;
    if (!this.#model || this.#isLent) return; // an empty scene is not worth drawing
    for (const prepare of this.#preparations) prepare();
    const { mode, split, paint, cage } = this.#view;
    this.#shift();
    this.#studio.follow(this.#camera, this.#crowd?.object.position);
    this.#cage?.show(cage);
    const draw = (look: Look, from: number, to: number): void => {
      const { clientWidth: width, clientHeight: height } = this.#canvas;
      this.renderer.setScissor(from * width, 0, (to - from) * width, height);
      this.#overlay?.show(look);
      this.#crowd?.show(look);
      this.renderer.render(this.#studio.scene, this.#camera);
    };
    // The light moved with the camera. Both sides of the divider share its shadow.
    this.renderer.shadowMap.needsUpdate = true;
    this.renderer.setScissorTest(true);
    const look = (side: keyof typeof kLooks): Look => (paint || !showsPaint(side) ? kLooks[side] : 'bare');
    if (mode !== 'compare') draw(look(mode), 0, 1);
    else {
      if (split > 0) draw(look('naive'), 0, split);
      if (split < 1) draw(look('result'), split, 1);
    }
  }
}
