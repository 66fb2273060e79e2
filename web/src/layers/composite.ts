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
import { kBlends, type Layer, type Sheet } from './layer';
import { refreshMipmaps } from './mipmaps';
import { kMostRects, Pass } from './pass';
import { apart, kWhole, type Rect, toTexels } from './rect';

export const kMostLayers = 8;
const kLeastSize = 1024; // texels a side
export const kMostSize = 2048;

/** Paint that is still wet: what a stroke lays over one sheet, or takes off it, until it is settled. */
export interface Wet {
  sheet: Sheet;
  /** Premultiplied, in the size of the sheet. */
  texture: Texture;
  /** 0..1, of the stroke as a whole. */
  opacity: number;
  erases: boolean;
}

// Each of the four is a separable blend mode of “Compositing and Blending Level 1” (W3C), in linear light, with colours
// multiplied by alpha: layer·(1 − α below) + below·(1 − α layer) + α layer·α below·B, where B is, of the colours proper,
// normal: layer, multiply: layer·below, screen: layer + below − layer·below, add: min(1, layer + below).
const kFunctions = /* glsl */ `
vec4 texel(sampler2D sheet, ivec2 at, bool isPremultiplied) {
  vec4 found = texelFetch(sheet, at, 0);
  return isPremultiplied ? found : vec4(found.rgb * found.a, found.a);
}

vec4 whole(sampler2D sheet, bool isPremultiplied) {
  return texel(sheet, ivec2(gl_FragCoord.xy), isPremultiplied);
}

// Of a sheet with another number of texels. Colours are multiplied by alpha before they are mixed: what is transparent has
// no colour to give.
vec4 spread(sampler2D sheet, bool isPremultiplied) {
  ivec2 sides = textureSize(sheet, 0);
  vec2 at = gl_FragCoord.xy / float(size) * vec2(sides) - 0.5;
  ivec2 least = (ivec2(floor(at)) + sides) % sides;
  ivec2 most = (least + 1) % sides;
  vec2 share = fract(at);
  return mix(
    mix(texel(sheet, least, isPremultiplied), texel(sheet, ivec2(most.x, least.y), isPremultiplied), share.x),
    mix(texel(sheet, ivec2(least.x, most.y), isPremultiplied), texel(sheet, most, isPremultiplied), share.x),
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
`;

/** How the texels of each layer are taken, from the lowest, and which of them may be wet: -1 for none. */
interface Recipe {
  takes: readonly ('whole' | 'spread')[];
  wet: number;
}

/** A shader for these layers and no others: a processor that draws goes through every branch of one, needed or not. */
function fragmentShader({ takes, wet }: Recipe): string {
  const most = Math.max(1, takes.length);
  const steps = takes.map(
    (take, index) => /* glsl */ `
  layer = ${take}(sheets[${index}], premultiplied[${index}]);
  ${index === wet ? `soak = wetOpacity * ${take}(wet, true);\n  layer = layer * (1.0 - soak.a) + (wetErases ? vec4(0.0) : soak);` : ''}
  layer *= vec4(tints[${index}].rgb, 1.0) * tints[${index}].a;
  color = join(layer, color, blends[${index}]);`,
  );
  return /* glsl */ `
uniform sampler2D sheets[${most}];
uniform vec4 tints[${most}]; // and the opacity
uniform int blends[${most}];
uniform bool premultiplied[${most}];
uniform sampler2D wet;
uniform float wetOpacity;
uniform bool wetErases;
uniform int size;
out vec4 color;
${kFunctions}
void main() {
  vec4 layer, soak;
  color = vec4(0.0);${steps.join('')}
}
`;
}

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
  });
  readonly #uniforms = {
    sheets: { value: [] as (Texture | null)[] },
    tints: { value: Array.from({ length: kMostLayers }, () => new Vector4()) },
    blends: { value: new Array<number>(kMostLayers).fill(0) },
    premultiplied: { value: new Array<boolean>(kMostLayers).fill(false) },
    wet: { value: null as Texture | null },
    wetOpacity: { value: 1 },
    wetErases: { value: false },
    size: { value: kLeastSize },
  };
  /** By recipe. */
  readonly #passes = new Map<string, Pass<Record<string, IUniform>>>();
  #layers: readonly Layer[] = [];
  #wet: Wet | undefined;
  /** What was wet last: it will be again. */
  #wetSheet: Sheet | undefined;
  /** What changed since the last update, in shares of the texture. */
  #stale: Rect[] = [kWhole];

  constructor() {
    // Done here, for the part that changed: the renderer would do all of it, after every stroke of a brush.
    this.#target.texture.mipmapsAutoUpdate = false;
  }

  /** The same for as long as this lives. sRGB, premultiplied, its first row at v = 0. */
  get texture(): Texture {
    return this.#target.texture;
  }

  /** Texels a side: as many as the largest of the layers asks for. */
  get size(): number {
    return this.#target.width;
  }

  /** @param layers From the lowest to the uppermost, at most `kMostLayers`. */
  set(layers: readonly Layer[]): void {
    this.#layers = layers.filter(({ visible, opacity }) => visible && opacity > 0);
    this.#stale = [kWhole];
  }

  /** Notes that texels of a sheet are others now. @param rects In shares. @param wet What lies wet on a sheet by now, if anything. */
  touch(rects: readonly Rect[], wet?: Wet): void {
    this.#wet = wet;
    this.#wetSheet = wet?.sheet ?? this.#wetSheet;
    this.#stale.push(...rects);
  }

  /** Makes again what is stale. @returns Whether anything was. */
  update(renderer: WebGLRenderer): boolean {
    if (this.#stale.length === 0) return false;
    const size = this.#layers.some(({ sheet }) => Math.max(...sidesOf(sheet.texture)) > kLeastSize)
      ? kMostSize
      : kLeastSize;
    const whole = size !== this.size || this.#stale.includes(kWhole);
    this.#target.setSize(size, size);
    // Texels more: a sheet with fewer of them than this spreads each over its neighbours.
    const margin = this.#layers.every(({ sheet }) => isSquare(sheet.texture, size)) ? 0 : 2;
    const rects = whole
      ? [toTexels(kWhole, size)]
      : apart(
          this.#stale.map((rect) => toTexels(rect, size, margin)),
          kMostRects,
        );
    this.#stale = [];
    this.#fill();
    this.#pass().run(renderer, this.#target, rects);
    refreshMipmaps(renderer, this.#target, rects);
    return true;
  }

  #pass(): Pass<Record<string, IUniform>> {
    const takes = this.#layers.map(({ sheet }) => (isSquare(sheet.texture, this.size) ? 'whole' : 'spread'));
    const recipe = { takes, wet: this.#layers.findIndex(({ sheet }) => sheet === this.#wetSheet) };
    const key = JSON.stringify(recipe);
    let pass = this.#passes.get(key);
    if (!pass) this.#passes.set(key, (pass = new Pass(fragmentShader(recipe), this.#uniforms)));
    return pass;
  }

  #fill(): void {
    const { sheets, tints, blends, premultiplied, wet, wetOpacity, wetErases, size } = this.#uniforms;
    // All of them are set: one left over from before could be the texture that is drawn to.
    sheets.value = Array.from({ length: kMostLayers }, (_, index) => this.#layers[index]?.sheet.texture ?? null);
    this.#layers.forEach(({ sheet, tint, opacity, blend }, index) => {
      const { r, g, b } = new Color(tint);
      tints.value[index]!.set(r, g, b, opacity);
      blends.value[index] = kBlends.indexOf(blend);
      premultiplied.value[index] = sheet.premultiplied ?? false;
    });
    wet.value = this.#wet?.texture ?? null;
    wetOpacity.value = this.#wet?.opacity ?? 0;
    wetErases.value = this.#wet?.erases ?? false;
    size.value = this.size;
  }
}

function sidesOf({ image }: Texture): [width: number, height: number] {
  const { width = 0, height = 0 } = (image ?? {}) as { width?: number; height?: number };
  return [width, height];
}

const isSquare = (texture: Texture, side: number): boolean => sidesOf(texture).every((found) => found === side);
