import { Mesh, MeshStandardMaterial, type Texture, type WebGLProgramParametersWithUniforms } from 'three';
import { isSoftware } from '../../platform/graphics';
import type { Session } from '../../state/session';
import type { Viewer } from '../viewer';

/** How long paint takes to roll on, in milliseconds. */
const kRollOn = 1600;

const kHeight = 'varying vec3 vRollOnAt;\n';
const kShader = /* glsl */ `${kHeight}uniform vec2 rollOn;
float rollOnDepth() {
  vec3 at = vRollOnAt;
  float wave = sin(9.0 * at.x + 4.0 * at.z) + 0.6 * sin(21.0 * at.x - 13.0 * at.z + 5.0 * at.y) + 0.4 * sin(37.0 * at.z + 11.0 * at.y);
  return rollOn.x - at.y + 0.02 * wave * rollOn.y;
}
`;
// Above the front is no paint; below it, the paint is wet: it shines, and cools down.
const kHidden = 'diffuseColor.a *= smoothstep(0.0, 0.012 * rollOn.y, rollOnDepth());';
const kBright =
  'totalEmissiveRadiance += (0.4 * diffuseColor.rgb + vec3(1.6, 1.35, 0.9)) * exp(-rollOnDepth() / (0.035 * rollOn.y));';

/**
 * Lets the paint of the model on the stage roll on, from its feet to its head: what stays bare parts the front. It is not to be seen
 * until `move` is called.
 * @param paint What the paint is in.
 */
export class RollOn {
  readonly #viewer: Viewer;
  readonly #materials = new Map<MeshStandardMaterial, MeshStandardMaterial['onBeforeCompile']>();
  /** Where the front is, and the height of the model. */
  readonly #uniform = { value: [-1e6, 1] };
  readonly #range: [number, number];

  constructor(viewer: Viewer, paint: Texture) {
    this.#viewer = viewer;
    const { stage } = viewer;
    let [low, high] = [Infinity, -Infinity];
    const points = stage.extent(0, 1);
    for (let i = 1; i < points.length; i += 3) [low, high] = [Math.min(low, points[i]!), Math.max(high, points[i]!)];
    this.#range = [low, high];
    this.#uniform.value[1] = high - low;
    stage.object.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      for (const material of [object.material].flat())
        if (material instanceof MeshStandardMaterial && material.map === paint) this.#add(material);
    });
  }

  #add(material: MeshStandardMaterial): void {
    if (this.#materials.has(material)) return;
    const before = material.onBeforeCompile;
    this.#materials.set(material, before);
    material.onBeforeCompile = (shader: WebGLProgramParametersWithUniforms, renderer) => {
      before.call(material, shader, renderer);
      shader.uniforms['rollOn'] = this.#uniform;
      shader.vertexShader =
        kHeight +
        shader.vertexShader.replace(
          '#include <project_vertex>',
          '$&\nvRollOnAt = (modelMatrix * vec4(transformed, 1.0)).xyz;',
        );
      shader.fragmentShader =
        kShader +
        shader.fragmentShader
          .replace('#include <alphatest_fragment>', `${kHidden}\n$&`)
          .replace('#include <emissivemap_fragment>', `$&\n${kBright}`);
    };
    material.needsUpdate = true;
  }

  /** Moves the front. @param share 0 at the feet, 1 above the head. */
  move(share: number): void {
    const [low, high] = this.#range;
    const height = high - low;
    // Until its light has gone, too.
    this.#uniform.value[0] = low - 0.05 * height + share * 1.3 * height;
    this.#viewer.redraw();
  }

  /** Rolls on from now on, and ends. */
  async run(): Promise<void> {
    const begun = performance.now();
    for (let share = 0; share < 1; ) {
      const now = await new Promise<number>((done) => requestAnimationFrame(done));
      share = Math.min(1, Math.max(0, now - begun) / kRollOn);
      this.move(share * share * (3 - 2 * share));
    }
    this.end();
  }

  /** The paint is as it was. */
  end(): void {
    for (const [material, before] of this.#materials) {
      material.onBeforeCompile = before;
      material.needsUpdate = true;
    }
    this.#materials.clear();
    this.#viewer.redraw();
  }
}

/** Lets the paint of the first model of one's own roll on, where motion is welcome and frames are quick. */
export function rollOnFirst(session: Session, viewer: Viewer, paint: Texture): void {
  if (matchMedia('(prefers-reduced-motion: reduce)').matches || isSoftware(viewer.renderer)) return;
  const end = session.on('transfer', ({ target }) => {
    if (target.sample) return;
    end();
    // Its paint comes after it.
    const rollOn = new RollOn(viewer, paint);
    const shown = session.on('progress', ({ state }) => {
      if (state === 'working') return;
      shown();
      void rollOn.run();
    });
  });
}
