import {
  Color,
  LinearFilter,
  LinearMipmapLinearFilter,
  RepeatWrapping,
  SRGBColorSpace,
  Vector4,
  WebGLRenderTarget,
  type IUniform,
  type Texture,
  type WebGLRenderer,
} from 'three'
import { kBlends, type Layer, type Sheet } from './layer'
import { refreshMipmaps } from './mipmaps'
import { kMostRects, Pass } from './pass'
import { apart, kWhole, toTexels, type Rect } from './rect'

export const kMostLayers = 8
const kLeastSize = 1024 // texels a side
export const kMostSize = 2048

/** Paint that is still wet: what a stroke lays over one sheet, or takes off it, until it is settled. */
export interface Wet {
  sheet: Sheet
  /** Premultiplied, in the size of the sheet. */
  texture: Texture
  /** 0..1, of the stroke as a whole. */
  opacity: number
  erases: boolean
}

// Each of the four is a separable blend mode of “Compositing and Blending Level 1” (W3C), in linear light, with colours
// multiplied by alpha: layer·(1 − α below) + below·(1 − α layer) + α layer·α below·B, where B is, of the colours proper,
// normal: layer, multiply: layer·below, screen: layer + below − layer·below, add: min(1, layer + below).
const fragmentShader = (most: number): string => /* glsl */ `
uniform sampler2D sheets[${most}];
uniform vec4 tints[${most}]; // and the opacity
uniform int blends[${most}];
uniform bool premultiplied[${most}];
uniform int count;
uniform sampler2D wet;
uniform int wetSheet; // -1 for none
uniform float wetOpacity;
uniform bool wetErases;
uniform int size;
out vec4 color;

vec4 texel(sampler2D sheet, ivec2 at, bool isPremultiplied) {
  ivec2 sides = textureSize(sheet, 0);
  vec4 found = texelFetch(sheet, (at + sides) % sides, 0);
  return isPremultiplied ? found : vec4(found.rgb * found.a, found.a);
}

// Colours are multiplied by alpha before they are mixed: what is transparent has no colour to give.
vec4 take(sampler2D sheet, bool isPremultiplied) {
  ivec2 sides = textureSize(sheet, 0);
  if (sides == ivec2(size)) return texel(sheet, ivec2(gl_FragCoord.xy), isPremultiplied);
  vec2 at = gl_FragCoord.xy / float(size) * vec2(sides) - 0.5;
  ivec2 corner = ivec2(floor(at));
  vec2 share = at - vec2(corner);
  return mix(
    mix(texel(sheet, corner, isPremultiplied), texel(sheet, corner + ivec2(1, 0), isPremultiplied), share.x),
    mix(texel(sheet, corner + ivec2(0, 1), isPremultiplied), texel(sheet, corner + ivec2(1, 1), isPremultiplied), share.x),
    share.y
  );
}

vec4 join(vec4 layer, vec4 below, int blend) {
  vec3 both = layer.rgb * below.a;
  if (blend == 1) both = layer.rgb * below.rgb;
  if (blend == 2) both = layer.rgb * below.a + below.rgb * layer.a - layer.rgb * below.rgb;
  if (blend == 3) both = min(vec3(layer.a * below.a), layer.rgb * below.a + below.rgb * layer.a);
  return vec4(layer.rgb * (1.0 - below.a) + below.rgb * (1.0 - layer.a) + both, layer.a + below.a * (1.0 - layer.a));
}

void main() {
  color = vec4(0.0);
  vec4 layer;
  #pragma unroll_loop_start
  for (int i = 0; i < ${most}; i ++) {
    if (UNROLLED_LOOP_INDEX < count) {
      layer = take(sheets[UNROLLED_LOOP_INDEX], premultiplied[UNROLLED_LOOP_INDEX]);
      if (UNROLLED_LOOP_INDEX == wetSheet) {
        vec4 paint = wetOpacity * take(wet, true);
        layer = layer * (1.0 - paint.a) + (wetErases ? vec4(0.0) : paint);
      }
      layer *= vec4(tints[UNROLLED_LOOP_INDEX].rgb, 1.0) * tints[UNROLLED_LOOP_INDEX].a;
      color = join(layer, color, blends[UNROLLED_LOOP_INDEX]);
    }
  }
  #pragma unroll_loop_end
}
`

/**
 * What layers look like together: a texture with mipmaps, its colours multiplied by alpha, as filtering wants them.
 * It is made when `update` is called after a change, and only as far as things changed.
 */
export class Composite {
  readonly #target = new WebGLRenderTarget(kLeastSize, kLeastSize, {
    colorSpace: SRGBColorSpace,
    depthBuffer: false,
    generateMipmaps: true,
    minFilter: LinearMipmapLinearFilter,
    magFilter: LinearFilter,
    wrapS: RepeatWrapping,
    wrapT: RepeatWrapping,
    anisotropy: 8,
  })
  readonly #uniforms = {
    sheets: { value: [] as (Texture | null)[] },
    tints: { value: Array.from({ length: kMostLayers }, () => new Vector4()) },
    blends: { value: new Array<number>(kMostLayers).fill(0) },
    premultiplied: { value: new Array<boolean>(kMostLayers).fill(false) },
    count: { value: 0 },
    wet: { value: null as Texture | null },
    wetSheet: { value: -1 },
    wetOpacity: { value: 1 },
    wetErases: { value: false },
    size: { value: kLeastSize },
  }
  /** For one layer, as most have, and for all: the shader for eight takes a second longer to make, where the processor draws. */
  readonly #one: Pass<Record<string, IUniform>> = new Pass(fragmentShader(1), this.#uniforms)
  #all: Pass<Record<string, IUniform>> | undefined
  #layers: readonly Layer[] = []
  #wet: Wet | undefined
  /** What changed since the last update, in shares of the texture. */
  #stale: Rect[] = [kWhole]

  constructor() {
    // Done here, for the part that changed: the renderer would do all of it, after every stroke of a brush.
    this.#target.texture.mipmapsAutoUpdate = false
  }

  /** The same for as long as this lives. sRGB, premultiplied, its first row at v = 0. */
  get texture(): Texture {
    return this.#target.texture
  }

  /** Texels a side: as many as the largest of the layers asks for. */
  get size(): number {
    return this.#target.width
  }

  /** @param layers From the lowest to the uppermost, at most `kMostLayers`. */
  set(layers: readonly Layer[]): void {
    this.#layers = layers.filter(({ visible, opacity }) => visible && opacity > 0)
    this.#stale = [kWhole]
  }

  /** Notes that texels of a sheet are others now. @param rects In shares. @param wet What lies wet on a sheet by now, if anything. */
  touch(rects: readonly Rect[], wet?: Wet): void {
    this.#wet = wet
    this.#stale.push(...rects)
  }

  /** Makes again what is stale. @returns Whether anything was. */
  update(renderer: WebGLRenderer): boolean {
    if (this.#stale.length === 0) return false
    const size = this.#layers.some(({ sheet }) => sideOf(sheet.texture) > kLeastSize) ? kMostSize : kLeastSize
    const whole = size !== this.size || this.#stale.includes(kWhole)
    this.#target.setSize(size, size)
    // A texel more: a sheet with fewer texels than this spreads each over its neighbours.
    const rects = whole ? [toTexels(kWhole, this.size)] : apart(this.#stale.map((rect) => toTexels(rect, this.size, 2)), kMostRects)
    this.#stale = []
    this.#fill()
    const pass = this.#layers.length > 1 ? (this.#all ??= new Pass(fragmentShader(kMostLayers), this.#uniforms)) : this.#one
    pass.run(renderer, this.#target, rects)
    refreshMipmaps(renderer, this.#target, rects)
    return true
  }

  #fill(): void {
    const { sheets, tints, blends, premultiplied, count, wet, wetSheet, wetOpacity, wetErases, size } = this.#uniforms
    // All of them are set: one left over from before could be the texture that is drawn to.
    sheets.value = Array.from({ length: kMostLayers }, (_, index) => this.#layers[index]?.sheet.texture ?? null)
    this.#layers.forEach(({ sheet, tint, opacity, blend }, index) => {
      const { r, g, b } = new Color(tint)
      tints.value[index]!.set(r, g, b, opacity)
      blends.value[index] = kBlends.indexOf(blend)
      premultiplied.value[index] = sheet.premultiplied ?? false
    })
    count.value = this.#layers.length
    wet.value = this.#wet?.texture ?? null
    wetSheet.value = this.#layers.findIndex(({ sheet }) => sheet === this.#wet?.sheet)
    wetOpacity.value = this.#wet?.opacity ?? 1
    wetErases.value = this.#wet?.erases ?? false
    size.value = this.size
  }
}

function sideOf({ image }: Texture): number {
  const { width = 0, height = 0 } = (image ?? {}) as { width?: number; height?: number }
  return Math.max(width, height)
}
