import {
  AddEquation,
  Color,
  CustomBlending,
  DataTexture,
  FloatType,
  IntType,
  MaxEquation,
  NearestFilter,
  OneFactor,
  OneMinusSrcAlphaFactor,
  RedFormat,
  RedIntegerFormat,
  RGBAFormat,
  type ShaderMaterialParameters,
  type Texture,
  type Vector3,
  type WebGLRenderer,
  type WebGLRenderTarget,
} from 'three';
import { kMaxRects, Pass } from '../gpu/pass.js';
import { disjoint, type Rect, toShares, toTexels } from '../gpu/rect.js';
import type { ActiveStroke } from '../layers/layer-pass.js';
import { makePaintTarget, type PaintedSheet } from '../layers/painted-sheet.js';
import type { CageTexels, Capsule, SurfacePoint } from './cage-texels.js';
import { FillPass } from './fill-pass.js';
import {
  brushShader,
  brushUniforms,
  commitUniforms,
  kClearShader,
  kCommitShader,
  kEraseShader,
  kMaxCapsules,
  kTableWidth,
  stickerShader,
  stickerUniforms,
} from './stroke-shaders.js';

/** How one stroke or sticker is applied, from press to release. */
export interface StrokeStyle {
  /** #rrggbb */
  color: string;
  /** 0..1, of the whole stroke: it does not build up where the stroke crosses itself. */
  opacity: number;
  /** 0..1: the share of the radius with full paint; beyond it the edge fades. */
  hardness: number;
  erases: boolean;
}

/** An image projected onto the cage. */
export interface Sticker {
  texture: Texture;
  /** In the cage's space, as `height`. */
  width: number;
  height: number;
  /** Unit vectors towards its right and its top edge. */
  right: Vector3;
  up: Vector3;
  /** Whether it is seen as in a mirror. */
  mirrored?: boolean;
}

/** A sticker at a point of the cage. */
export interface LaidSticker {
  center: SurfacePoint;
  sticker: Sticker;
  /** 0..1 */
  opacity: number;
  /** Only there it is seen. */
  part?: StickerPart | undefined;
}

/** The part of a model that a sticker keeps to: UVs of triangles, 6 numbers for each. The same object for the same part. @internal */
export interface StickerPart {
  readonly uvs: ArrayLike<number>;
}

const kWithin = 0.999; // a safety margin, as the GPU computes in single precision
const kFade = 1.5; // texels that the hardest edge fades over, so that it shows no steps

const blending = (
  blendEquation: typeof AddEquation | typeof MaxEquation,
  dst: typeof OneFactor | typeof OneMinusSrcAlphaFactor,
): ShaderMaterialParameters => ({
  blending: CustomBlending,
  blendEquation,
  blendSrc: OneFactor,
  blendDst: dst,
});

/** The stroke in progress: it is shown over a sheet but not part of it until `commit`. */
export class StrokeLayer {
  readonly #target: WebGLRenderTarget;
  readonly #brush: Pass<ReturnType<typeof brushUniforms>>;
  /** Lays stickers over each other. */
  readonly #sticker: Pass<ReturnType<typeof stickerUniforms>>;
  readonly #fill: FillPass;
  readonly #lay = new Pass(kCommitShader, commitUniforms(), blending(AddEquation, OneMinusSrcAlphaFactor));
  readonly #erase = new Pass(kEraseShader, commitUniforms());
  readonly #copy = new Pass(kCommitShader, commitUniforms());
  /** What an eraser leaves, until it is copied to the sheet: a shader cannot read what it draws to. */
  #rest: WebGLRenderTarget | undefined;
  readonly #clear = new Pass(kClearShader, {});
  readonly #textures: readonly Texture[];
  /** The patches that a sticker gets to. */
  readonly #reached: DataTexture;
  /** The texels of a part. */
  #mask: { part: StickerPart; target: WebGLRenderTarget } | undefined;
  #style: StrokeStyle = { color: '#000000', opacity: 1, hardness: 1, erases: false };
  #sheet: PaintedSheet | undefined;
  /** The parts of the target that are not empty, in texels. */
  #rects: Rect[] = [];
  /** Patches of the cage that the stroke covers fully already; they are skipped. */
  readonly #full = new Set<number>();

  constructor(readonly cageTexels: CageTexels) {
    const { size } = cageTexels;
    this.#target = makePaintTarget(size);
    const owners = new DataTexture(cageTexels.owners, size, size, RedIntegerFormat, IntType);
    owners.internalFormat = 'R32I';
    const numbers = cageTexels.table();
    const rows = Math.max(1, Math.ceil(numbers.length / (4 * kTableWidth)));
    const table = new Float32Array(4 * kTableWidth * rows);
    table.set(numbers);
    const patches = new DataTexture(table, kTableWidth, rows, RGBAFormat, FloatType);
    this.#reached = new DataTexture(new Uint8Array(kTableWidth * rows), kTableWidth, rows, RedFormat);
    this.#textures = [owners, patches, this.#reached];
    for (const texture of this.#textures) {
      texture.minFilter = texture.magFilter = NearestFilter;
      texture.needsUpdate = true;
    }
    this.#brush = new Pass(brushShader(size), brushUniforms(owners, patches), blending(MaxEquation, OneFactor));
    this.#fill = new FillPass(size, owners, patches);
    this.#sticker = new Pass(
      stickerShader(size),
      stickerUniforms(owners, patches, this.#reached),
      blending(AddEquation, OneMinusSrcAlphaFactor),
    );
  }

  /** For the composite; undefined while no stroke is in progress. */
  get active(): ActiveStroke | undefined {
    const { opacity, erases } = this.#style;
    return this.#sheet && { sheet: this.#sheet, texture: this.#target.texture, opacity, erases };
  }

  /** Begins a stroke or a sticker over a sheet of the same size. */
  begin(sheet: PaintedSheet, style: StrokeStyle): void {
    this.#sheet = sheet;
    this.#style = style;
    this.#full.clear();
  }

  /** Draws part of a brush stroke. @returns The parts it touched, in shares. */
  stroke(renderer: WebGLRenderer, capsules: readonly Capsule[]): Rect[] {
    const rest = capsules.slice(kMaxCapsules);
    if (rest.length > 0)
      return [...this.stroke(renderer, capsules.slice(0, kMaxCapsules)), ...this.stroke(renderer, rest)];
    const { from, to, fromNormal, toNormal, radii, count, hardness, fade, paint } = this.#brush.uniforms;
    capsules.forEach((capsule, index) => {
      from.value[index]!.copy(capsule.from.point);
      to.value[index]!.copy(capsule.to.point);
      fromNormal.value[index]!.copy(capsule.from.normal);
      toNormal.value[index]!.copy(capsule.to.normal);
      radii.value[index]!.set(capsule.radius, capsule.toRadius ?? capsule.radius);
    });
    count.value = capsules.length;
    hardness.value = this.#style.hardness;
    fade.value = kFade * this.cageTexels.pitch;
    const { r, g, b } = new Color(this.#style.color);
    paint.value.set(r, g, b);
    const touched = capsules.flatMap((capsule) => this.cageTexels.touched(capsule, this.#full));
    // The part of a radius that is painted fully.
    const core = (radius: number): number =>
      kWithin * Math.max(0, Math.min(radius * hardness.value, radius - fade.value));
    for (const { radius, toRadius = radius, ...ends } of capsules) {
      const inner = { ...ends, radius: core(radius), toRadius: core(toRadius) };
      for (const patch of this.cageTexels.enclosed(inner)) this.#full.add(patch);
    }
    return this.#draw(renderer, this.#brush, touched);
  }

  /** Fills triangles of the texture. @param uvs 6 numbers per triangle. @returns The parts it touched, in shares. */
  fill(renderer: WebGLRenderer, uvs: ArrayLike<number>): Rect[] {
    return this.#add(this.#fill.run(renderer, this.#target, uvs, this.#style.color));
  }

  /** Draws a sticker in place of the stroke so far. @returns The parts that changed, in shares. */
  stick(renderer: WebGLRenderer, center: SurfacePoint, sticker: Sticker): Rect[] {
    const before = this.clear(renderer);
    this.#place(renderer, { center, sticker, opacity: 1 });
    return [...before, ...this.#draw(renderer, this.#sticker, this.reach(center, sticker))];
  }

  /** The parts of the texture that a sticker touches, in shares; conservative, and they may overlap. */
  reach(center: SurfacePoint, { width, height }: Sticker): Rect[] {
    const radius = Math.hypot(width, height, Math.max(width, height)) / 2 + this.cageTexels.pitch;
    return this.cageTexels.touched({ from: center, to: center, radius }, new Set());
  }

  /** Draws stickers over each other, in place of what some parts of a sheet show. @param rects In texels. */
  lay(
    renderer: WebGLRenderer,
    { target }: PaintedSheet,
    rects: readonly Rect[],
    stickers: readonly LaidSticker[],
  ): void {
    this.#clear.run(renderer, target, rects);
    for (const one of stickers) {
      this.#place(renderer, one);
      this.#sticker.run(renderer, target, rects);
    }
  }

  #place(renderer: WebGLRenderer, { center, sticker, opacity, part }: LaidSticker): void {
    const { uniforms } = this.#sticker;
    const { texture, width, height, right, up, mirrored = false } = sticker;
    uniforms.picture.value = texture;
    uniforms.center.value.copy(center.point);
    uniforms.outward.value.crossVectors(right, up);
    uniforms.right.value.copy(right).multiplyScalar(mirrored ? -1 : 1);
    uniforms.up.value.copy(up);
    uniforms.extent.value.set(width, height);
    uniforms.pitch.value = this.cageTexels.pitch;
    uniforms.texel.value = (this.cageTexels.pitch * (texture.image as { width: number }).width) / width;
    uniforms.opacity.value = opacity;
    (this.#reached.image.data as Uint8Array).set(this.cageTexels.reached(center, sticker));
    this.#reached.needsUpdate = true;
    uniforms.keeps.value = part !== undefined;
    uniforms.mask.value = part ? this.#maskOf(renderer, part) : null;
  }

  #maskOf(renderer: WebGLRenderer, part: StickerPart): Texture {
    const { size } = this.cageTexels;
    const target = this.#mask?.target ?? makePaintTarget(size);
    if (this.#mask?.part !== part) {
      this.#clear.run(renderer, target, [{ left: 0, top: 0, right: size, bottom: size }]);
      this.#fill.run(renderer, target, part.uvs, '#ffffff');
    }
    this.#mask = { part, target };
    return target.texture;
  }

  /** Clears the stroke so far. @returns The parts that had paint, in shares. */
  clear(renderer: WebGLRenderer): Rect[] {
    const rects = this.#rects;
    this.#rects = [];
    this.#clear.run(renderer, this.#target, rects);
    return rects.map((rect) => toShares(rect, this.cageTexels.size));
  }

  /**
   * Blends the stroke into its sheet and ends it.
   * @returns The bytes of each changed part before and after; `rect` in texels.
   */
  commit(renderer: WebGLRenderer): { rect: Rect; before: Uint8Array; after: Uint8Array }[] {
    const sheet = this.#sheet;
    if (!sheet) return [];
    const rects = this.#rects;
    const { erases, opacity } = this.#style;
    const [pass, target] = erases ? [this.#erase, this.#makeRest()] : [this.#lay, sheet.target];
    pass.uniforms.sheet.value = erases ? sheet.texture : null;
    pass.uniforms.stroke.value = this.#target.texture;
    pass.uniforms.opacity.value = opacity;
    pass.run(renderer, target, rects);
    if (erases) {
      this.#copy.uniforms.stroke.value = target.texture;
      this.#copy.run(renderer, sheet.target, rects);
    }
    this.end(renderer);
    return rects.map((rect) => ({ rect, before: sheet.get(rect), after: sheet.readBack(renderer, rect) }));
  }

  /** Discards the stroke. @returns The parts that had paint, in shares. */
  end(renderer: WebGLRenderer): Rect[] {
    this.#sheet = undefined;
    return this.clear(renderer);
  }

  /** Frees its GPU memory. */
  dispose(): void {
    this.#target.dispose();
    this.#rest?.dispose();
    this.#mask?.target.dispose();
    for (const texture of this.#textures) texture.dispose();
    for (const pass of [this.#fill, this.#brush, this.#sticker, this.#lay, this.#erase, this.#copy, this.#clear])
      pass.dispose();
  }

  #makeRest(): WebGLRenderTarget {
    return (this.#rest ??= makePaintTarget(this.cageTexels.size));
  }

  #draw(renderer: WebGLRenderer, pass: { run: Pass<never>['run'] }, touched: readonly Rect[]): Rect[] {
    const rects = disjoint(
      touched.map((rect) => toTexels(rect, this.cageTexels.size)),
      kMaxRects,
    );
    pass.run(renderer, this.#target, rects);
    return this.#add(rects);
  }

  /** Notes parts that are not empty any more. @returns them, in shares. */
  #add(rects: readonly Rect[]): Rect[] {
    this.#rects = disjoint([...this.#rects, ...rects], kMaxRects);
    return rects.map((rect) => toShares(rect, this.cageTexels.size));
  }
}
