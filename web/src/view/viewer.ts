import { NeutralToneMapping, PCFShadowMap, Vector2, Vector3, WebGLRenderer } from 'three';
import { clearError, showError } from '../platform/page';
import type { Model } from '../state/model';
import type { SplitProjection } from '../state/transfers';
import { kFirstView, type View } from '../state/view-state';
import { CameraControls } from './camera-controls';
import { type Crowd, type FreePart, freePartOf } from './framing';
import { type Look, sidesOf } from './overlay/looks';
import { Pointing } from './pointing';
import { ScreenSpace } from './screen-space';
import { Stage } from './stage';
import { Studio } from './studio';

const kPictureSize = 0.9; // of the view's shorter side

/** How frames are drawn to be saved, whatever the size of the page. */
interface Pose {
  /** Its size is that of the frames, in units of `ratio` pixels. */
  free: FreePart;
  ratio: number;
  view: View;
  /** Called after each frame. */
  onDrawn(): void;
}

/** Draws what is on the stage whenever something has changed. */
export class Viewer {
  /** Features may use it to render textures. Call `redraw` afterwards. */
  readonly renderer: WebGLRenderer;
  readonly studio = new Studio();
  readonly stage = new Stage(this.studio, () => this.redraw());
  readonly screen: ScreenSpace;
  readonly pointing: Pointing;
  readonly controls: CameraControls;
  readonly #canvas: HTMLCanvasElement;
  /** Controls that models keep clear of. */
  readonly #strips: readonly HTMLElement[];
  /** Stands on those at the lower edge. */
  readonly #bar: HTMLElement;
  #view = kFirstView;
  readonly #preparations: (() => void)[] = [];
  #frame = 0;
  #stale = true;
  #isLent = false;
  #pose: Pose | undefined;
  #looksAtFace = false;

  /** @throws Error where the browser has no WebGL 2. */
  constructor(canvas: HTMLCanvasElement) {
    this.#canvas = canvas;
    this.#strips = [
      ...canvas.parentElement!.querySelectorAll<HTMLElement>('.stage-head, .halves, .dock, .rail, .toolbar'),
    ];
    this.#bar = canvas.parentElement!.querySelector<HTMLElement>('.wardrobe-bar')!;
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: true });
    // Checking for errors waits for each shader to compile: seconds, on a slow machine.
    this.renderer.debug.checkShaderErrors = import.meta.env.DEV;
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.toneMappingExposure = 1.05;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;

    // Before the controls, so that it sees pointers first.
    this.pointing = new Pointing(
      canvas,
      (x, y) => this.screen.pick(x, y),
      (turns) => (this.controls.turning = turns),
    );
    this.controls = new CameraControls(canvas, this.stage, () => this.redraw());
    this.screen = new ScreenSpace(canvas, this.controls, this.stage);
    canvas.addEventListener('dblclick', ({ clientX, clientY }) => {
      const spot = this.pointing.tool ? undefined : this.screen.pick(clientX, clientY);
      if (spot) this.controls.lookCloser(spot.seen);
    });
    canvas.addEventListener('webglcontextlost', () =>
      showError(
        'The browser has reset the graphics. The picture comes back by itself; if not, save the project and reload the page.',
      ),
    );
    canvas.addEventListener('webglcontextrestored', () => {
      clearError();
      this.redraw();
    });
    // Fires at once with the current size.
    const observer = new ResizeObserver(() => this.#resize());
    for (const box of [canvas.parentElement!, this.#bar, ...this.#strips]) observer.observe(box);
    this.#watchRatio();
  }

  /** Shows another target from its front; call `stage.classify` next. Frees the previous one, unless it is the same. */
  setTarget(model: Model, projection: SplitProjection): void {
    const isOther = model !== this.stage.model;
    this.stage.setTarget(model, projection);
    // A crowd is arranged anew next.
    if (isOther && !this.stage.crowd) this.controls.home();
  }

  /** Shows other models beside the one on the stage; undefined shows it alone. Call it again when the crowd has changed. */
  setCrowd(crowd: Crowd | undefined): void {
    const isOther = crowd !== this.stage.crowd;
    this.stage.setCrowd(crowd);
    this.controls.followCrowd(isOther);
  }

  /** Looks at the face of the model on the stage, if it has one, until the user moves the camera. */
  async lookAtFace(on: boolean): Promise<void> {
    this.#looksAtFace = on;
    if (!on) return this.controls.closeUp(undefined);
    const face = await this.#face();
    if (this.#looksAtFace) this.controls.closeUp(face);
  }

  /** Shows the face of the model on the stage, or all of it. */
  async showFace(): Promise<void> {
    const points = (await this.#face())();
    if (points) this.controls.lookAt(points, this.stage.front);
    else this.controls.lookFromSide('front');
  }

  /** Corners around the face, in the studio. */
  async #face(): Promise<() => Vector3[] | undefined> {
    const { faceOf } = await import('./face-of');
    return () => {
      const { model, cage, object } = this.stage;
      return model && faceOf(model, cage)?.map((point) => object.localToWorld(point).sub(this.controls.shift)); // from near, it is in the middle
    };
  }

  setView(view: View): void {
    this.#view = view;
    this.studio.setLight(view.light);
    this.studio.setBackground(view.background);
    this.redraw();
  }

  /** Calls `prepare` before each frame, to update textures. */
  beforeDraw(prepare: () => void): void {
    this.#preparations.push(prepare);
  }

  /** Requests a new frame. */
  redraw(): void {
    this.#stale = true;
    this.#frame ||= requestAnimationFrame((now) => this.#onFrame(now));
  }

  #onFrame(now: number): void {
    this.#frame = 0;
    this.stage.animate(now);
    this.controls.update(now);
    if (this.#stale) this.draw();
  }

  /** Draws now. */
  draw(): void {
    this.#stale = false;
    const { stage, studio, renderer, controls } = this;
    const { camera } = controls;
    if (!stage.model || this.#isLent) return; // an empty scene is not worth drawing
    this.prepare();
    const { left, right, at, cage } = sidesOf(this.#pose?.view ?? this.#view);
    stage.arrange(camera, controls.shift, cage);
    studio.follow(camera, stage.crowd?.object.position);
    const { x, z } = camera.position;
    const middle = stage.crowd?.middle(Math.atan2(x, z)).add(stage.crowd.object.position);
    const wide = stage.crowd ? stage.crowd.floor : 1;
    studio.castShadow(renderer, wide, middle && new Vector3(middle.x, stage.crowd!.object.position.y, middle.z));
    const draw = (look: Look, from: number, to: number): void => {
      const { x: width, y: height } = renderer.getSize(new Vector2());
      renderer.setScissor(from * width, 0, (to - from) * width, height);
      stage.show(look);
      renderer.render(studio.scene, camera);
    };
    // The light moved with the camera. Both sides of the divider share its shadow.
    renderer.shadowMap.needsUpdate = true;
    renderer.setScissorTest(true);
    if (at > 0) draw(left, 0, at);
    if (at < 1) draw(right, at, 1);
    this.#pose?.onDrawn();
  }

  /** Draws now, and from now on, as a pose says. @returns Ends it. */
  hold(pose: Pose): () => void {
    const set = (pose?: Pose): void => {
      this.#pose = pose;
      this.#resize();
    };
    set(pose);
    return set;
  }

  /** Draws what would be seen in another view onto a canvas, cut to its shape. */
  picture(view: View, canvas: HTMLCanvasElement): void {
    const { width, height } = this.renderer.domElement;
    const size = Math.min(width, height) * kPictureSize;
    const [left, top] = [(width - size) / 2, (height - size) / 2];
    const before = this.#view;
    this.#view = view;
    this.draw();
    this.#view = before;
    const context = canvas.getContext('2d')!;
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.drawImage(this.renderer.domElement, left, top, size, size, 0, 0, canvas.width, canvas.height);
    this.redraw();
  }

  /** Updates textures, as before each frame. */
  prepare(): void {
    for (const prepare of this.#preparations) prepare();
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

  /**
   * Lends `renderer` and `stage.object`, painted, to draw it elsewhere; nothing is drawn here until it is given back.
   * @returns Gives it back.
   */
  lend(): () => void {
    const { stage, studio, renderer } = this;
    this.prepare();
    this.#isLent = true;
    renderer.setScissorTest(false);
    renderer.shadowMap.needsUpdate = true;
    stage.show('result');
    stage.isolate();
    return () => {
      studio.scene.add(stage.object);
      this.#isLent = false;
      this.#resize();
    };
  }

  /** On another screen the page may have other pixels, but the same size. */
  #watchRatio(): void {
    this.#resize();
    const pixels = matchMedia(`(resolution: ${devicePixelRatio}dppx)`);
    pixels.addEventListener('change', () => this.#watchRatio(), { once: true });
  }

  #resize(): void {
    const { clientWidth, clientHeight } = this.#canvas.parentElement!;
    if (clientWidth === 0 || clientHeight === 0 || this.#isLent) return;
    const pose = this.#pose;
    const ratio = pose?.ratio ?? Math.min(devicePixelRatio, 2);
    const before = this.renderer.getSize(new Vector2());
    const free = pose?.free ?? freePartOf(this.#canvas, this.#strips, this.#bar);
    const { width, height } = free;
    if (!pose && before.x === width && before.y === height && this.renderer.getPixelRatio() === ratio) {
      // Buffers of the same size would be made anew.
      this.controls.resize(width, height, free);
      this.redraw();
      return;
    }
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.controls.resize(width, height, free);
    // Resizing cleared the canvas: draw now to avoid flicker.
    this.draw();
  }
}
