import { kErased } from '../gpu/index.js';

/** How each layer is sampled, from the lowest, which of them carries a stroke (-1 for none), and whether they lie on others. */
export interface Recipe {
  takes: readonly ('whole' | 'spread')[];
  stroke: number;
  hasBelow: boolean;
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

/** A shader for exactly these layers: software renderers execute every branch, taken or not. */
export function fragmentShader({ takes, stroke, hasBelow }: Recipe): string {
  const most = Math.max(1, takes.length);
  const soak = (take: string): string => `soak = strokeOpacity * ${take}(stroke, true);
  layer = strokeErases ? erased(layer, soak.a) : layer * (1.0 - soak.a) + soak;`;
  const steps = takes.map(
    (take, index) => /* glsl */ `
  layer = ${take}(sheets[${index}], premultiplied[${index}]);
  ${index === stroke ? soak(take) : ''}
  layer *= vec4(tints[${index}].rgb, 1.0) * tints[${index}].a;
  color = join(layer, color, blends[${index}]);`,
  );
  return /* glsl */ `
uniform sampler2D sheets[${most}];
uniform vec4 tints[${most}]; // and the opacity
uniform int blends[${most}];
uniform bool premultiplied[${most}];
uniform sampler2D stroke;
uniform sampler2D below;
uniform float strokeOpacity;
uniform bool strokeErases;
uniform int size;
out vec4 color;
${kFunctions}${kErased}
void main() {
  vec4 layer, soak;
  color = ${hasBelow ? 'texelFetch(below, ivec2(gl_FragCoord.xy), 0)' : 'vec4(0.0)'};${steps.join('')}
}
`;
}
