import { type Camera, DirectionalLight, Group, Mesh, PlaneGeometry, Scene, ShadowMaterial } from 'three';
import { studioLight } from './light';

/**
 * The scene around a model: ambient light, a key light over the viewer's shoulder, and a floor with a soft shadow. It fits
 * models of radius 1 at the origin.
 */
export class Studio {
  readonly scene = new Scene();
  /** The group for the displayed objects. */
  readonly stage = new Group();
  readonly #floor = new Mesh(new PlaneGeometry(12, 12), new ShadowMaterial({ opacity: 0.28 }));
  readonly #key = new DirectionalLight(0xfff4e6, 2.1);

  constructor() {
    this.scene.environment = studioLight();

    this.#floor.rotation.x = -Math.PI / 2;
    this.#floor.receiveShadow = true;

    const { shadow } = this.#key;
    this.#key.castShadow = true;
    shadow.mapSize.set(1024, 1024);
    shadow.radius = 6;
    shadow.normalBias = 0.02;
    shadow.camera.near = 1;
    shadow.camera.far = 10;
    shadow.camera.left = shadow.camera.bottom = -1.6;
    shadow.camera.right = shadow.camera.top = 1.6;
    this.scene.add(this.stage, this.#floor, this.#key);
  }

  /** Places the floor under a model whose lowest point is at `height`. */
  setFloor(height: number): void {
    this.#floor.position.y = height - 0.01;
  }

  /** Rotates the lights with the camera, so that no side of the model is dark. */
  follow(camera: Camera): void {
    const turn = Math.atan2(camera.position.x, camera.position.z) - 0.6;
    this.#key.position.set(3 * Math.sin(turn), 4.6, 3 * Math.cos(turn));
    // The environment rotates too.
    this.scene.environmentRotation.y = turn;
  }
}
