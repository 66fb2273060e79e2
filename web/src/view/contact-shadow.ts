import {
  Color,
  LinearMipmapLinearFilter,
  Mesh,
  MeshDepthMaterial,
  OrthographicCamera,
  PlaneGeometry,
  type Scene,
  ShaderMaterial,
  type Vector3,
  type WebGLRenderer,
  WebGLRenderTarget,
} from 'three';
import { kCasts } from './overlay/overlay';

const kTexels = 512; // per side
const kHigh = 0.3; // above the floor: what is higher casts none
const kBlur = 0.14; // of the radius of a model

/** A floor that is darker the nearer something is above it, as below a cloudy sky. Drawn from below, blurred by mipmaps and a disc of samples. */
export class ContactShadow {
  readonly object: Mesh<PlaneGeometry, ShaderMaterial>;
  readonly #camera = new OrthographicCamera(-1, 1, 1, -1, 0, kHigh);
  readonly #depth = new MeshDepthMaterial();
  readonly #target = new WebGLRenderTarget(kTexels, kTexels, {
    generateMipmaps: true,
    minFilter: LinearMipmapLinearFilter,
  });

  constructor() {
    const material = new ShaderMaterial({
      transparent: true,
      depthWrite: false,
      uniforms: { near: { value: this.#target.texture }, strength: { value: 1 }, across: { value: 1 } },
      vertexShader: `
        varying vec2 at;
        void main() {
          at = vec2(uv.x, 1.0 - uv.y);
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        }`,
      fragmentShader: `
        uniform sampler2D near;
        uniform float strength;
        uniform float across;
        varying vec2 at;
        void main() {
          float sum = 0.0;
          for (int i = 0; i < 24; i++) {
            float radius = ${kBlur} / (2.0 * across) * sqrt((float(i) + 0.5) / 24.0), angle = 2.39996 * float(i);
            float one = texture2D(near, at + radius * vec2(cos(angle), sin(angle)), log2(16.0 / across)).r;
            sum += one * one;
          }
          gl_FragColor = vec4(0.0, 0.0, 0.0, strength * sum / 24.0);
        }`,
    });
    this.object = new Mesh(new PlaneGeometry(2, 2), material);
    this.object.rotation.x = -Math.PI / 2;
    this.#camera.rotation.x = Math.PI / 2;
    this.#camera.layers.set(kCasts);
  }

  set strength(strength: number) {
    this.object.material.uniforms['strength']!.value = strength;
  }

  /** Draws it for what stands on the floor. @param center Of the floor. @param half  Of its side. */
  cast(renderer: WebGLRenderer, scene: Scene, center: Vector3, half: number): void {
    this.object.position.copy(center);
    this.object.scale.setScalar(half);
    this.object.material.uniforms['across']!.value = half;
    this.#camera.position.copy(center);
    this.#camera.zoom = 1 / half;
    this.#camera.updateProjectionMatrix();
    const { background } = scene;
    const [target, color, alpha] = [
      renderer.getRenderTarget(),
      renderer.getClearColor(new Color()),
      renderer.getClearAlpha(),
    ];
    scene.background = null;
    scene.overrideMaterial = this.#depth;
    renderer.setRenderTarget(this.#target);
    renderer.setClearColor(0, 1);
    renderer.clear();
    renderer.render(scene, this.#camera);
    renderer.setRenderTarget(target);
    renderer.setClearColor(color, alpha);
    scene.overrideMaterial = null;
    scene.background = background;
  }
}
