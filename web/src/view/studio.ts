import { type Camera, Color, DirectionalLight, Mesh, PlaneGeometry, Scene, ShadowMaterial, Vector3 } from 'three';
import type { LightName } from '../state/view-state';
import { environmentOf, kLights } from './light';

const kOrigin = new Vector3();

/**
 * The scene around a model: ambient light, a key light over the viewer's shoulder, and a floor with a soft shadow. It fits
 * models of radius 1 at the origin.
 */
export class Studio {
  readonly scene = new Scene();
  readonly #floor = new Mesh(new PlaneGeometry(12, 12), new ShadowMaterial({ opacity: 0.28 }));
  readonly #key = new DirectionalLight();
  #light: LightName | undefined;

  constructor() {
    this.setLight('studio');
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
    this.scene.add(this.#floor, this.#key);
  }

  setLight(name: LightName): void {
    if (name === this.#light) return;
    this.#light = name;
    const { key } = kLights[name];
    this.scene.environment?.dispose();
    this.scene.environment = environmentOf(kLights[name]);
    this.#key.color.set(key.color);
    this.#key.intensity = key.strength;
    this.#floor.material.opacity = Math.min(0.28, 0.13 * key.strength);
  }

  /** @param color As #rrggbb; empty for none. */
  setBackground(color: string): void {
    this.scene.background = color ? new Color(color) : null;
  }

  /** Places the floor under a model whose lowest point is at `height`. */
  setFloor(height: number): void {
    this.#floor.position.y = height - 0.01;
  }

  /** Shows the floor, or not: several rows of models have no common one. */
  showFloor(shown: boolean): void {
    this.#floor.visible = shown;
  }

  /**
   * Rotates the lights with the camera, so that no side of the model is dark.
   * @param place Where the model on the stage is, which casts the shadow; the origin by default.
   */
  follow(camera: Camera, place = kOrigin): void {
    const { x, z } = camera.getWorldDirection(new Vector3());
    const turn = Math.atan2(-x, -z) - 0.6;
    this.#key.position.set(3 * Math.sin(turn), 4.6, 3 * Math.cos(turn)).add(place);
    this.#key.target.position.copy(place);
    this.#key.target.updateMatrixWorld();
    // The environment rotates too.
    this.scene.environmentRotation.y = turn;
  }
}
