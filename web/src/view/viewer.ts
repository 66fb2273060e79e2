import type { Classification } from 'cagecast';
import type { CutTarget } from 'cagecast/borders';
import {
  type AnimationClip,
  AnimationMixer,
  Box3,
  Group,
  MathUtils,
  Mesh,
  MOUSE,
  NeutralToneMapping,
  PCFShadowMap,
  PerspectiveCamera,
  Spherical,
  type Texture,
  TOUCH,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { disposeModel, type Model } from '../scene/load';
import type { Placed } from '../scene/transfer-messages';
import { CageLines } from './cage-lines';
import { Highlight } from './highlight';
import { type Look, Overlay } from './overlay';
import { pick, type Spot } from './pick';
import { Pointing, type Tool } from './pointing';
import { Studio } from './studio';
import { type Angle, kFirstView, kLooks, showsPaint, type View } from './view';

const kFieldOfView = 28; // degrees
const kHome = new Spherical(1, MathUtils.degToRad(80), MathUtils.degToRad(14));
const kFill = 0.86; // below 1, as models seldom reach into the corners of their box
const kToolbar = 96; // pixels of the picture's lower edge that controls lie on
const kSway = MathUtils.degToRad(40); // how far the model turns to either side
const kSwaySeconds = 16; // there and back
const kLongestFrame = 0.25; // seconds that a model turns on in one frame, however long that took: it must not jump
const kKeyStep = MathUtils.degToRad(6);
const kKeyNearer = 1 / 1.1; // of the distance

/** Shows one target with its paint and its cage on a canvas, and lets people turn it. Draws only when something changed. */
export class Viewer {
  /** Draws the picture; features may draw textures with it, and call `redraw` when what is shown has changed. */
  readonly renderer: WebGLRenderer;
  /** What features add to the picture, in the space of the target as it was transferred. */
  readonly marks = new Group();
  readonly #canvas: HTMLCanvasElement;
  readonly #studio: Studio;
  readonly #camera = new PerspectiveCamera(kFieldOfView, 1, 0.05, 50);
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
  /** Seconds that the model has turned by itself; undefined when it does not. */
  #turned: number | undefined;
  #drawn = 0;
  /** Whether it is looked at from where the visitor said. */
  #taken = false;
  /** From how far away all of it is seen, in a picture as large as it was last. */
  #far = 1;
  #mixer: AnimationMixer | undefined;
  #played = 0;

  /** @throws Error where the browser has no WebGL 2. */
  constructor(canvas: HTMLCanvasElement) {
    this.#canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: true });
    // Asking for each shader's log waits until it is compiled: seconds, on a slow machine.
    this.renderer.debug.checkShaderErrors = import.meta.env.DEV;
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.toneMappingExposure = 1.05;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.#studio = new Studio();
    this.#studio.stage.add(this.marks);

    // Before the controls, which get what it leaves to them.
    this.#pointing = new Pointing(
      canvas,
      (x, y) => this.pick(x, y),
      (turns) => this.#leave(turns),
    );
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.touches.TWO = TOUCH.DOLLY_ROTATE;
    this.#controls.enableDamping = true;
    this.#controls.dampingFactor = 0.12;
    this.#controls.enablePan = false;
    this.#controls.minDistance = 0.8;
    this.#controls.maxDistance = 12;
    this.#controls.maxPolarAngle = MathUtils.degToRad(150);
    this.#controls.addEventListener('change', () => this.redraw());
    this.#controls.addEventListener('start', () => this.#take());
    canvas.addEventListener('keydown', (event) => this.#onKey(event));
    canvas.addEventListener('webglcontextrestored', () => this.redraw());
    this.home();
    // Tells the size at once.
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement!);
  }

  /** Shows another target; call `classify` for its zones. The one before it is freed, unless it is the same. */
  setTarget(model: Model, projection: Placed): void {
    this.highlight([]);
    this.#overlay?.dispose();
    if (model !== this.#model) this.#place(model);
    this.#overlay = new Overlay(model.mesh, projection, this.#paint);
    this.redraw();
  }

  /** Shows the target that is shown as it has moved since, with its new place on the cage; call `classify` for its zones. */
  move(projection: Placed): void {
    if (!this.#overlay) return;
    this.highlight([]);
    this.#overlay.lay(projection);
    this.redraw();
  }

  /** Plays an animation of the target, paint and all, in place of the one before; without one it goes back to rest. */
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

  /** Lights up triangles of the target, in place of those before. */
  highlight(triangles: readonly number[]): void {
    if (triangles.length === 0 && !this.#highlight) return;
    this.#highlight?.dispose();
    this.#highlight = triangles.length > 0 && this.#model ? new Highlight(this.#model.mesh, triangles) : undefined;
    this.redraw();
  }

  /** Colours the target for the modes that show colours of their own. @param colors 3 bytes per triangle corner, sRGB. */
  setTint(colors: Uint8Array): void {
    this.#overlay?.setTint(colors);
    this.redraw();
  }

  /** Shows another texture in the mode that lays one over all of the target, painted or not. */
  setChecker(checker: Texture): void {
    this.#overlay?.setChecker(checker);
    this.redraw();
  }

  /** What of the target is seen at a place on the screen. @param x,y As in a pointer's event: `clientX`, `clientY`. */
  pick(x: number, y: number): Spot | undefined {
    if (!this.#model) return undefined;
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    this.#camera.updateMatrixWorld(); // it may have moved since the last picture
    return pick(
      this.#model.mesh,
      this.#camera,
      new Vector2((2 * (x - left)) / width - 1, 1 - (2 * (y - top)) / height),
    );
  }

  /** How many pixels of the screen a length of 1 in the target's space takes. @param seen Where, in the studio: as a `Spot` has it. */
  pixelsAt(seen: Vector3): number {
    const depth = seen.clone().applyMatrix4(this.#camera.matrixWorldInverse).z;
    return (
      (this.#studio.stage.scale.x * this.#canvas.clientHeight) /
      (-2 * depth * Math.tan(MathUtils.degToRad(kFieldOfView / 2)))
    );
  }

  /** Where the picture's upper edge is, as a direction of the target's space. */
  get up(): Vector3 {
    return new Vector3().setFromMatrixColumn(this.#camera.matrixWorld, 1);
  }

  /** The place on the screen that the model stands at, as `pick` takes it. */
  get middle(): { x: number; y: number } {
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    return { x: left + width / 2, y: top + (height - kToolbar) / 2 };
  }

  /** Calls `prepare` before each picture is drawn: to bring textures up to date. */
  beforeDraw(prepare: () => void): void {
    this.#preparations.push(prepare);
  }

  /** Hands the pointer to a tool; what the tool leaves alone turns the model. Without one everything does. */
  setTool(tool: Tool | undefined): void {
    this.#pointing.tool = tool;
    if (tool) this.turn(false);
  }

  /** Shows another cage, in the space of the target. */
  setCage(model: Model): void {
    this.#cage?.dispose();
    this.#cage = new CageLines(model.mesh);
    this.#studio.stage.add(this.#cage.object);
    this.redraw();
  }

  /** Shows another paint. It may be a render target's texture: call `redraw` when that was drawn anew. */
  setPaint(paint: Texture): void {
    this.#paint = paint;
    this.#overlay?.setPaint(paint);
    this.redraw();
  }

  /** Shows the decision for another threshold. */
  classify(classification: Classification): void {
    this.#overlay?.classify(classification);
    this.redraw();
  }

  /** Shows the target as it was cut, until it moves or another is shown; without one its own triangles again. */
  async setCut(cut: CutTarget | undefined): Promise<void> {
    await this.#overlay?.setCut(cut);
    this.redraw();
  }

  setView(view: View): void {
    this.#view = view;
    this.redraw();
  }

  /** Turns the model slowly to and fro, until it is touched. */
  turn(on: boolean): void {
    if (on === (this.#turned !== undefined)) return;
    this.#turned = on ? 0 : undefined;
    this.redraw();
  }

  /** Looks at the model from where it is seen best, all of it. */
  home(): void {
    this.#taken = false;
    this.#look({ ...kHome, radius: this.#farness });
  }

  /** Where the visitor looks at the model from; undefined until it was turned. */
  get angle(): Angle | undefined {
    if (!this.#taken) return undefined;
    const { radius, phi, theta } = new Spherical().setFromVector3(this.#camera.position);
    return { turn: MathUtils.radToDeg(theta), tilt: MathUtils.radToDeg(phi), near: this.#farness / radius };
  }

  /** Looks at the model from there, as far as one can. */
  lookFrom({ turn, tilt, near }: Angle): void {
    this.#take();
    this.#look({ radius: this.#farness / near, phi: MathUtils.degToRad(tilt), theta: MathUtils.degToRad(turn) });
  }

  /** How far away all of the model is seen. */
  get #farness(): number {
    // A tall picture is narrow: there the width decides.
    const half = MathUtils.degToRad(kFieldOfView / 2);
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    const free = Math.max(1, height - kToolbar);
    const narrow = Math.atan((Math.tan(half) * Math.min(free, width)) / Math.max(1, height));
    return kFill / Math.sin(narrow);
  }

  /** It is turned by the visitor from now on. */
  #take(): void {
    this.turn(false);
    this.#taken = true;
  }

  #place(model: Model): void {
    this.play(undefined);
    if (this.#model) {
      this.#model.scene.removeFromParent();
      disposeModel(this.#model);
    }
    this.#model = model;
    const { stage } = this.#studio;
    const box = new Box3().setFromObject(model.scene, true);
    const size = box.getSize(new Vector3());
    const scale = 2 / Math.max(size.length(), Number.MIN_VALUE);
    stage.scale.setScalar(scale);
    box.getCenter(stage.position).multiplyScalar(-scale);
    stage.add(model.scene);
    model.scene.traverse((object) => {
      if (object instanceof Mesh) object.castShadow = object.receiveShadow = true;
    });
    this.#studio.setFloor((-size.y * scale) / 2);
    this.home();
  }

  #look({ radius, phi, theta }: Pick<Spherical, 'radius' | 'phi' | 'theta'>): void {
    this.#camera.position.setFromSphericalCoords(radius, phi, theta);
    this.#atOnce(() => this.#controls.update());
  }

  /** Lets one finger, or the main button, turn the model, or nothing; two fingers do always. */
  #leave(turns: boolean): void {
    this.#controls.touches.ONE = turns ? TOUCH.ROTATE : null;
    this.#controls.mouseButtons.LEFT = turns ? MOUSE.ROTATE : null;
  }

  /** Moves the camera without the glide of a drag, and ends one under way. */
  #atOnce(move: () => void): void {
    this.#controls.enableDamping = false;
    this.#controls.update(); // what is left of the glide, or it would be added to the move
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
      Home: () => this.home(),
    };
    const action = actions[event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.#take();
    this.#atOnce(action);
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#canvas.parentElement!;
    if (width === 0 || height === 0) return;
    const before = this.#camera.aspect;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    // The model stands in the middle of what the toolbar leaves free.
    this.#camera.setViewOffset(width, height, 0, kToolbar / 2, width, height);
    const far = this.#far;
    this.#far = this.#farness;
    // As when a phone hides its address bar: the visitor's view stays, and as much of the model in it.
    if (this.#taken) {
      const { radius, phi, theta } = new Spherical().setFromVector3(this.#camera.position);
      this.#look({ radius: (radius * this.#far) / far, phi, theta });
    } else if (before !== this.#camera.aspect) this.home();
    // At once: the canvas was cleared, and a frame's wait would flicker.
    this.#draw();
  }

  /** Waits until what was asked for so far is drawn. */
  async drawn(): Promise<void> {
    const frame = (): Promise<unknown> => new Promise((done) => requestAnimationFrame(done));
    await frame();
    await frame();
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    // A context that was lost has none, and draws no more.
    if (!sync) return;
    gl.flush();
    while (gl.getSyncParameter(sync, gl.SYNC_STATUS) === gl.UNSIGNALED) await frame();
    gl.deleteSync(sync);
  }

  /** Asks for a new picture in the next frame. */
  redraw(): void {
    this.#stale = true;
    this.#frame ||= requestAnimationFrame((now) => this.#onFrame(now));
  }

  #onFrame(now: number): void {
    this.#frame = 0;
    if (this.#turned !== undefined && this.#model) {
      // From the first picture on.
      if (this.#drawn > 0) this.#turned += Math.min(kLongestFrame, Math.max(0, now - this.#drawn) / 1000);
      this.#drawn = now;
      const phase = Math.sin(this.#turned * ((2 * Math.PI) / kSwaySeconds));
      const { radius, phi } = new Spherical().setFromVector3(this.#camera.position);
      this.#look({ radius, phi, theta: kHome.theta - kSway * phase });
    }
    if (this.#mixer) {
      this.#mixer.update(Math.max(0, now - this.#played) / 1000);
      this.#played = now;
      this.redraw();
    }
    // Glides on for a few frames after a drag; each change asks for the next frame.
    this.#controls.update();
    if (this.#stale) this.#draw();
  }

  #draw(): void {
    this.#stale = false;
    if (!this.#model) return; // an empty room takes as long to draw as a full one
    for (const prepare of this.#preparations) prepare();
    const { mode, split, paint, cage } = this.#view;
    this.#studio.follow(this.#camera);
    this.#cage?.show(cage);
    const draw = (look: Look, from: number, to: number): void => {
      const { clientWidth: width, clientHeight: height } = this.#canvas;
      this.renderer.setScissor(from * width, 0, (to - from) * width, height);
      this.#overlay?.show(look);
      this.renderer.render(this.#studio.scene, this.#camera);
    };
    // The light moved with the camera; its shadow is the same on both sides of the line.
    this.renderer.shadowMap.needsUpdate = true;
    this.renderer.setScissorTest(true);
    const look = (side: keyof typeof kLooks): Look => (paint || !showsPaint(side) ? kLooks[side] : 'bare');
    if (mode !== 'compare') return draw(look(mode), 0, 1);
    if (split > 0) draw(look('naive'), 0, split);
    if (split < 1) draw(look('result'), split, 1);
  }
}
