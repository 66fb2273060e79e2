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
import type { Wet } from '../layers/composite';
import { kMostRects, Pass } from '../layers/pass';
import { apart, type Rect, toShares, toTexels } from '../layers/rect';
import { type CageAtlas, type Capsule, kFacing, kPatchTexels, type Place } from './atlas';
import { makePaintTarget, type PaintedSheet } from './painted-sheet';

/** What is laid on in one go, from a press to the release. */
export interface StrokeStyle {
  /** #rrggbb */
  color: string;
  /** 0..1, of the stroke as a whole: where it crosses itself it does not get thicker. */
  opacity: number;
  /** 0..1: how much of the radius is paint in full. */
  hardness: number;
  erases: boolean;
}

/** A picture that is stuck on the cage. */
export interface Sticker {
  texture: Texture;
  /** Its width, in the cage's space. */
  width: number;
  height: number;
  /** Where its right and its top point. Of length 1. */
  right: Vector3;
  up: Vector3;
}

const kTableWidth = 1024; // a power of two
const kWithin = 0.999; // the GPU reckons in single precision
const kMostCapsules = 8; // in one pass

/** @param size Texels a side. */
const placeShader = (size: number): string => /* glsl */ `
uniform highp isampler2D owners;
uniform sampler2D patches;
const float kFacing = ${kFacing};

vec4 row(int patchIndex, int index) {
  int at = patchIndex * ${kPatchTexels} + index;
  return texelFetch(patches, ivec2(at & ${kTableWidth - 1}, at >> ${Math.log2(kTableWidth)}), 0);
}

// The place of the cage at this texel; around an island, the place on its border. False where there is none.
bool place(out vec3 point, out vec3 normal) {
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
${placeShader(size)}
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
  if (!place(point, normal)) discard;
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
${placeShader(size)}
uniform sampler2D picture;
uniform vec3 center;
uniform vec3 outward;
uniform vec3 right;
uniform vec3 up;
uniform vec2 extent;
uniform float texel; // how large one of this texture is, in the picture's texels
out vec4 color;

void main() {
  vec3 point, normal;
  if (!place(point, normal)) discard;
  vec3 from = point - center;
  vec2 at = vec2(dot(from, right), -dot(from, up)) / extent + 0.5;
  // What faces away, or is far behind, is another thing that happens to lie below.
  if (dot(normal, outward) < 0.1 || abs(dot(from, outward)) > 0.5 * max(extent.x, extent.y)) discard;
  if (any(lessThan(at, vec2(0.0))) || any(greaterThan(at, vec2(1.0)))) discard;
  color = textureLod(picture, at, log2(max(texel, 1.0)));
}
`;

const kSettleShader = /* glsl */ `
uniform sampler2D wet;
uniform float opacity;
out vec4 color;
void main() { color = opacity * texelFetch(wet, ivec2(gl_FragCoord.xy), 0); }
`;

const kDryShader = /* glsl */ `
out vec4 color;
void main() { color = vec4(0.0); }
`;

const joined = (
  blendEquation: typeof AddEquation | typeof MaxEquation,
  src: typeof OneFactor | typeof ZeroFactor,
  dst: typeof OneFactor | typeof OneMinusSrcAlphaFactor,
): ShaderMaterialParameters => ({
  blending: CustomBlending,
  blendEquation,
  blendSrc: src,
  blendDst: dst,
});

/** Paint that is being laid on: it covers a sheet without being part of it, until it is settled. */
export class WetPaint {
  readonly #target: WebGLRenderTarget;
  readonly #brush: Pass<ReturnType<typeof brushUniforms>>;
  readonly #sticker: Pass<ReturnType<typeof stickerUniforms>>;
  readonly #lay = new Pass(kSettleShader, settleUniforms(), joined(AddEquation, OneFactor, OneMinusSrcAlphaFactor));
  readonly #erase = new Pass(kSettleShader, settleUniforms(), joined(AddEquation, ZeroFactor, OneMinusSrcAlphaFactor));
  readonly #dry = new Pass(kDryShader, {});
  readonly #textures: readonly Texture[];
  #style: StrokeStyle = { color: '#000000', opacity: 1, hardness: 1, erases: false };
  #sheet: PaintedSheet | undefined;
  /** What of the target is not empty, in texels. */
  #rects: Rect[] = [];
  /** Patches of the cage that have paint in full: there is nothing to add. */
  readonly #full = new Set<number>();

  constructor(readonly atlas: CageAtlas) {
    const { size } = atlas;
    this.#target = makePaintTarget(size);
    const owners = new DataTexture(atlas.owners, size, size, RedIntegerFormat, IntType);
    owners.internalFormat = 'R32I';
    const numbers = atlas.table();
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
      joined(MaxEquation, OneFactor, OneFactor),
    );
    this.#sticker = new Pass(stickerShader(size), stickerUniforms(owners, patches));
  }

  /** What the composite is to show; nothing while nothing is laid. */
  get wet(): Wet | undefined {
    const { opacity, erases } = this.#style;
    return this.#sheet && { sheet: this.#sheet, texture: this.#target.texture, opacity, erases };
  }

  /** Begins a stroke, or a sticker, over a sheet of as many texels. */
  begin(sheet: PaintedSheet, style: StrokeStyle): void {
    this.#sheet = sheet;
    this.#style = style;
    this.#full.clear();
  }

  /** Draws a brush's way; all of one radius. @returns The parts it touched, in shares. */
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
    // The hardest edge is as soft as a texel is wide: no steps are seen.
    hardness.value = Math.max(0, Math.min(this.#style.hardness, 1 - (1.5 * this.atlas.pitch) / radius.value));
    const { r, g, b } = new Color(this.#style.color);
    paint.value.set(r, g, b);
    const touched = capsules.flatMap((capsule) => this.atlas.touched(capsule, this.#full));
    const core = kWithin * hardness.value * radius.value;
    for (const capsule of capsules)
      for (const patch of this.atlas.enclosed({ ...capsule, radius: core })) this.#full.add(patch);
    return this.#draw(renderer, this.#brush, touched);
  }

  /** Puts a sticker in place of what is wet. @returns The parts that changed, in shares. */
  stick(renderer: WebGLRenderer, center: Place, { texture, width, height, right, up }: Sticker): Rect[] {
    const before = this.dry(renderer);
    const { uniforms } = this.#sticker;
    uniforms.picture.value = texture;
    uniforms.center.value.copy(center.point);
    uniforms.outward.value.crossVectors(right, up);
    uniforms.right.value.copy(right);
    uniforms.up.value.copy(up);
    uniforms.extent.value.set(width, height);
    uniforms.texel.value = (this.atlas.pitch * (texture.image as { width: number }).width) / width;
    const radius = Math.hypot(width, height, Math.max(width, height)) / 2;
    const touched = this.atlas.touched({ from: center, to: center, radius }, new Set());
    return [...before, ...this.#draw(renderer, this.#sticker, touched)];
  }

  /** Takes all wet paint away. @returns The parts that had some, in shares. */
  dry(renderer: WebGLRenderer): Rect[] {
    const rects = this.#rects;
    this.#rects = [];
    this.#dry.run(renderer, this.#target, rects);
    return rects.map((rect) => toShares(rect, this.atlas.size));
  }

  /**
   * Makes what is wet part of its sheet, and ends the stroke.
   * @returns What it was and is, for each part that changed, in texels.
   */
  settle(renderer: WebGLRenderer): { rect: Rect; before: Uint8Array; after: Uint8Array }[] {
    const sheet = this.#sheet;
    if (!sheet) return [];
    const pass = this.#style.erases ? this.#erase : this.#lay;
    pass.uniforms.wet.value = this.#target.texture;
    pass.uniforms.opacity.value = this.#style.opacity;
    const rects = this.#rects;
    pass.run(renderer, sheet.target, rects);
    this.end(renderer);
    return rects.map((rect) => ({ rect, before: sheet.get(rect), after: sheet.take(renderer, rect) }));
  }

  /** Ends the stroke without a trace. @returns The parts that had some, in shares. */
  end(renderer: WebGLRenderer): Rect[] {
    this.#sheet = undefined;
    return this.dry(renderer);
  }

  /** Frees its memory. */
  dispose(): void {
    this.#target.dispose();
    for (const texture of this.#textures) texture.dispose();
    for (const pass of [this.#brush, this.#sticker, this.#lay, this.#erase, this.#dry]) pass.dispose();
  }

  #draw(renderer: WebGLRenderer, pass: { run: Pass<never>['run'] }, touched: readonly Rect[]): Rect[] {
    const rects = apart(
      touched.map((rect) => toTexels(rect, this.atlas.size)),
      kMostRects,
    );
    pass.run(renderer, this.#target, rects);
    this.#rects = apart([...this.#rects, ...rects], kMostRects);
    return rects.map((rect) => toShares(rect, this.atlas.size));
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

function settleUniforms() {
  return { wet: { value: null as Texture | null }, opacity: { value: 1 } };
}
