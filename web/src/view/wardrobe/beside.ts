import type { Classification } from 'cagecast';
import { Box3, Group, MathUtils, type Texture, Vector3 } from 'three';
import type { Model } from '../../state/model';
import type { SplitProjection } from '../../state/transfers';
import type { Figure } from '../../state/wardrobe/avatar';
import { Overlay } from '../overlay/overlay';

/** How much room a model needs when it is turned, once it is scaled to a diagonal of 2. */
export interface Room {
  /** From its middle to its sides and to its feet. */
  wide: number;
  high: number;
}

/** Reads the room of a model, and how to scale and centre it. */
export function measure({ scene }: Pick<Model, 'scene'>): Room & { scale: number; middle: Vector3 } {
  const parent = scene.parent;
  scene.removeFromParent(); // its own space
  scene.updateMatrixWorld(true);
  const box = new Box3().setFromObject(scene, true);
  parent?.add(scene);
  const size = box.getSize(new Vector3());
  const scale = 2 / Math.max(size.length(), Number.MIN_VALUE);
  return {
    scale,
    middle: box.getCenter(new Vector3()),
    wide: (scale * Math.hypot(size.x, size.z)) / 2,
    high: (scale * size.y) / 2,
  };
}

const kMostScaled = 1.4; // a figure with its arms out is that much lower than one without, at the same diagonal

/** A model that stands beside the one on the stage. */
export class Beside implements Figure, Room {
  readonly holder = new Group();
  readonly model: Model;
  /** Absent without a cage. */
  readonly overlay: Overlay | undefined;
  readonly #size: ReturnType<typeof measure>;
  #by = 1;
  isPainted = false;
  readonly #paint: Texture;
  #projection: SplitProjection | undefined;

  constructor(model: Model, projection: SplitProjection | undefined, paint: Texture) {
    this.#size = measure(model);
    this.model = model;
    this.#paint = paint;
    this.#projection = projection;
    const inner = new Group();
    inner.position.copy(this.#size.middle).negate();
    inner.add(model.scene);
    this.holder.add(inner);
    this.match();
    this.overlay = projection && new Overlay(model.mesh, projection, paint);
  }

  get wide(): number {
    return this.#by * this.#size.wide;
  }

  get high(): number {
    return this.#by * this.#size.high;
  }

  /** Scales it to stand as high as another model, unless their shapes differ much. @param high  Of that; its own size by default. */
  match(high = this.#size.high): void {
    this.#by = MathUtils.clamp(high / this.#size.high, 1 / kMostScaled, kMostScaled);
    this.holder.scale.setScalar(this.#by * this.#size.scale);
  }

  setPaint(paint: 'stage' | Texture | undefined): void {
    this.isPainted = paint !== undefined;
    if (paint) this.overlay?.setPaint(paint === 'stage' ? this.#paint : paint);
  }

  get projection(): SplitProjection | undefined {
    return this.#projection;
  }

  setProjection(projection: SplitProjection): void {
    this.#projection = projection;
    this.overlay?.setProjection(projection);
  }

  classify(classification: Classification): void {
    this.overlay?.classify(classification);
  }

  dispose(): void {
    this.holder.removeFromParent();
    this.overlay?.dispose();
  }
}
