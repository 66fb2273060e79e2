import {
  Color,
  type IUniform,
  Matrix3,
  SRGBColorSpace,
  type Texture,
  Vector4,
  type WebGLRenderer,
  type WebGLRenderTarget,
} from 'three';
import type { Regions } from '../../gltf/look/saved-layers.js';
import { isMoved, readingOf, samplesOf } from '../../gltf/look/style.js';
import { checkColorSpace } from '../color-space.js';
import { Pass } from '../gpu/pass.js';
import type { Rect } from '../gpu/rect.js';
import { Stored } from '../gpu/straight.js';
import { fragmentShader } from './composite-shader.js';
import { type Kind, maxAtOnce } from './kinds.js';
import { type Blend, blendModes, type Layer, type Sheet } from './layer.js';
import { RegionMasks } from './regions.js';

const kMax = Math.max(...Object.values(maxAtOnce));

/** A stroke in progress: shown over one sheet, or erased from it, until it is committed. */
export interface ActiveStroke {
  sheet: Sheet;
  /** Premultiplied, of the same size as the sheet. */
  texture: Texture;
  /** 0..1, of the whole stroke. */
  opacity: number;
  erases: boolean;
}

/** What is drawn at once. */
interface Batch {
  kind: Kind;
  /** At most `maxAtOnce` of the kind. */
  layers: readonly Layer[];
  /** What the layers lie on. */
  below: Texture | undefined;
}

/** Draws layers, as many at once as the GPU has textures for. */
export class LayerPass {
  readonly #uniforms = {
    sheets: { value: [] as (Texture | null)[] },
    normals: { value: [] as (Texture | null)[] },
    tints: { value: Array.from({ length: kMax }, () => new Vector4()) },
    values: { value: Array.from({ length: kMax }, () => new Vector4()) },
    blends: { value: new Array<number>(kMax).fill(0) },
    stored: { value: new Array<number>(kMax).fill(0) },
    masks: { value: null as Texture | null },
    slices: { value: new Array<number>(kMax).fill(0) },
    places: { value: Array.from({ length: kMax }, () => new Matrix3()) },
    stroke: { value: null as Texture | null },
    below: { value: null as Texture | null },
    strokeOpacity: { value: 1 },
    strokeErases: { value: false },
    size: { value: 1 },
  };
  /** By recipe. */
  readonly #passes = new Map<string, Pass<Record<string, IUniform>>>();
  readonly #masks: RegionMasks;
  #regions: string[] = [];
  #stroke: ActiveStroke | undefined;
  /** The sheet of the last stroke: the next stroke is likely to use it, and its shader. */
  #strokeSheet: Sheet | undefined;
  /** The strongest glow: colours of glow are stored as a share of it. */
  glow = 1;

  constructor(regions: Regions) {
    this.#masks = new RegionMasks(regions);
  }

  set stroke(stroke: ActiveStroke | undefined) {
    this.#stroke = stroke;
    this.#strokeSheet = stroke?.sheet ?? this.#strokeSheet;
  }

  /** Prepares for all layers that are drawn next. */
  begin(layers: readonly Layer[]): void {
    this.#regions = [...new Set(layers.flatMap(({ region }) => region ?? []))];
    this.#uniforms.masks.value = this.#masks.of(this.#regions);
    this.glow = Math.max(...layers.map(({ emissive }) => emissive)) || 1;
  }

  /** @param rects In texels of the target, at most `kMaxRects`. */
  draw(renderer: WebGLRenderer, target: WebGLRenderTarget, batch: Batch, rects: readonly Rect[]): void {
    const { kind, layers, below } = batch;
    this.#fill(batch, target.width);
    const how = (texture: Texture, layer: Layer) =>
      isMoved(layer) ? 'moved' : isSquare(texture, target.width) ? 'whole' : 'spread';
    const recipe = {
      kind,
      takes: layers.map((layer) => how(layer.sheet.texture, layer)),
      reliefs: kind === 'normals' ? layers.map((layer) => how(layer.normal!, layer)) : [],
      masked: layers.map(({ region }) => region !== null),
      stroke: layers.findIndex(({ sheet }) => sheet === this.#strokeSheet),
      hasBelow: below !== undefined,
      hasVideo: this.#uniforms.stored.value.includes(Stored.video),
    };
    const key = JSON.stringify(recipe);
    let pass = this.#passes.get(key);
    if (!pass) this.#passes.set(key, (pass = new Pass(fragmentShader(recipe), this.#uniforms)));
    pass.run(renderer, target, rects);
  }

  /** Frees its GPU memory. */
  dispose(): void {
    this.#masks.dispose();
    for (const pass of this.#passes.values()) pass.dispose();
    this.#passes.clear();
  }

  #fill({ kind, layers, below }: Batch, width: number): void {
    const { sheets, normals, tints, values, blends, stored, slices, places, size, ...one } = this.#uniforms;
    // Set all entries: a stale one could be the texture that is drawn to, which WebGL forbids.
    const all = Array.from({ length: maxAtOnce[kind] }, (_, index) => layers[index]);
    sheets.value = all.map((layer) => layer?.sheet.texture ?? null);
    normals.value = kind === 'normals' ? all.map((layer) => layer?.normal ?? null) : [];
    one.below.value = below ?? null;
    stored.value.fill(0);
    layers.forEach((layer, index) => {
      const { sheet, tint, opacity, blend, region } = layer;
      checkColorSpace(sheet.texture);
      slices.value[index] = this.#regions.indexOf(region!);
      const { r, g, b } = new Color(tint);
      tints.value[index]!.set(r, g, b, opacity);
      values.value[index]!.set(...this.#valuesOf(kind, layer));
      blends.value[index] = blendModes.indexOf(blend as Blend);
      stored.value[index] = storedIn(sheet);
      if (!isMoved(layer)) return;
      const samples = samplesOf(layer, Math.max(...sidesOf(sheet.texture)), width);
      // There is room in its last row.
      places.value[index]!.set(...readingOf(layer), samples, 0, 1);
    });
    one.stroke.value = this.#stroke?.texture ?? null;
    one.strokeOpacity.value = this.#stroke?.opacity ?? 0;
    one.strokeErases.value = this.#stroke?.erases ?? false;
    size.value = width;
  }

  /** What the shader knows of a layer, as the kind needs it. */
  #valuesOf(kind: Kind, layer: Layer): [number, number, number, number] {
    const { roughness, metalness, emissive, blend, normal, normalScale } = layer;
    if (kind === 'surface')
      return [roughness ?? 0, Number(roughness !== null), metalness ?? 0, Number(metalness !== null)];
    if (kind === 'glow') return [emissive / this.glow, Number(blend === 'normal'), 0, 0];
    // In glTF, v grows downwards, and green means up.
    const { rotation } = layer;
    return [normalScale, normal?.flipY ? normalScale : -normalScale, Math.cos(rotation), Math.sin(rotation)];
  }
}

/** How a sheet has its colours, as the shaders know it. */
export function storedIn({ texture, premultiplied }: Sheet): number {
  const { isVideoTexture, colorSpace } = texture as Texture & { isVideoTexture?: true };
  if (premultiplied) return Stored.premultiplied;
  return isVideoTexture && colorSpace === SRGBColorSpace ? Stored.video : Stored.straight;
}

/** The sides of a texture, in texels. */
export function sidesOf({ image }: Texture): [width: number, height: number] {
  // Elements of the page have two sizes, of which the one that they are shown in is not meant.
  const { naturalWidth, naturalHeight, videoWidth, videoHeight, width, height } = (image ?? {}) as Record<
    string,
    number
  >;
  return [naturalWidth ?? videoWidth ?? width ?? 0, naturalHeight ?? videoHeight ?? height ?? 0];
}

export const isSquare = (texture: Texture, side: number): boolean => sidesOf(texture).every((found) => found === side);
