import { type Camera, Color, DirectionalLight, Scene, Vector3, type WebGLRenderer } from 'three';
import type { LightName } from '../state/view-state';
import { ContactShadow } from './contact-shadow';
import { environmentOf, kLights } from './light';

const kFloor = 1.4; // widths of what stands on it
const kOrigin = new Vector3();

/**
 * The scene around a model: ambient light, a key light over the viewer's shoulder, and a floor with a soft shadow where
 * something stands on it. It fits models of radius 1 at the origin.
 */
export class Studio {
  readonly scene = new Scene();
  readonly #floor = new ContactShadow();
  #height = 0;
  readonly #key = new DirectionalLight();
  #light: LightName | undefined;

  constructor() {
    this.setLight('studio');
    const { shadow } = this.#key;
    this.#key.castShadow = true;
    shadow.mapSize.set(1024, 1024);
    shadow.radius = 6;
    shadow.normalBias = 0.02;
    shadow.camera.near = 1;
    shadow.camera.far = 10;
    shadow.camera.left = shadow.camera.bottom = -1.6;
    shadow.camera.right = shadow.camera.top = 1.6;
    this.scene.add(this.#floor.object, this.#key);
  }

  setLight(name: LightName): void {
    if (name === this.#light) return;
    this.#light = name;
    const { key } = kLights[name];
    this.scene.environment?.dispose();
    this.scene.environment = environmentOf(kLights[name]);
    this.#key.color.set(key.color);
    this.#key.intensity = key.strength;
    this.#floor.strength = Math.min(0.55, 0.26 * key.strength);
  }

  /** @param color As #rrggbb; empty for none. */
  setBackground(color: string): void {
    this.scene.background = color ? new Color(color) : null;
  }

  /** Places the floor under a model whose lowest point is at `height`. */
  setFloor(height: number): void {
    this.#height = height - 0.01;
  }

  /**
   * Draws the shadow on the floor.
   * @param wide  Half the width of what stands there; undefined where rows have no common floor.
   * @param middle Of it; its height is that of the model on the stage. The origin by default.
   */
  castShadow(renderer: WebGLRenderer, wide: number | undefined, { x, y, z } = kOrigin): void {
    this.#floor.object.visible = wide !== undefined;
    if (wide) this.#floor.cast(renderer, this.scene, new Vector3(x, y + this.#height, z), kFloor * wide);
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
