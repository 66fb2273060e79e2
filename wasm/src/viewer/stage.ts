import {
  Box3,
  DirectionalLight,
  HemisphereLight,
  MathUtils,
  type Object3D,
  PerspectiveCamera,
  Scene,
  Sphere,
  Spherical,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

/** Where the camera is: angles in degrees, from the front and from above; the distance as a multiple of the one that shows all. */
export interface Orbit {
  azimuth: number;
  polar: number;
  distance: number;
}

export const defaultOrbit: Orbit = { azimuth: 20, polar: 80, distance: 1 };

/** A turn by an arrow key, in degrees, and a step towards the model, as a factor. */
const kTurn = 10;
const kStep = 0.9;

/** Draws a model on a canvas, when something has changed, and lets people turn it. */
export class Stage {
  readonly #canvas: HTMLCanvasElement;
  readonly #renderer: WebGLRenderer;
  readonly #camera = new PerspectiveCamera(35, 1, 0.01, 100);
  readonly #scene = new Scene();
  readonly #controls: OrbitControls;
  readonly #sizes: ResizeObserver;
  readonly #views: IntersectionObserver;
  /** Removes the listeners. */
  readonly #end = new AbortController();
  /** The distance from which all of the model is seen. */
  #whole = 1;
  #orbit = defaultOrbit;
  #model: Object3D | undefined;
  #frame = 0;
  #isInView = false;

  /**
   * @param onContext  Is told when the browser has taken the graphics context away, and when it is back.
   * @param onSight    Is told when it is seen, or no more: when the canvas comes into view, or the page is shown.
   * @throws Error if the host cannot draw.
   */
  constructor(canvas: HTMLCanvasElement, onContext: () => void, onSight: () => void) {
    this.#canvas = canvas;
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    const sun = new DirectionalLight(0xffffff, 2);
    sun.position.set(0.5, 1, 1);
    this.#camera.add(sun);
    this.#scene.add(this.#camera, new HemisphereLight(0xffffff, 0x888888, 1.5));
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enablePan = false;
    this.#controls.addEventListener('change', this.draw);
    const { signal } = this.#end;
    canvas.addEventListener('keydown', (event) => this.#turn(event), { signal });
    canvas.addEventListener('webglcontextlost', onContext, { signal });
    canvas.addEventListener('webglcontextrestored', onContext, { signal });
    canvas.addEventListener('webglcontextrestored', this.draw, { signal });
    this.#sizes = new ResizeObserver(() => this.#resize());
    this.#sizes.observe(canvas);
    this.#views = new IntersectionObserver((changes) => {
      this.#isInView = changes.at(-1)!.isIntersecting;
      onSight();
    });
    canvas.ownerDocument.addEventListener('visibilitychange', onSight, { signal });
    this.#views.observe(canvas);
    this.#watchRatio();
    this.#camera.aspect = canvas.width / canvas.height; // of an element that is not shown yet
    this.#resize();
  }

  /** Whether the browser has taken the graphics context away. */
  get isLost(): boolean {
    return this.#renderer.getContext().isContextLost();
  }

  /** Whether the canvas is in view, on a page that is shown. */
  get isSeen(): boolean {
    return this.#isInView && !this.#canvas.ownerDocument.hidden;
  }

  /** Shows a model instead of the one before, from where `orbit` says; without it, the same one again, from where the camera is. */
  show(model: Object3D, orbit: Orbit | undefined): void {
    this.clear();
    this.#model = model;
    this.#scene.add(model);
    if (!orbit) return;
    const { center, radius } = new Box3().setFromObject(model).getBoundingSphere(new Sphere());
    this.#controls.target.copy(center);
    this.#whole = (radius || 1) / Math.sin(MathUtils.degToRad(this.#camera.fov) / 2);
    this.#camera.near = this.#whole / 100;
    this.#camera.far = this.#whole * 20;
    this.place(orbit);
  }

  /** Shows nothing. */
  clear(): void {
    if (this.#model) this.#scene.remove(this.#model);
    this.#model = undefined;
    this.draw();
  }

  place(orbit: Orbit): void {
    this.#orbit = orbit;
    const { azimuth, polar, distance } = orbit;
    const [from, down] = [MathUtils.degToRad(azimuth), MathUtils.degToRad(MathUtils.clamp(polar, 0.1, 179.9))];
    const place = new Spherical((this.#whole * distance) / this.#narrow, down, from);
    this.#camera.position.setFromSpherical(place).add(this.#controls.target);
    this.#camera.updateProjectionMatrix();
    this.#controls.update();
    this.draw();
  }

  /** In the next frame. */
  readonly draw = (): void => {
    this.#frame ||= requestAnimationFrame(() => this.drawNow());
  };

  drawNow(): void {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    this.#renderer.render(this.#scene, this.#camera);
  }

  /** Ends drawing and frees the graphics context. */
  dispose(): void {
    cancelAnimationFrame(this.#frame);
    this.#end.abort();
    this.#sizes.disconnect();
    this.#views.disconnect();
    this.#controls.dispose();
    this.#renderer.dispose();
    this.#renderer.forceContextLoss();
  }

  /** How much nearer the sides of the view are than its upper and lower edge. */
  get #narrow(): number {
    return Math.min(1, this.#camera.aspect);
  }

  /** A page that is zoomed, or moved to another screen, has other pixels; the element's size may stay. */
  #watchRatio(): void {
    const onChange = (): void => {
      this.#watchRatio();
      this.#resize();
    };
    const { signal } = this.#end;
    matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener('change', onChange, { once: true, signal });
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (width === 0 || height === 0) return;
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#renderer.setSize(width, height, false);
    const narrow = this.#narrow;
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    // As much of the model is seen as before.
    const { target } = this.#controls;
    this.#camera.position
      .sub(target)
      .multiplyScalar(narrow / this.#narrow)
      .add(target);
    this.#controls.update();
    // What was drawn is gone; the observer runs before the frame is shown.
    this.drawNow();
  }

  #turn(event: KeyboardEvent): void {
    const { key, ctrlKey, metaKey, altKey } = event;
    if (ctrlKey || metaKey || altKey) return; // the browser's own
    const place = new Spherical().setFromVector3(this.#camera.position.clone().sub(this.#controls.target));
    const turn = MathUtils.degToRad(kTurn);
    if (key === 'ArrowLeft') place.theta -= turn;
    else if (key === 'ArrowRight') place.theta += turn;
    else if (key === 'ArrowUp') place.phi -= turn;
    else if (key === 'ArrowDown') place.phi += turn;
    else if (key === '+' || key === '=') place.radius *= kStep;
    else if (key === '-') place.radius /= kStep;
    else if (key !== 'Home') return;
    event.preventDefault(); // of scrolling the page
    if (key === 'Home') {
      this.place(this.#orbit);
      return;
    }
    this.#camera.position.setFromSpherical(place.makeSafe()).add(this.#controls.target);
    this.#controls.update();
    this.draw();
  }
}
