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
import { disjoint, kWhole, type Rect, toTexels } from './rect';

export const kMostLayers = 8;
const kLeastSize = 1024; // texels per side
export const kMostSize = 2048;

/** A stroke in progress: shown over one sheet, or erased from it, until it is committed. */
export interface ActiveStroke {
  sheet: Sheet;
  /** Premultiplied, of the same size as the sheet. */
  texture: Texture;
  /** 0..1, of the whole stroke. */
  opacity: number;
  erases: boolean;
}

// All four are separable blend modes of “Compositing and Blending Level 1” (W3C), in linear light, with colours
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

// For a sheet of another size: bilinear, with premultiplied colours, so that transparent texels add no colour.
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

/** How each layer is sampled, from the lowest, and which of them carries a stroke: -1 for none. */
interface Recipe {
  takes: readonly ('whole' | 'spread')[];
  stroke: number;
}

/** A shader for exactly these layers: software renderers execute every branch, taken or not. */
function fragmentShader({ takes, stroke }: Recipe): string {
  const most = Math.max(1, takes.length);
  const steps = takes.map(
    (take, index) => /* glsl */ `
  layer = ${take}(sheets[${index}], premultiplied[${index}]);
  ${index === stroke ? `soak = strokeOpacity * ${take}(stroke, true);\n  layer = layer * (1.0 - soak.a) + (strokeErases ? vec4(0.0) : soak);` : ''}
  layer *= vec4(tints[${index}].rgb, 1.0) * tints[${index}].a;
  color = join(layer, color, blends[${index}]);`,
  );
  return /* glsl */ `
uniform sampler2D sheets[${most}];
uniform vec4 tints[${most}]; // and the opacity
uniform int blends[${most}];
uniform bool premultiplied[${most}];
uniform sampler2D stroke;
uniform float strokeOpacity;
uniform bool strokeErases;
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
 * The layers blended into one texture, with mipmaps and premultiplied alpha. `update` redraws it after a change, and only the
 * parts that changed.
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
    stroke: { value: null as Texture | null },
    strokeOpacity: { value: 1 },
    strokeErases: { value: false },
    size: { value: kLeastSize },
  };
  /** By recipe. */
  readonly #passes = new Map<string, Pass<Record<string, IUniform>>>();
  #layers: readonly Layer[] = [];
  #stroke: ActiveStroke | undefined;
  /** The sheet of the last stroke: the next stroke is likely to use it, and its shader. */
  #strokeSheet: Sheet | undefined;
  /** The parts that changed since the last update, in shares. */
  #stale: Rect[] = [kWhole];

  constructor() {
    // `refreshMipmaps` updates the changed parts; the renderer would rebuild all levels for every stroke.
    this.#target.texture.mipmapsAutoUpdate = false;
  }

  /** Always the same object. sRGB, premultiplied alpha, first row at v = 0. */
  get texture(): Texture {
    return this.#target.texture;
  }

  /** Texels per side: as many as the largest layer needs. */
  get size(): number {
    return this.#target.width;
  }

  /** @param layers From the lowest to the uppermost, at most `kMostLayers`. */
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

  /** Redraws what changed. @returns Whether anything did. */
  update(renderer: WebGLRenderer): boolean {
    if (this.#stale.length === 0) return false;
    const size = this.#layers.some(({ sheet }) => Math.max(...sidesOf(sheet.texture)) > kLeastSize)
      ? kMostSize
      : kLeastSize;
    const whole = size !== this.size || this.#stale.includes(kWhole);
    this.#target.setSize(size, size);
    // In texels: upsampling a smaller sheet spreads each of its texels over the neighbours.
    const margin = this.#layers.every(({ sheet }) => isSquare(sheet.texture, size)) ? 0 : 2;
    const rects = whole
      ? [toTexels(kWhole, size)]
      : disjoint(
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
    const recipe = { takes, stroke: this.#layers.findIndex(({ sheet }) => sheet === this.#strokeSheet) };
    const key = JSON.stringify(recipe);
    let pass = this.#passes.get(key);
    if (!pass) this.#passes.set(key, (pass = new Pass(fragmentShader(recipe), this.#uniforms)));
    return pass;
  }

  #fill(): void {
    const { sheets, tints, blends, premultiplied, stroke, strokeOpacity, strokeErases, size } = this.#uniforms;
    // Set all entries: a stale one could be the texture that is drawn to, which WebGL forbids.
    sheets.value = Array.from({ length: kMostLayers }, (_, index) => this.#layers[index]?.sheet.texture ?? null);
    this.#layers.forEach(({ sheet, tint, opacity, blend }, index) => {
      const { r, g, b } = new Color(tint);
      tints.value[index]!.set(r, g, b, opacity);
      blends.value[index] = kBlends.indexOf(blend);
      premultiplied.value[index] = sheet.premultiplied ?? false;
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
