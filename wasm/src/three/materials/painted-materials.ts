import { Material, type ShaderMaterial, type Mesh as ThreeMesh, UnsignedByteType } from 'three';
import { channelsOf, type Follower, followChannels, variantOf } from './channels.js';
import { canBeNodePainted, type NodeHooks, nodeHooks, type ShownPaint } from './node-paint.js';
import {
  addPaint,
  type Paint,
  type PaintUniforms,
  paintUniforms,
  refreshMatrix,
  setUniforms,
  takesPaint,
} from './paint-shader.js';

/** What is painted, and the meshes that show it. */
export interface Painting extends Paint, Follower {
  /** Greater than those of all paintings before it, which it replaces where it is shown. */
  number: number;
  meshes: ReadonlySet<ThreeMesh>;
  /** Those that show it. */
  materials: Set<Material>;
  /** What its materials call for each mesh. One function for all of them, which engines call faster than one for each. */
  refresh: Material['onBeforeRender'];
}

let paintingCount = 0;

/** In the keys of programs: those that another copy of this module had compiled refer to its uniforms. */
const kCopy = `cagecast ${Math.random()}`;

/** Makes a painting that is brought up to date once in each frame. */
export function makePainting(paint: Omit<Painting, 'refresh' | 'number' | 'materials' | 'follow'>): Painting {
  let [last, lastFrame, lastVersion]: [unknown, number, number | undefined] = [undefined, -1, undefined];
  const painting: Painting = {
    ...paint,
    number: ++paintingCount,
    materials: new Set(),
    follow() {
      for (const material of painting.materials) readPainting(material, patches.get(material)!, painting);
    },
    refresh(renderer) {
      const { frame } = renderer.info.render;
      if (frame === lastFrame && renderer === last) return;
      last = renderer;
      lastFrame = frame;
      refreshMatrix(painting);
      const version = painting.texture?.version;
      if (version !== lastVersion) painting.follow();
      lastVersion = version;
    },
  };
  return painting;
}

/**
 * What was changed about a material. Its states:
 *
 * - Never painted: it has no record.
 * - Painted: the record has a painting, and the material has the hooks that it was given.
 * - Wrapped: others have replaced these hooks, and call them. To paint the material again, they are wrapped once more.
 * - Unpainted: the record has no painting. The material has its own hooks again, or those of others that call the given ones, which
 *   add nothing now. The record is kept for ever: programs that were compiled refer to its uniforms.
 */
interface Patch {
  painting: Painting | undefined;
  uniforms: PaintUniforms;
  /** The hooks that the material has of its own. */
  own: Partial<Hooks>;
  /** Those that it was given. Others may have wrapped them since. */
  given: Partial<Hooks>;
  /** Whether neither the material nor its class does anything before it is rendered. */
  isQuiet: boolean;
  /** How its shaders read the texture. */
  reading: string;
  /** The channels that they show. */
  variant: string;
  /** Whether `WebGPURenderer` has drawn it. */
  hasNodes: boolean;
}

const kNodeHooks = [
  'setupDiffuseColor',
  'setupVariants',
  'setupNormal',
  'setupLighting',
  'setupObserver',
] as const satisfies (keyof NodeHooks)[];
const kHooks = ['onBeforeCompile', 'customProgramCacheKey', 'onBeforeRender', ...kNodeHooks] as const;
type Hooks = Pick<Material & NodeHooks, (typeof kHooks)[number]>;

const patches = new WeakMap<Material, Patch>();

const kBuiltIn = ['Basic', 'Lambert', 'Phong', 'Standard', 'Toon', 'Matcap'].map((kind) => `isMesh${kind}Material`);

/**
 * Whether paint can be mixed into a material's colour: the lit and unlit materials of three.js, and other `ShaderMaterial`s whose
 * shader is written as theirs are, or asks for `CAGECAST_PAINT`; and with `cagecast/three/webgpu`, those of `three/webgpu`.
 */
export function canBePainted(material: Material): boolean {
  const kinds = material as Material & Record<string, unknown>;
  if (kinds['isNodeMaterial'] === true) return canBeNodePainted(material);
  if (kinds['isRawShaderMaterial'] === true) return false;
  if (kinds['isShaderMaterial'] === true) return takesPaint((material as ShaderMaterial).fragmentShader);
  return kBuiltIn.some((kind) => kinds[kind] === true);
}

/** What a material was copied from, to show another painting. */
export const originals: WeakMap<Material, Material> = new WeakMap();

/** Whether a material shows a painting. */
export const isPainted = (material: Material): boolean => patches.get(material)?.painting !== undefined;

/**
 * Makes a material show a painting. A material that shows another painting on other meshes is left to them.
 * @returns the material, or a copy of it that shows the painting.
 */
export function paintOn(material: Material, painting: Painting, alone = false): Material {
  const shown = patches.get(material)?.painting;
  if (shown && shown !== painting && uses(shown.meshes, material).some((mesh) => !painting.meshes.has(mesh))) {
    const copy = material.clone();
    originals.set(copy, material);
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
  const known = patches.get(material);
  const record: Patch = known ?? {
    painting: undefined,
    uniforms: paintUniforms(),
    own: {},
    given: {},
    isQuiet: true,
    reading: '',
    variant: '',
    hasNodes: false,
  };
  patches.set(material, record);
  // Somebody has replaced or wrapped the hook that was given, or none was given yet.
  if (material.onBeforeCompile !== record.given.onBeforeCompile) unpaint(material, record.painting);
  const isPatched = record.painting;
  record.painting?.materials.delete(material);
  record.painting = painting;
  painting.materials.add(material);
  followChannels(painting);
  readPainting(material, record, painting);
  if (isPatched) {
    if (record.isQuiet && material.onBeforeRender === record.given.onBeforeRender)
      material.onBeforeRender = record.given.onBeforeRender = painting.refresh;
    return;
  }
  // A program that was compiled when it was painted before has the same key, but its uniforms may be gone.
  if (known) material.dispose();

  const hooks = material as Material & Partial<NodeHooks>;
  const { onBeforeCompile, customProgramCacheKey, onBeforeRender } = hooks;
  record.own = Object.fromEntries(kHooks.flatMap((name) => (Object.hasOwn(hooks, name) ? [[name, hooks[name]]] : [])));
  record.isQuiet = onBeforeRender === Material.prototype.onBeforeRender;
  // Where others have wrapped them, these are called when the material is not painted any more, too.
  record.given = {
    customProgramCacheKey() {
      const key = customProgramCacheKey.call(material);
      // By default the key is the text of `onBeforeCompile`, which is not the material's own by now.
      return record.painting
        ? `${key}|${onBeforeCompile}|${kCopy}${alone ? ' alone' : ''}${record.reading}${record.variant}`
        : key;
    },
    onBeforeCompile: (shader, renderer) => {
      onBeforeCompile.call(material, shader, renderer);
      if (!record.painting) return;
      // The uniforms of a `ShaderMaterial` are its owner's, who may have given them to several.
      if ('isShaderMaterial' in material) shader.uniforms = Object.create(shader.uniforms);
      addPaint(shader, record.uniforms, { alone, variant: record.variant });
    },
    onBeforeRender: record.isQuiet
      ? painting.refresh
      : (...args) => {
          onBeforeRender.apply(material, args);
          record.painting?.refresh.apply(material, args);
        },
    ...nodeHooks(record.own, shownOn, alone),
  };
  Object.assign(material, record.given);
  material.needsUpdate = true;
}

/** Makes a material show the texture and the channels that a painting has by now. */
function readPainting(material: Material, record: Patch, painting: Painting): void {
  setUniforms(record.uniforms, painting);
  const [reading, variant] = [readingOf(painting), variantOf(channelsOf(painting.texture))];
  // Programs that were compiled for other channels are kept for when these come back.
  if (variant !== record.variant || (record.hasNodes && reading !== record.reading)) material.needsUpdate = true;
  record.reading = reading;
  record.variant = variant;
}

/** The paint of a material in the current frame, for `WebGPURenderer`, which has no call before it draws. */
function shownOn(material: Material): ShownPaint | undefined {
  const record = patches.get(material);
  if (!record?.painting) return undefined;
  record.hasNodes = true;
  refreshMatrix(record.painting);
  setUniforms(record.uniforms, record.painting);
  const { cagecastMap, cagecastMatrix } = record.uniforms;
  const channels = channelsOf(record.painting.texture);
  return { texture: cagecastMap.value, matrix: cagecastMatrix.value, channels };
}

/** What of a texture is a part of shaders that `WebGPURenderer` builds. */
function readingOf({ texture }: Paint): string {
  if (!texture) return '';
  const isVideo = (texture as { isVideoTexture?: true }).isVideoTexture;
  return `${isVideo ? ' video' : ''}${texture.type === UnsignedByteType ? '' : ` ${texture.type}`}`;
}

/** Makes a material what it was, unless it shows another painting by now. Hooks that others have wrapped since stay theirs. */
export function unpaint(material: Material, painting: Painting | undefined): void {
  const record = patches.get(material);
  if (!record || record.painting !== painting) return;
  record.painting = undefined;
  painting?.materials.delete(material);
  setUniforms(record.uniforms, undefined);
  for (const name of kHooks) {
    if ((material as Partial<Hooks>)[name] !== record.given[name]) continue;
    if (record.own[name]) Object.assign(material, { [name]: record.own[name] });
    else delete (material as Partial<Hooks>)[name];
  }
  material.needsUpdate = true;
}
