import { kErased } from '../gpu/erased.js';
import type { Kind } from './kinds.js';

/** How a sheet is sampled: of the size of the texture, of another one, or lying elsewhere. */
type Take = 'whole' | 'spread' | 'moved';

/** How layers are read. */
interface Recipe {
  /** What is drawn of them. */
  kind: Kind;
  /** How the normal map of each is sampled, where these are drawn. */
  reliefs: readonly Take[];
  /** How each layer is sampled, from the lowest. */
  takes: readonly Take[];
  /** Which of them are seen within a region only. */
  masked: readonly boolean[];
  /** Which of them carries a stroke; -1 for none. */
  stroke: number;
  /** Whether they lie on others. */
  hasBelow: boolean;
  /** Whether one of them is a video, which the GPU does not decode. */
  hasVideo: boolean;
}

// `stored` says how colours are stored: 0 straight, 1 premultiplied, 2 straight and in sRGB, 3 data. `spread` is for a sheet of another size:
// bilinear, with premultiplied colours, so that transparent texels add no colour. `moved` is for one that lies elsewhere, as a matrix says,
// in whose last row is at how many places along each side of a texel it is read; nothing lies beyond its border.
//
// All four of `join` are separable blend modes of “Compositing and Blending Level 1” (W3C), in linear light, with colours
// multiplied by alpha: layer·(1 − α below) + below·(1 − α layer) + α layer·α below·B, where B is, of the colours proper,
// normal: layer, multiply: layer·below, screen: layer + below − layer·below, add: min(1, layer + below).
const kFunctions = /* glsl */ `
vec4 texel(sampler2D sheet, ivec2 at, int stored) {
  vec4 found = texelFetch(sheet, at, 0);
#ifdef HAS_VIDEO
  vec3 linear = mix(pow((found.rgb + 0.055) / 1.055, vec3(2.4)), found.rgb / 12.92, vec3(lessThanEqual(found.rgb, vec3(0.04045))));
  if (stored == 2) found.rgb = linear;
#endif
  if (stored == 3) return vec4(found.rgb, 1.0);
  return stored == 1 ? found : vec4(found.rgb * found.a, found.a);
}

vec4 whole(sampler2D sheet, int stored) {
  return texel(sheet, ivec2(gl_FragCoord.xy), stored);
}

vec4 spread(sampler2D sheet, int stored) {
  ivec2 sides = textureSize(sheet, 0);
  vec2 at = gl_FragCoord.xy / float(size) * vec2(sides) - 0.5;
  ivec2 least = (ivec2(floor(at)) + sides) % sides;
  ivec2 most = (least + 1) % sides;
  vec2 share = fract(at);
  return mix(
    mix(texel(sheet, least, stored), texel(sheet, ivec2(most.x, least.y), stored), share.x),
    mix(texel(sheet, ivec2(least.x, most.y), stored), texel(sheet, most, stored), share.x),
    share.y
  );
}

#ifdef HAS_MOVED
vec4 inside(sampler2D sheet, ivec2 at, int stored) {
  bool lies = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, textureSize(sheet, 0)));
  return lies ? texel(sheet, at, stored) : vec4(0.0);
}

vec4 moved(sampler2D sheet, int stored, mat3 place) {
  int samples = int(place[0].z);
  vec4 sum = vec4(0.0);
  for (int i = 0; i < samples * samples; ++i) {
    vec2 part = (vec2(i % samples, i / samples) + 0.5) / float(samples) - 0.5;
    vec2 uv = (place * vec3((gl_FragCoord.xy + part) / float(size), 1.0)).xy;
    vec2 at = uv * vec2(textureSize(sheet, 0)) - 0.5;
    ivec2 least = ivec2(floor(at));
    vec2 share = fract(at);
    sum += mix(
      mix(inside(sheet, least, stored), inside(sheet, least + ivec2(1, 0), stored), share.x),
      mix(inside(sheet, least + ivec2(0, 1), stored), inside(sheet, least + 1, stored), share.x),
      share.y
    );
  }
  return sum / float(samples * samples);
}

vec4 movedRelief(sampler2D sheet, mat3 place) {
  vec4 found = moved(sheet, 3, place);
  return vec4(found.a > 0.0 ? found.rgb / found.a : vec3(0.5, 0.5, 1.0), 1.0);
}
#endif

vec4 join(vec4 layer, vec4 below, int blend) {
  vec3 both = layer.rgb * below.a;
  if (blend == 1) both = layer.rgb * below.rgb;
  if (blend == 2) both = layer.rgb * below.a + below.rgb * layer.a - layer.rgb * below.rgb;
  if (blend == 3) both = min(vec3(layer.a * below.a), layer.rgb * below.a + below.rgb * layer.a);
  return vec4(layer.rgb * (1.0 - below.a) + below.rgb * (1.0 - layer.a) + both, layer.a + below.a * (1.0 - layer.a));
}
`;

// What a layer, multiplied by its alpha, makes of what was drawn. The texture of the surface has a pair for roughness and one for
// metalness: the value, multiplied by how much it covers what is below, and how much that is. Normals are x and y of unit vectors;
// without any, a byte is 128, which is exactly 0 in `relief`.
const kMix: Record<Kind, string> = {
  color: 'color = join(layer, color, blends[#]);',
  surface: `share = layer.a * values[#].yyww;
  color = color * (1.0 - share) + vec4(values[#].x, 1.0, values[#].z, 1.0) * share;`,
  glow: 'color.rgb = color.rgb * (1.0 - layer.a * values[#].y) + layer.rgb * values[#].x;',
  normals: 'color.xy = mix(color.xy, tilted(relief#, values[#]), layer.a);',
};

const kRelief = /* glsl */ `
vec2 tilted(vec4 texel, vec4 how) {
  vec3 normal = texel.rgb * 2.0 - 1.0;
  // Some compressed ones have red and green only.
  if (texel.b == 0.0) normal.z = sqrt(max(0.0, 1.0 - dot(normal.xy, normal.xy)));
  return mat2(how.z, how.w, -how.w, how.z) * normalize(vec3(normal.xy * how.xy, max(normal.z, 1e-3))).xy;
}

vec2 relief(vec2 stored) { return (stored * 255.0 - 128.0) / 127.0; }
vec2 unrelief(vec2 normal) { return (normal * 127.0 + 128.0) / 255.0; }
`;

const placeOf = (take: Take, index: number): string => (take === 'moved' ? `, places[${index}]` : '');

const reliefOf = (take: Take, index: number): string =>
  take === 'moved' ? `movedRelief(normals[${index}], places[${index}])` : `${take}(normals[${index}], 1)`;

/** A shader for exactly these layers: software renderers execute every branch, taken or not. */
export function fragmentShader({ kind, takes, reliefs, masked, stroke, hasBelow, hasVideo }: Recipe): string {
  const most = Math.max(1, takes.length);
  const isRelief = kind === 'normals';
  const soak = (take: Take, index: number): string => `soak = strokeOpacity * ${take}(stroke, 1${placeOf(take, index)});
  layer = strokeErases ? erased(layer, soak.a) : layer * (1.0 - soak.a) + soak;`;
  const steps = takes.map(
    (take, index) => /* glsl */ `
  layer = ${take}(sheets[${index}], stored[${index}]${placeOf(take, index)});
  ${index === stroke ? soak(take, index) : ''}
  ${masked[index] ? `layer *= texture(masks, vec3(gl_FragCoord.xy / float(size), slices[${index}])).r;` : ''}
  layer *= vec4(tints[${index}].rgb, 1.0) * tints[${index}].a;
  ${isRelief ? `vec4 relief${index} = ${reliefOf(reliefs[index]!, index)};` : ''}
  ${kMix[kind].replaceAll('#', String(index))}`,
  );
  // A tint's alpha is the opacity.
  return /* glsl */ `${hasVideo ? '#define HAS_VIDEO' : ''}
${takes.includes('moved') ? '#define HAS_MOVED' : ''}
uniform sampler2D sheets[${most}];
${isRelief ? `uniform sampler2D normals[${most}];` : ''}
uniform vec4 tints[${most}];
uniform vec4 values[${most}];
uniform int blends[${most}];
uniform int stored[${most}];
uniform float slices[${most}];
uniform mat3 places[${most}];
uniform highp sampler2DArray masks;
uniform sampler2D stroke;
uniform sampler2D below;
uniform float strokeOpacity;
uniform bool strokeErases;
uniform int size;
out vec4 color;
${kFunctions}${kErased}${isRelief ? kRelief : ''}
void main() {
  vec4 layer, soak, share;
  color = ${hasBelow ? 'texelFetch(below, ivec2(gl_FragCoord.xy), 0)' : 'vec4(0.0)'};
  ${isRelief && hasBelow ? 'color.xy = relief(color.xy);' : ''}${steps.join('')}
  ${isRelief ? 'color.xy = unrelief(color.xy);' : ''}
}
`;
}
