import type { Classification, CutTarget } from 'cagecast';
import {
  type AnimationClip,
  AnimationMixer,
  Box3,
  Group,
  type Matrix4,
  Mesh,
  type PerspectiveCamera,
  type Texture,
  Vector3,
} from 'three';
import { disposeModel } from '../loading/load-model';
import type { Model } from '../state/model';
import type { Decision } from '../state/study/baselines';
import type { SplitProjection } from '../state/transfers';
import { CageLines } from './cage-lines';
import { type Crowd, frontOf } from './framing';
import type { Highlighted, Look } from './overlay/looks';
import { Overlay } from './overlay/overlay';
import type { Studio } from './studio';

/** What is shown in the studio: a target with its paint and its cage, marks of features on it, and a crowd beside it. */
export class Stage {
  /** All but the crowd; scaled and moved so that the target has a diagonal of 2 about the origin. */
  readonly object = new Group();
  /** Objects of features, in the space of the transferred target. */
  readonly marks = new Group();
  readonly #studio: Studio;
  readonly #redraw: () => void;
  #model: Model | undefined;
  #overlay: Overlay | undefined;
  #cage: CageLines | undefined;
  #cageModel: Model | undefined;
  #paint: Texture | undefined;
  #crowd: Crowd | undefined;
  #mixer: AnimationMixer | undefined;
  #played = 0;
  #paused = false;
  /** The model's vertices in the studio. */
  #points: Float32Array = new Float32Array();
  /** Where the model's space begins if its middle is at the origin. */
  readonly #place = new Vector3();

  /** @param redraw Called when something else is to be seen. */
  constructor(studio: Studio, redraw: () => void) {
    this.#studio = studio;
    this.#redraw = redraw;
    this.object.add(this.marks);
    studio.scene.add(this.object);
  }

  /** The target. */
  get model(): Model | undefined {
    return this.#model;
  }

  /** The target's cage. */
  get cage(): Model | undefined {
    return this.#cageModel;
  }

  /** Where the model looks: radians around it. */
  get front(): number {
    return this.#model ? frontOf(this.#model) : 0;
  }

  /** Other models beside the target. */
  get crowd(): Crowd | undefined {
    return this.#crowd;
  }

  /** What is to be in the view, as `Crowd.extent`. */
  extent(theta: number, aspect: number): Float32Array {
    return this.#crowd?.extent(theta, aspect) ?? this.#points;
  }

  /** Shows another target; call `classify` next. Frees the previous one, unless it is the same. */
  setTarget(model: Model, projection: SplitProjection): void {
    this.#overlay?.dispose();
    if (model !== this.#model) this.#replace(model);
    this.#overlay = new Overlay(model.mesh, projection, this.#paint);
    this.#redraw();
  }

  #replace(model: Model): void {
    this.play(undefined);
    if (this.#model) {
      this.#model.scene.removeFromParent();
      disposeModel(this.#model);
    }
    this.#model = model;
    model.scene.removeFromParent();
    model.scene.updateMatrixWorld(true);
    const box = new Box3().setFromObject(model.scene, true);
    const size = box.getSize(new Vector3());
    const scale = 2 / Math.max(size.length(), Number.MIN_VALUE);
    this.object.scale.setScalar(scale);
    this.object.position.copy(box.getCenter(this.#place).multiplyScalar(-scale));
    this.object.add(model.scene);
    model.scene.traverse((object) => {
      if (object instanceof Mesh) object.castShadow = object.receiveShadow = true;
    });
    this.#studio.setFloor((-size.y * scale) / 2);
    this.#points = model.mesh.positions.map((value, i) => scale * value + this.#place.getComponent(i % 3));
  }

  /** Updates the projection of the current target, which has moved; call `classify` next. */
  setProjection(projection: SplitProjection): void {
    this.#overlay?.setProjection(projection);
    this.#redraw();
  }

  /** Shows the zones. */
  classify(classification: Classification): void {
    this.#overlay?.classify(classification);
    this.#redraw();
  }

  /** Shows the cut target until it moves or is replaced; undefined shows its own triangles. */
  async setCut(cut: CutTarget | undefined): Promise<void> {
    await this.#overlay?.setCut(cut);
    this.#redraw();
  }

  /** Sets what a half of the view paints, until another target or projection is shown; undefined: nothing. */
  setHalf(half: 'left' | 'right', decision: Decision | undefined): void {
    this.#overlay?.setHalf(half, decision);
    this.#redraw();
  }

  /** Sets the paint. If it is a render target's texture, call `Viewer.redraw` after it changed. */
  setPaint(paint: Texture): void {
    this.#paint = paint;
    this.#overlay?.setPaint(paint);
    this.#redraw();
  }

  /** Sets the colours for the look `colors`. @param colors 3 bytes per triangle corner, sRGB. */
  setColors(colors: Uint8Array): void {
    this.#overlay?.setColors(colors);
    this.#redraw();
  }

  /** Sets the texture of the look `checker`. */
  setChecker(checker: Texture): void {
    this.#overlay?.setChecker(checker);
    this.#redraw();
  }

  /** Highlights triangles of the target until it is replaced, and its parts until it moves. @param marks 1 for each of them; undefined highlights none. */
  highlight(what: Highlighted, marks: Uint8Array | undefined): void {
    this.#overlay?.highlight(what, marks);
    this.#redraw();
  }

  /** Shows another cage, in the space of the target. */
  setCage(model: Model): void {
    this.#cage?.dispose();
    this.#cageModel = model;
    this.#cage = new CageLines(model.mesh);
    this.object.add(this.#cage.object);
    this.#redraw();
  }

  /** Shows the cage where its vertices are now. */
  followCage(): void {
    this.#cage?.update();
    this.#redraw();
  }

  /** Shows the cage moved; it stays where it is. */
  moveCage(matrix: Matrix4): void {
    if (!this.#cage) return;
    this.#cage.object.matrixAutoUpdate = false;
    this.#cage.object.matrix.copy(matrix);
    this.#redraw();
  }

  /** Plays an animation of the target in place of the current one; undefined returns to the rest pose. */
  play(clip: AnimationClip | undefined): void {
    this.#mixer?.stopAllAction();
    this.#mixer = undefined;
    this.#paused = false;
    if (clip && this.#model) {
      this.#mixer = new AnimationMixer(this.#model.scene);
      this.#mixer.clipAction(clip).play();
      this.#played = performance.now();
    }
    this.#redraw();
  }

  /** Whether an animation is played. */
  get isPlaying(): boolean {
    return this.#mixer !== undefined && !this.#paused;
  }

  /** Holds what is played where it is, or goes on. */
  pause(paused: boolean): void {
    this.#paused = paused;
    this.#played = performance.now();
    this.#redraw();
  }

  /** Moves what is played to a time, in milliseconds. */
  animate(now: number): void {
    if (!this.#mixer || this.#paused) return;
    this.#mixer.update(Math.max(0, now - this.#played) / 1000);
    this.#played = now;
    this.#redraw();
  }

  /** Shows other models beside the target; undefined shows it alone. */
  setCrowd(crowd: Crowd | undefined): void {
    if (crowd !== this.#crowd) this.#crowd?.object.removeFromParent();
    this.#crowd = crowd;
    if (crowd) this.#studio.scene.add(crowd.object);
    this.#redraw();
  }

  /** Shows all in the next frame. @param shift How far the target and the crowd are moved. */
  arrange(camera: PerspectiveCamera, shift: Vector3, showsCage: boolean): void {
    this.#showOthers(true);
    this.#cage?.show(showsCage);
    this.object.position.copy(this.#place).add(shift);
    this.#crowd?.object.position.copy(shift);
    this.#crowd?.face(camera);
  }

  /** Shows the target alone, with its middle at the origin, until `arrange` is called. */
  isolate(): void {
    this.#showOthers(false);
    this.#cage?.show(false);
    this.object.position.copy(this.#place);
  }

  #showOthers(shown: boolean): void {
    this.marks.visible = shown;
    if (this.#crowd) this.#crowd.object.visible = shown;
  }

  /** Sets what the next frame draws on the models. */
  show(look: Look): void {
    this.#overlay?.show(look);
    this.#crowd?.show(look);
  }
}
