import { MathUtils, type PerspectiveCamera, type Ray, Raycaster, Vector2, Vector3 } from 'three';
import type { CameraControls } from './camera-controls';
import { pick, type Spot } from './pick';
import type { Stage } from './stage';

/** Relates positions on the screen, in client coordinates, to the space of the target on the stage. */
export class ScreenSpace {
  readonly #canvas: HTMLCanvasElement;
  readonly #controls: CameraControls;
  readonly #stage: Stage;

  constructor(canvas: HTMLCanvasElement, controls: CameraControls, stage: Stage) {
    this.#canvas = canvas;
    this.#controls = controls;
    this.#stage = stage;
  }

  /** The spot of the target at a position. */
  pick(x: number, y: number): Spot | undefined {
    return this.#stage.model && pick(this.#stage.model.mesh, this.eyeRay(x, y));
  }

  /** The ray from the eye through a position, in the studio. */
  eyeRay(x: number, y: number): Raycaster {
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * (x - left)) / width - 1, 1 - (2 * (y - top)) / height), this.#camera);
    return ray;
  }

  /** The ray through a position, in the target's space. */
  rayAt(x: number, y: number): Ray {
    this.#stage.object.updateWorldMatrix(true, false);
    return this.eyeRay(x, y).ray.applyMatrix4(this.#stage.object.matrixWorld.clone().invert());
  }

  /** Where a point of the target is seen. */
  project(point: Vector3): { x: number; y: number } {
    const { x, y } = this.#stage.object.localToWorld(point.clone()).project(this.#camera);
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    return { x: left + ((1 + x) / 2) * width, y: top + ((1 - y) / 2) * height };
  }

  /** The centre of the free part of the view. */
  get center(): { x: number; y: number } {
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    const { free } = this.#controls;
    return { x: left + width / 2, y: top + (height + free.top - free.bottom) / 2 };
  }

  /** Pixels per unit of length of the target. @param seen A position in the studio, as in `Spot`. */
  pixelsAt(seen: Vector3): number {
    const { camera } = this.#controls;
    const depth = seen.clone().applyMatrix4(camera.matrixWorldInverse).z;
    return (
      (this.#stage.object.scale.x * this.#canvas.clientHeight) /
      (-2 * depth * Math.tan(MathUtils.degToRad(camera.fov / 2)))
    );
  }

  /** Whether a surface of the target faces the camera. */
  faces(point: Vector3, normal: Vector3): boolean {
    return this.#stage.object.worldToLocal(this.#controls.camera.position.clone()).sub(point).dot(normal) > 0;
  }

  /** The direction of the view's upper edge, in the target's space. */
  get up(): Vector3 {
    return new Vector3().setFromMatrixColumn(this.#controls.camera.matrixWorld, 1);
  }

  /** The camera, which may have moved since the last frame. */
  get #camera(): PerspectiveCamera {
    const { camera } = this.#controls;
    camera.updateMatrixWorld();
    return camera;
  }
}
