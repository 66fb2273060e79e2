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
  RedIntegerFormat,
  RGBAFormat,
  type ShaderMaterialParameters,
  type Texture,
  Vector2,
  Vector3,
  type WebGLRenderer,
  type WebGLRenderTarget,
  ZeroFactor,
} from 'three';
import type { ActiveStroke } from '../layers/composite';
import { kMostRects, Pass } from '../layers/pass';
import { disjoint, type Rect, toShares, toTexels } from '../layers/rect';
import { type CageTexels, type Capsule, kFacing, kPatchTexels, type SurfacePoint } from './cage-texels';
import { makePaintTarget, type PaintedSheet } from './painted-sheet';

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
}

const kTableWidth = 1024; // a power of two
const kWithin = 0.999; // a safety margin, as the GPU computes in single precision
const kMostCapsules = 8; // per pass

/** @param size Texels a side. */
const surfacePointShader = (size: number): string => /* glsl */ `
uniform highp isampler2D owners;
uniform sampler2D patches;
const float kFacing = ${kFacing};

vec4 row(int patchIndex, int index) {
  int at = patchIndex * ${kPatchTexels} + index;
  return texelFetch(patches, ivec2(at & ${kTableWidth - 1}, at >> ${Math.log2(kTableWidth)}), 0);
}

// The point of the cage at this texel; in the gutter of a chart, the nearest point of its border. False where there is none.
bool surfacePoint(out vec3 point, out vec3 normal) {
  int owner = texelFetch(owners, ivec2(gl_FragCoord.xy), 0).r;
  if (owner < 0) return false;
  vec4 a = row(owner, 0), b = row(owner, 1), c = row(owner, 2), growth = row(owner, 3);
  vec2 from = gl_FragCoord.xy / ${size}.0 - vec2(a.w, b.w);
  vec2 shares = vec2(dot(from, growth.xy), dot(from, growth.zw));
  vec3 inside = max(vec3(1.0 - shares.x - shares.y, shares), 0.0);
  point = mat3(a.xyz, b.xyz, c.xyz) * inside / (inside.x + inside.y + inside.z);
  normal = row(owner, 4).xyz;
  return true;
}
`;

const brushShader = (size: number): string => /* glsl */ `
${surfacePointShader(size)}
uniform vec3 from[${kMostCapsules}];
uniform vec3 to[${kMostCapsules}];
uniform vec3 fromNormal[${kMostCapsules}];
uniform vec3 toNormal[${kMostCapsules}];
uniform int count;
uniform float radius;
uniform float hardness;
uniform vec3 paint;
out vec4 color;

void main() {
  vec3 point, normal;
  if (!surfacePoint(point, normal)) discard;
  float cover = 0.0;
  for (int i = 0; i < count; i++) {
    vec3 way = to[i] - from[i];
    float share = clamp(dot(point - from[i], way) / max(dot(way, way), 1e-30), 0.0, 1.0);
    if (dot(normal, mix(fromNormal[i], toNormal[i], share)) < kFacing) continue;
    cover = max(cover, 1.0 - smoothstep(hardness, 1.0, distance(point, from[i] + share * way) / radius));
  }
  if (cover == 0.0) discard;
  color = cover * vec4(paint, 1.0);
}
`;

const stickerShader = (size: number): string => /* glsl */ `
${surfacePointShader(size)}
uniform sampler2D picture;
uniform vec3 center;
uniform vec3 outward;
uniform vec3 right;
uniform vec3 up;
uniform vec2 extent;
uniform float texel; // the size of a texel of this texture, in texels of the picture
out vec4 color;

void main() {
  vec3 point, normal;
  if (!surfacePoint(point, normal)) discard;
  vec3 from = point - center;
  vec2 at = vec2(dot(from, right), -dot(from, up)) / extent + 0.5;
  // Skip what faces away or lies far behind: it is another surface that happens to be underneath.
  if (dot(normal, outward) < 0.1 || abs(dot(from, outward)) > 0.5 * max(extent.x, extent.y)) discard;
  if (any(lessThan(at, vec2(0.0))) || any(greaterThan(at, vec2(1.0)))) discard;
  color = textureLod(picture, at, log2(max(texel, 1.0)));
}
`;

const kCommitShader = /* glsl */ `
uniform sampler2D stroke;
uniform float opacity;
out vec4 color;
void main() { color = opacity * texelFetch(stroke, ivec2(gl_FragCoord.xy), 0); }
`;

const kClearShader = /* glsl */ `
out vec4 color;
void main() { color = vec4(0.0); }
`;

const blending = (
  blendEquation: typeof AddEquation | typeof MaxEquation,
  src: typeof OneFactor | typeof ZeroFactor,
  dst: typeof OneFactor | typeof OneMinusSrcAlphaFactor,
): ShaderMaterialParameters => ({
  blending: CustomBlending,
  blendEquation,
  blendSrc: src,
  blendDst: dst,
});

/** The stroke in progress: it is shown over a sheet but not part of it until `commit`. */
export class StrokeLayer {
  readonly #target: WebGLRenderTarget;
  readonly #brush: Pass<ReturnType<typeof brushUniforms>>;
  readonly #sticker: Pass<ReturnType<typeof stickerUniforms>>;
  readonly #lay = new Pass(kCommitShader, commitUniforms(), blending(AddEquation, OneFactor, OneMinusSrcAlphaFactor));
  readonly #erase = new Pass(
    kCommitShader,
    commitUniforms(),
    blending(AddEquation, ZeroFactor, OneMinusSrcAlphaFactor),
  );
  readonly #clear = new Pass(kClearShader, {});
  readonly #textures: readonly Texture[];
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
    this.#textures = [owners, patches];
    for (const texture of this.#textures) {
      texture.minFilter = texture.magFilter = NearestFilter;
      texture.unpackAlignment = 4;
      texture.needsUpdate = true;
    }
    this.#brush = new Pass(
      brushShader(size),
      brushUniforms(owners, patches),
      blending(MaxEquation, OneFactor, OneFactor),
    );
    this.#sticker = new Pass(stickerShader(size), stickerUniforms(owners, patches));
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

  /** Draws part of a brush stroke. @param capsules All of one radius. @returns The parts it touched, in shares. */
  stroke(renderer: WebGLRenderer, capsules: readonly Capsule[]): Rect[] {
    const rest = capsules.slice(kMostCapsules);
    if (rest.length > 0)
      return [...this.stroke(renderer, capsules.slice(0, kMostCapsules)), ...this.stroke(renderer, rest)];
    const { from, to, fromNormal, toNormal, count, radius, hardness, paint } = this.#brush.uniforms;
    capsules.forEach((capsule, index) => {
      from.value[index]!.copy(capsule.from.point);
      to.value[index]!.copy(capsule.to.point);
      fromNormal.value[index]!.copy(capsule.from.normal);
      toNormal.value[index]!.copy(capsule.to.normal);
      radius.value = capsule.radius;
    });
    count.value = capsules.length;
    // The hardest edge still fades over 1.5 texels, so that it shows no steps.
    hardness.value = Math.max(0, Math.min(this.#style.hardness, 1 - (1.5 * this.cageTexels.pitch) / radius.value));
    const { r, g, b } = new Color(this.#style.color);
    paint.value.set(r, g, b);
    const touched = capsules.flatMap((capsule) => this.cageTexels.touched(capsule, this.#full));
    const core = kWithin * hardness.value * radius.value;
    for (const capsule of capsules)
      for (const patch of this.cageTexels.enclosed({ ...capsule, radius: core })) this.#full.add(patch);
    return this.#draw(renderer, this.#brush, touched);
  }

  /** Draws a sticker in place of the stroke so far. @returns The parts that changed, in shares. */
  stick(renderer: WebGLRenderer, center: SurfacePoint, { texture, width, height, right, up }: Sticker): Rect[] {
    const before = this.clear(renderer);
    const { uniforms } = this.#sticker;
    uniforms.picture.value = texture;
    uniforms.center.value.copy(center.point);
    uniforms.outward.value.crossVectors(right, up);
    uniforms.right.value.copy(right);
    uniforms.up.value.copy(up);
    uniforms.extent.value.set(width, height);
    uniforms.texel.value = (this.cageTexels.pitch * (texture.image as { width: number }).width) / width;
    const radius = Math.hypot(width, height, Math.max(width, height)) / 2;
    const touched = this.cageTexels.touched({ from: center, to: center, radius }, new Set());
    return [...before, ...this.#draw(renderer, this.#sticker, touched)];
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
    const pass = this.#style.erases ? this.#erase : this.#lay;
    pass.uniforms.stroke.value = this.#target.texture;
    pass.uniforms.opacity.value = this.#style.opacity;
    const rects = this.#rects;
    pass.run(renderer, sheet.target, rects);
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
    for (const texture of this.#textures) texture.dispose();
    for (const pass of [this.#brush, this.#sticker, this.#lay, this.#erase, this.#clear]) pass.dispose();
  }

  #draw(renderer: WebGLRenderer, pass: { run: Pass<never>['run'] }, touched: readonly Rect[]): Rect[] {
    const rects = disjoint(
      touched.map((rect) => toTexels(rect, this.cageTexels.size)),
      kMostRects,
    );
    pass.run(renderer, this.#target, rects);
    this.#rects = disjoint([...this.#rects, ...rects], kMostRects);
    return rects.map((rect) => toShares(rect, this.cageTexels.size));
  }
}

function brushUniforms(owners: Texture, patches: Texture) {
  const vectors = (): Vector3[] => Array.from({ length: kMostCapsules }, () => new Vector3());
  return {
    owners: { value: owners },
    patches: { value: patches },
    from: { value: vectors() },
    to: { value: vectors() },
    fromNormal: { value: vectors() },
    toNormal: { value: vectors() },
    count: { value: 0 },
    radius: { value: 1 },
    hardness: { value: 1 },
    paint: { value: new Vector3() },
  };
}

function stickerUniforms(owners: Texture, patches: Texture) {
  return {
    owners: { value: owners },
    patches: { value: patches },
    picture: { value: null as Texture | null },
    center: { value: new Vector3() },
    outward: { value: new Vector3() },
    right: { value: new Vector3() },
    up: { value: new Vector3() },
    extent: { value: new Vector2() },
    texel: { value: 1 },
  };
}

function commitUniforms() {
  return { stroke: { value: null as Texture | null }, opacity: { value: 1 } };
}
