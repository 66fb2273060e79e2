import { kErased } from '../gpu/erased.js';
import type { Kind } from './kinds.js';

/** How layers are read. */
interface Recipe {
  /** What is drawn of them. */
  kind: Kind;
  /** How the normal map of each is sampled, where these are drawn. */
  reliefs: readonly ('whole' | 'spread')[];
  /** How each layer is sampled, from the lowest. */
  takes: readonly ('whole' | 'spread')[];
  /** Which of them are seen within a region only. */
  masked: readonly boolean[];
  /** Which of them carries a stroke; -1 for none. */
  stroke: number;
  /** Whether they lie on others. */
  hasBelow: boolean;
  /** Whether one of them is a video, which the GPU does not decode. */
  hasVideo: boolean;
}

// `stored` says how colours are stored: 0 straight, 1 premultiplied, 2 straight and in sRGB. `spread` is for a sheet of another size:
// bilinear, with premultiplied colours, so that transparent texels add no colour.
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
  normals: 'color.xy = mix(color.xy, tilted(relief#, values[#].xy), layer.a);',
};

const kRelief = /* glsl */ `
vec2 tilted(vec4 texel, vec2 scale) {
  vec3 normal = texel.rgb * 2.0 - 1.0;
  // Some compressed ones have red and green only.
  if (texel.b == 0.0) normal.z = sqrt(max(0.0, 1.0 - dot(normal.xy, normal.xy)));
  return normalize(vec3(normal.xy * scale, max(normal.z, 1e-3))).xy;
}

vec2 relief(vec2 stored) { return (stored * 255.0 - 128.0) / 127.0; }
vec2 unrelief(vec2 normal) { return (normal * 127.0 + 128.0) / 255.0; }
`;

/** A shader for exactly these layers: software renderers execute every branch, taken or not. */
export function fragmentShader({ kind, takes, reliefs, masked, stroke, hasBelow, hasVideo }: Recipe): string {
  const most = Math.max(1, takes.length);
  const isRelief = kind === 'normals';
  const soak = (take: string): string => `soak = strokeOpacity * ${take}(stroke, 1);
  layer = strokeErases ? erased(layer, soak.a) : layer * (1.0 - soak.a) + soak;`;
  const steps = takes.map(
    (take, index) => /* glsl */ `
  layer = ${take}(sheets[${index}], stored[${index}]);
  ${index === stroke ? soak(take) : ''}
  ${masked[index] ? `layer *= texture(masks, vec3(gl_FragCoord.xy / float(size), slices[${index}])).r;` : ''}
  layer *= vec4(tints[${index}].rgb, 1.0) * tints[${index}].a;
  ${isRelief ? `vec4 relief${index} = ${reliefs[index]}(normals[${index}], 1);` : ''}
  ${kMix[kind].replaceAll('#', String(index))}`,
  );
  // A tint's alpha is the opacity.
  return /* glsl */ `${hasVideo ? '#define HAS_VIDEO' : ''}
uniform sampler2D sheets[${most}];
${isRelief ? `uniform sampler2D normals[${most}];` : ''}
uniform vec4 tints[${most}];
uniform vec4 values[${most}];
uniform int blends[${most}];
uniform int stored[${most}];
uniform float slices[${most}];
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
