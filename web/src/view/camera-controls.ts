import { Box3, MathUtils, MOUSE, PerspectiveCamera, Sphere, Spherical, TOUCH, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import type { Angle } from '../state/view-state';
import { aspectOf, type FreePart, fittingDistance, kFieldOfView, kHome, setFrontOf } from './framing';
import type { Stage } from './stage';

const kLevel = MathUtils.degToRad(84); // of the views from the front and from the side
const kAbove = 0.02; // of the view from above: radians, not 0, so that its upper edge is known
const kNear = 5; // of a camera that looks at one of several models
const kFar = 12; // the greatest distance of the camera, from one model
const kFarthest = 60; // and from several
const kSway = MathUtils.degToRad(40); // amplitude of the idle rotation
const kSwaySeconds = 16; // its period
const kLongestFrame = 0.25; // seconds: limits the rotation per frame, so that a slow frame causes no jump
const kKeyStep = MathUtils.degToRad(6);
const kKeyNearer = 1 / 1.1; // of the distance
const kCloser = 0.5; // of the distance, after a double click
const kKeyMove = 40; // pixels
const kRegionMargin = 1.2; // of the distance from which a region is looked at
const kMiddle = new Vector3(); // of the model

/** Where the camera is beside a model, in radians around it from its front. */
const kSides = { front: 0, left: Math.PI / 2, right: -Math.PI / 2, back: Math.PI, top: 0 };

/** A side from which the whole model is shown; `all` is where the camera is. */
export type Side = keyof typeof kSides | 'all';

/** The camera, and how pointers, keys and time move it around what is on the stage. */
export class CameraControls {
  readonly camera = new PerspectiveCamera(kFieldOfView, 1, 0.05, 100);
  readonly #stage: Stage;
  readonly #redraw: () => void;
  readonly #controls: OrbitControls;
  #free: FreePart = { width: 1, height: 1, top: 0, bottom: 0, side: 0, fill: 1 };
  /** The distance at which the whole model is visible, for the current size. */
  #far = 1;
  #closeUp: (() => readonly Vector3[] | undefined) | undefined;
  /** Whether the user moved the camera. */
  #moved = false;
  /** The front of the model that a crowd was last around. */
  #front = 0;
  /** Seconds of idle rotation so far; undefined if it is off. */
  #swayed: number | undefined;
  /** When it went on last. */
  #swayedAt = 0;
  #held = false;
  readonly #followers: (() => void)[] = [];
  /** When the controls were updated last. */
  #updated = 0;

  /** @param redraw Called when the camera moves. */
  constructor(canvas: HTMLCanvasElement, stage: Stage, redraw: () => void) {
    this.#stage = stage;
    this.#redraw = redraw;
    this.#controls = new OrbitControls(this.camera, canvas);
    this.#controls.touches.TWO = TOUCH.DOLLY_ROTATE;
    this.#controls.enableDamping = true;
    this.#controls.dampingFactor = 0.12;
    this.#controls.zoomToCursor = true;
    this.#controls.maxTargetRadius = 1; // inside the model
    this.#controls.minDistance = 0.8;
    this.#controls.maxDistance = kFar;
    this.#controls.maxPolarAngle = MathUtils.degToRad(150);
    this.#controls.addEventListener('change', () => {
      redraw();
      if (this.#moved) for (const follow of this.#followers) follow();
    });
    this.#controls.addEventListener('start', () => this.#markMoved());
    canvas.addEventListener('keydown', (event) => this.#onKey(event));
    this.home();
  }

  /** The part of the view that no controls cover. */
  get free(): FreePart {
    return this.#free;
  }

  /** Resets the camera to show the whole model, or what is looked at closely. */
  home(): void {
    this.#moved = false;
    this.#far = this.#fullDistance;
    const theta = this.#stage.front + kHome.theta;
    const region = this.#closeUp?.();
    if (region) this.#lookAtRegion(region, theta);
    else this.#look({ phi: kHome.phi, theta, radius: this.#far }, kMiddle);
  }

  /** Looks at a region of any model closely, until the user moves the camera. @param region Of the stage, if there is one; undefined ends it. */
  closeUp(region: (() => readonly Vector3[] | undefined) | undefined): void {
    this.#closeUp = region;
    if (!this.#moved) this.home();
  }

  /** Shows the whole model from a side, or as large as it fits from where the camera is. */
  lookFromSide(side: Side): void {
    this.#markMoved();
    const angle = this.#orbit;
    if (side !== 'all') angle.set(1, side === 'top' ? kAbove : kLevel, this.#stage.front + kSides[side]);
    this.#look({ phi: angle.phi, theta: angle.theta, radius: this.#fittingDistance(angle, true) }, kMiddle);
  }

  /**
   * Shows a region of the model, as large as it fits.
   * @param points  Of the stage.
   * @param front   Where the region looks, as a model's front.
   */
  lookAt(points: readonly Vector3[], front: number): void {
    this.#markMoved();
    this.#lookAtRegion(points, front);
  }

  #lookAtRegion(points: readonly Vector3[], theta: number): void {
    const { center, radius } = new Box3().setFromPoints([...points]).getBoundingSphere(new Sphere());
    const full = this.#stage.crowd ? kNear : this.#fullDistance; // of one model
    const distance = Math.max(kRegionMargin * radius * full, this.#controls.minDistance);
    this.#look({ phi: kLevel, theta, radius: Math.min(distance, this.#far) }, center);
  }

  /** Makes the side that is seen the model's front. */
  takeFront(): void {
    if (this.#stage.model) setFrontOf(this.#stage.model, this.#orbit.theta);
    this.lookFromSide('front');
  }

  /** Looks at a point of the studio from nearer, and from the same side. */
  lookCloser(point: Vector3): void {
    this.#markMoved();
    const { radius, phi, theta } = this.#orbit;
    this.#look({ radius: Math.max(radius * kCloser, this.#controls.minDistance), phi, theta }, point);
  }

  /** The camera angle chosen by the user; undefined by default. */
  get angle(): Angle | undefined {
    if (!this.#moved) return undefined;
    const { radius, phi, theta } = this.#orbit;
    const { target } = this.#controls;
    return {
      turn: MathUtils.radToDeg(theta),
      tilt: MathUtils.radToDeg(phi),
      near: this.#fullDistance / radius,
      ...(!target.equals(kMiddle) && { at: target.toArray() }),
    };
  }

  /** Calls back whenever that changes. */
  onMove(follow: () => void): void {
    this.#followers.push(follow);
  }

  /** Sets the camera angle, within the limits of the controls. */
  lookFrom({ turn, tilt, near, at }: Angle): void {
    this.#markMoved();
    const [phi, theta] = [MathUtils.degToRad(tilt), MathUtils.degToRad(turn)];
    this.#look({ radius: this.#fullDistance / near, phi, theta }, at ? new Vector3(...at) : kMiddle);
  }

  /** The crowd on the stage has changed. @param isOther Whether another one is there, or none. */
  followCrowd(isOther: boolean): void {
    const { crowd } = this.#stage;
    this.#controls.maxDistance = crowd ? kFarthest : kFar;
    this.#controls.enablePan = this.#controls.zoomToCursor = !crowd;
    const [far, front] = [this.#far, this.#stage.front];
    if (isOther || !this.#moved) this.home();
    else {
      this.#far = this.#fullDistance;
      const { radius, phi, theta } = this.#orbit;
      const turned = { phi, theta: theta + front - this.#front, radius: (radius * this.#far) / far };
      this.#look(turned, this.#controls.target.clone());
    }
    this.#front = front;
  }

  /** What moves the middle of a crowd to where the camera looks, from afar; from near it looks at the model on the stage. */
  get shift(): Vector3 {
    const { radius, theta } = this.#orbit;
    const near = Math.min(kNear, this.#far / 2);
    const share = MathUtils.smoothstep(radius, near, 0.9 * this.#far);
    return this.#stage.crowd?.middle(theta).multiplyScalar(-share) ?? new Vector3();
  }

  /** The view has another size, in pixels. */
  resize(width: number, height: number, free: FreePart): void {
    const before = this.#free;
    this.camera.aspect = width / height;
    this.#free = free;
    // Centre the model in the free part.
    this.camera.setViewOffset(width, height, 0, (free.bottom - free.top) / 2, width, height);
    const far = this.#far;
    this.#far = this.#fullDistance;
    // Such as when a phone hides its address bar: keep the user's angle and magnification.
    if (this.#moved) {
      const { radius, phi, theta } = this.#orbit;
      this.#look({ radius: (radius * this.#far) / far, phi, theta });
    } else if (JSON.stringify(before) !== JSON.stringify(free)) this.home();
  }

  /** Switches the idle rotation, which ends when the user moves the camera. */
  sway(on: boolean): void {
    if (on === (this.#swayed !== undefined)) return;
    this.#swayed = on ? 0 : undefined;
    this.#redraw();
  }

  /** Holds the idle rotation, or lets it go on: it would take the processor from other work where there is no graphics card. */
  hold(on: boolean): void {
    this.#held = on;
    this.#swayedAt = 0;
    this.#redraw();
  }

  /** Turns the model round and round, but for while the user turns it. @param seconds Of a turn; undefined ends it. */
  turntable(seconds: number | undefined): void {
    this.sway(false);
    this.#controls.autoRotate = seconds !== undefined;
    this.#controls.autoRotateSpeed = 60 / (seconds ?? 60);
    this.#redraw();
  }

  /** Sets whether one finger or the main button turns the model; two fingers always do. */
  set turning(turns: boolean) {
    this.#controls.touches.ONE = turns ? TOUCH.ROTATE : null;
    this.#controls.mouseButtons.LEFT = turns ? MOUSE.ROTATE : null;
  }

  /** Moves the camera on to a time, in milliseconds. */
  update(now: number): void {
    if (this.#swayed !== undefined && !this.#held && this.#stage.model) {
      // Starts with the first frame.
      if (this.#swayedAt > 0) this.#swayed += Math.min(kLongestFrame, Math.max(0, now - this.#swayedAt) / 1000);
      this.#swayedAt = now;
      const phase = Math.sin(this.#swayed * ((2 * Math.PI) / kSwaySeconds));
      const { radius, phi } = this.#orbit;
      this.#look({ radius, phi, theta: this.#stage.front + kHome.theta - kSway * phase });
    }
    // Damping goes on for a few frames after a drag; each change requests the next frame.
    this.#controls.update(this.#controls.autoRotate ? Math.min(kLongestFrame, (now - this.#updated) / 1000) : null);
    this.#updated = now;
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
      '0': () => this.lookFromSide('all'),
      '1': () => this.lookFromSide('front'),
      '2': () => this.lookFromSide('left'),
      '3': () => this.lookFromSide('right'),
      '4': () => this.lookFromSide('back'),
      '5': () => this.lookFromSide('top'),
    };
    const action = actions[event.shiftKey && event.key.startsWith('Arrow') ? `Shift ${event.key}` : event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.#markMoved();
    this.#withoutDamping(action);
  }

  /** The user moves the camera from now on. */
  #markMoved(): void {
    this.sway(false);
    this.#moved = true;
  }

  /** Where the camera is, from what it looks at. */
  get #orbit(): Spherical {
    return new Spherical().setFromVector3(this.camera.position.clone().sub(this.#controls.target));
  }

  /** The distance at which the whole model is visible. */
  get #fullDistance(): number {
    const home = new Spherical(1, kHome.phi, this.#stage.front + kHome.theta);
    return this.#fittingDistance(home, this.#stage.crowd !== undefined);
  }

  #fittingDistance(angle: Spherical, exact: boolean): number {
    return fittingDistance(this.#free, this.#stage.extent(angle.theta, aspectOf(this.#free)), angle, exact);
  }

  /** @param target What is looked at, in the studio. */
  #look({ radius, phi, theta }: Pick<Spherical, 'radius' | 'phi' | 'theta'>, target = this.#controls.target): void {
    this.#withoutDamping(() => {
      this.#controls.target.copy(target);
      this.camera.position.setFromSphericalCoords(radius, phi, theta).add(target);
      this.#controls.update();
    });
  }

  /** Moves the camera without damping, and ends a glide in progress. */
  #withoutDamping(move: () => void): void {
    this.#controls.enableDamping = false;
    this.#controls.update(); // otherwise the rest of the glide would be added to the move
    move();
    this.#controls.enableDamping = true;
    this.#redraw();
  }
}
