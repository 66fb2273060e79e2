import {
  Color,
  type IUniform,
  LinearFilter,
  LinearMipmapLinearFilter,
  RepeatWrapping,
  SRGBColorSpace,
  type Texture,
  Vector4,
  type WebGLRenderer,
  WebGLRenderTarget,
} from 'three';
import { checkColorSpace } from '../color-space.js';
import { refreshMipmaps } from '../gpu/mipmaps.js';
import { kMaxRects, Pass } from '../gpu/pass.js';
import { disjoint, kWhole, type Rect, toTexels } from '../gpu/rect.js';
import { fragmentShader } from './composite-shader.js';
import { blendModes, type Layer, type Sheet } from './layer.js';
import { RegionMasks, type Regions } from './regions.js';

/** Layers that one pass draws, as there may be only 16 textures in a shader. The stack has at most twice as many. */
const kMaxAtOnce = 8;
const kMinSize = 1024; // texels per side
const kVideo = 2; // how its colours are stored, in the shader
/** The greatest number of texels per side of a composite. @internal */
export const maxCompositeSize = 2048;

/** A stroke in progress: shown over one sheet, or erased from it, until it is committed. */
export interface ActiveStroke {
  sheet: Sheet;
  /** Premultiplied, of the same size as the sheet. */
  texture: Texture;
  /** 0..1, of the whole stroke. */
  opacity: number;
  erases: boolean;
}

const kFormat = { colorSpace: SRGBColorSpace, depthBuffer: false } as const;

/**
 * The layers blended into one texture, with mipmaps and premultiplied alpha. `update` redraws it after a change, and only the
 * parts that changed.
 * @internal
 */
export class Composite {
  readonly #target = new WebGLRenderTarget(kMinSize, kMinSize, {
    ...kFormat,
    generateMipmaps: true,
    minFilter: LinearMipmapLinearFilter,
    magFilter: LinearFilter,
    wrapS: RepeatWrapping,
    wrapT: RepeatWrapping,
    anisotropy: 8,
  });
  readonly #uniforms = {
    sheets: { value: [] as (Texture | null)[] },
    tints: { value: Array.from({ length: kMaxAtOnce }, () => new Vector4()) },
    blends: { value: new Array<number>(kMaxAtOnce).fill(0) },
    stored: { value: new Array<number>(kMaxAtOnce).fill(0) },
    masks: { value: null as Texture | null },
    slices: { value: new Array<number>(kMaxAtOnce).fill(0) },
    stroke: { value: null as Texture | null },
    below: { value: null as Texture | null },
    strokeOpacity: { value: 1 },
    strokeErases: { value: false },
    size: { value: kMinSize },
  };
  /** By recipe. */
  readonly #passes = new Map<string, Pass<Record<string, IUniform>>>();
  /** The lower half of many layers. */
  #below: WebGLRenderTarget | undefined;
  readonly #size: number | undefined;
  #layers: readonly Layer[] = [];
  /** Versions of the textures that were drawn, by layer. */
  readonly #drawn: number[] = [];
  #stroke: ActiveStroke | undefined;
  /** The sheet of the last stroke: the next stroke is likely to use it, and its shader. */
  #strokeSheet: Sheet | undefined;
  /** The parts that changed since the last update, in shares. */
  #stale: Rect[] = [kWhole];

  readonly #masks: RegionMasks;

  /**
   * @param size     Texels per side, a power of two. Default: 1024 or 2048, as the largest layer needs.
   * @param regions  Of the cage. Default: none.
   */
  constructor(size?: number, regions: Regions = {}) {
    this.#size = size;
    this.#masks = new RegionMasks(regions);
    // `refreshMipmaps` updates the changed parts; the renderer would rebuild all levels for every stroke.
    this.#target.texture.mipmapsAutoUpdate = false;
    // The renderer does not upload it; this tells `cagecast/three` how its texels are stored.
    this.#target.texture.premultiplyAlpha = true;
    this.#target.texture.name = 'cagecast layers';
  }

  /** Always the same object. sRGB, premultiplied alpha, first row at v = 0. */
  get texture(): Texture {
    return this.#target.texture;
  }

  /** Texels per side: as many as the largest layer needs. */
  get size(): number {
    return this.#target.width;
  }

  /** @param layers From the lowest to the uppermost, at most `maxLayers`. */
  set(layers: readonly Layer[]): void {
    this.#layers = layers.filter(({ visible, opacity }) => visible && opacity > 0);
    this.#stale = [kWhole];
  }

  /** Marks parts of a sheet as changed. @param rects In shares. @param stroke The stroke in progress, if any. */
  touch(rects: readonly Rect[], stroke?: ActiveStroke): void {
    this.#stroke = stroke;
    this.#strokeSheet = stroke?.sheet ?? this.#strokeSheet;
    this.#stale.push(...rects);
  }

  /** Redraws what changed, including textures with `needsUpdate`. @returns Whether anything did. */
  update(renderer: WebGLRenderer): boolean {
    // In each frame, so nothing is allocated here.
    for (let i = 0; i < this.#layers.length; ++i) {
      const { version } = this.#layers[i]!.sheet.texture;
      if (version !== this.#drawn[i]) this.#stale = [kWhole];
      this.#drawn[i] = version;
    }
    if (this.#stale.length === 0) return false;
    const isLarge = this.#layers.some(({ sheet }) => Math.max(...sidesOf(sheet.texture)) > kMinSize);
    const size = this.#size ?? (isLarge ? maxCompositeSize : kMinSize);
    const whole = size !== this.size || this.#stale.includes(kWhole);
    this.#target.setSize(size, size);
    // In texels: upsampling a smaller sheet spreads each of its texels over the neighbours.
    const margin = this.#layers.every(({ sheet }) => isSquare(sheet.texture, size)) ? 0 : 2;
    const rects = whole
      ? [toTexels(kWhole, size)]
      : disjoint(
          this.#stale.map((rect) => toTexels(rect, size, margin)),
          kMaxRects,
        );
    const first = this.#layers.length > kMaxAtOnce ? this.#layers.slice(0, kMaxAtOnce) : [];
    if (first.length > 0) {
      this.#below ??= new WebGLRenderTarget(size, size, kFormat);
      this.#below.setSize(size, size);
      this.#draw(renderer, this.#below, first, rects);
    }
    this.#draw(renderer, this.#target, this.#layers.slice(first.length), rects, first.length > 0);
    refreshMipmaps(renderer, this.#target, rects);
    this.#stale = [];
    return true;
  }

  /** The texels: premultiplied, in sRGB, row by row from v = 0. Waits for the GPU. */
  read(renderer: WebGLRenderer, texels = new Uint8Array(4 * this.size * this.size)): Uint8Array {
    renderer.readRenderTargetPixels(this.#target, 0, 0, this.size, this.size, texels);
    return texels;
  }

  /** Frees its GPU memory. */
  dispose(): void {
    this.#target.dispose();
    this.#masks.dispose();
    this.#below?.dispose();
    for (const pass of this.#passes.values()) pass.dispose();
    this.#passes.clear();
    this.#below = undefined;
    this.#stale = [kWhole];
  }

  /** Draws some layers, on nothing or on those below. */
  #draw(
    renderer: WebGLRenderer,
    target: WebGLRenderTarget,
    layers: readonly Layer[],
    rects: readonly Rect[],
    hasBelow = false,
  ): void {
    this.#fill(layers, hasBelow);
    const takes = layers.map(({ sheet }) => (isSquare(sheet.texture, target.width) ? 'whole' : 'spread'));
    const stroke = layers.findIndex(({ sheet }) => sheet === this.#strokeSheet);
    const masked = layers.map(({ region }) => region !== null);
    const recipe = { takes, masked, stroke, hasBelow, hasVideo: this.#uniforms.stored.value.includes(kVideo) };
    const key = JSON.stringify(recipe);
    let pass = this.#passes.get(key);
    if (!pass) this.#passes.set(key, (pass = new Pass(fragmentShader(recipe), this.#uniforms)));
    pass.run(renderer, target, rects);
  }

  #fill(layers: readonly Layer[], hasBelow: boolean): void {
    const { sheets, tints, blends, stored, masks, slices, stroke, below, strokeOpacity, strokeErases, size } =
      this.#uniforms;
    // Set all entries: a stale one could be the texture that is drawn to, which WebGL forbids.
    sheets.value = Array.from({ length: kMaxAtOnce }, (_, index) => layers[index]?.sheet.texture ?? null);
    below.value = hasBelow ? this.#below!.texture : null;
    stored.value.fill(0);
    const regions = [...new Set(this.#layers.flatMap(({ region }) => region ?? []))];
    masks.value = this.#masks.of(regions);
    layers.forEach(({ sheet, tint, opacity, blend, region }, index) => {
      checkColorSpace(sheet.texture);
      slices.value[index] = regions.indexOf(region!);
      const { r, g, b } = new Color(tint);
      tints.value[index]!.set(r, g, b, opacity);
      blends.value[index] = blendModes.indexOf(blend);
      const { isVideoTexture, colorSpace } = sheet.texture as Texture & { isVideoTexture?: true };
      stored.value[index] = sheet.premultiplied ? 1 : isVideoTexture && colorSpace === SRGBColorSpace ? kVideo : 0;
    });
    stroke.value = this.#stroke?.texture ?? null;
    strokeOpacity.value = this.#stroke?.opacity ?? 0;
    strokeErases.value = this.#stroke?.erases ?? false;
    size.value = this.size;
  }
}

function sidesOf({ image }: Texture): [width: number, height: number] {
  const { width = 0, height = 0 } = (image ?? {}) as { width?: number; height?: number };
  return [width, height];
}

const isSquare = (texture: Texture, side: number): boolean => sidesOf(texture).every((found) => found === side);
