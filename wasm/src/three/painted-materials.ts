import { Material, type ShaderMaterial, type Mesh as ThreeMesh } from 'three';
import { addPaint, type Paint, type PaintUniforms, paintUniforms, setUniforms, takesPaint } from './paint.js';

/** What is painted, and the meshes that show it. */
export interface Painting extends Paint {
  meshes: ReadonlySet<ThreeMesh>;
  /** What its materials call for each mesh. One function for all of them, which engines call faster than one for each. */
  refresh: Material['onBeforeRender'];
}

/** Makes a painting that is brought up to date once in each frame. */
export function makePainting(paint: Omit<Painting, 'refresh'>): Painting {
  let [last, lastFrame]: [unknown, number] = [undefined, -1];
  const painting: Painting = {
    ...paint,
    refresh(renderer) {
      const { frame } = renderer.info.render;
      if (frame === lastFrame && renderer === last) return;
      last = renderer;
      lastFrame = frame;
      painting.place.refresh(painting);
    },
  };
  return painting;
}

/** What was changed about a material. The record of a material is kept for ever: programs that were compiled refer to it. */
interface Patch {
  painting: Painting | undefined;
  /** How often it was patched. Part of the program's key, as a program of an earlier time lacks the uniforms. */
  times: number;
  uniforms: PaintUniforms;
  /** The hooks that the material has of its own. */
  own: Partial<Pick<Material, (typeof kHooks)[number]>>;
  /** Whether neither the material nor its class does anything before it is rendered. */
  isQuiet: boolean;
}

const kHooks = ['onBeforeCompile', 'customProgramCacheKey', 'onBeforeRender'] as const;

const patches = new WeakMap<Material, Patch>();

const kBuiltIn = ['Basic', 'Lambert', 'Phong', 'Standard', 'Toon', 'Matcap'].map((kind) => `isMesh${kind}Material`);

/**
 * Whether paint can be mixed into a material's colour: the lit and unlit materials of three.js, and other `ShaderMaterial`s whose
 * shader is written as theirs are, or asks for `CAGECAST_PAINT`.
 */
export function canBePainted(material: Material): boolean {
  const kinds = material as Material & Record<string, unknown>;
  if (kinds['isNodeMaterial'] === true || kinds['isRawShaderMaterial'] === true) return false;
  if (kinds['isShaderMaterial'] === true) return takesPaint((material as ShaderMaterial).fragmentShader);
  return kBuiltIn.some((kind) => kinds[kind] === true);
}

/**
 * Makes a material show a painting. A material that shows another painting on other meshes is left to them.
 * @returns the material, or a copy of it that shows the painting.
 */
export function paintOn(material: Material, painting: Painting, alone = false): Material {
  const shown = patches.get(material)?.painting;
  if (shown && shown !== painting && uses(shown.meshes, material).some((mesh) => !painting.meshes.has(mesh))) {
    const copy = material.clone();
    const { own } = patches.get(material)!;
    // A class that sets these has set them for the copy.
    if (own.onBeforeCompile && !Object.hasOwn(copy, 'onBeforeCompile')) Object.assign(copy, own);
    patch(copy, painting, alone);
    return copy;
  }
  patch(material, painting, alone);
  return material;
}

const uses = (meshes: ReadonlySet<ThreeMesh>, material: Material): ThreeMesh[] =>
  [...meshes].filter((mesh) => [mesh.material].flat().includes(material));

function patch(material: Material, painting: Painting, alone: boolean): void {
  const record: Patch = patches.get(material) ?? {
    painting: undefined,
    times: 0,
    uniforms: paintUniforms(),
    own: {},
    isQuiet: true,
  };
  patches.set(material, record);
  const isPatched = record.painting !== undefined;
  record.painting = painting;
  setUniforms(record.uniforms, painting);
  if (isPatched) {
    if (record.isQuiet) material.onBeforeRender = painting.refresh;
    return;
  }

  const { onBeforeCompile, customProgramCacheKey, onBeforeRender } = material;
  record.own = Object.fromEntries(
    kHooks.flatMap((name) => (Object.hasOwn(material, name) ? [[name, material[name]]] : [])),
  );
  const times = ++record.times;
  // By default the key is the text of `onBeforeCompile`, which must be that of the material's own. An object that inherits from the
  // material would do, but V8 gives every prototype a hidden class of its own, and all that reads materials becomes slower.
  const before = new Proxy(material, {
    get: (_, name) => (name === 'onBeforeCompile' ? onBeforeCompile : Reflect.get(material, name)),
  });
  material.customProgramCacheKey = () =>
    `${customProgramCacheKey.call(before)}|cagecast ${times}${alone ? ' alone' : ''}`;
  material.onBeforeCompile = (shader, renderer) => {
    onBeforeCompile.call(material, shader, renderer);
    addPaint(shader, record.uniforms, alone);
  };
  record.isQuiet = onBeforeRender === Material.prototype.onBeforeRender;
  material.onBeforeRender = record.isQuiet
    ? painting.refresh
    : (...args) => {
        onBeforeRender.apply(material, args);
        record.painting?.refresh.apply(material, args);
      };
  material.needsUpdate = true;
}

/** Makes a material what it was, unless it shows another painting by now. */
export function unpaint(material: Material, painting: Painting): void {
  const record = patches.get(material);
  if (record?.painting !== painting) return;
  record.painting = undefined;
  setUniforms(record.uniforms, undefined);
  const { uniforms } = material as Partial<ShaderMaterial>;
  for (const name of kHooks) {
    if (record.own[name]) Object.assign(material, { [name]: record.own[name] });
    else delete (material as Partial<Material>)[name];
  }
  if (uniforms) for (const name of Object.keys(record.uniforms)) delete uniforms[name];
  material.needsUpdate = true;
}
