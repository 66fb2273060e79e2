import { type IUniform, type Texture, Vector2, Vector3 } from 'three';
import { kErased } from '../gpu/erased.js';
import { kFacing, kPatchTexels } from './cage-texels.js';

export const kTableWidth = 1024; // a power of two
export const kMaxCapsules = 8; // per pass

/**
 * `surfacePoint` finds the point of the cage at this texel; in the gutter of a chart, the nearest point of its border. It is false where
 * there is none.
 * @param size Texels a side.
 */
const surfacePointShader = (size: number): string => /* glsl */ `
uniform highp isampler2D owners;
uniform sampler2D patches;
const float kFacing = ${kFacing};

vec4 row(int patchIndex, int index) {
  int at = patchIndex * ${kPatchTexels} + index;
  return texelFetch(patches, ivec2(at & ${kTableWidth - 1}, at >> ${Math.log2(kTableWidth)}), 0);
}

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

// `radii` are those at both ends, `fade` is the least width of the edge.
export const brushShader = (size: number): string => /* glsl */ `
${surfacePointShader(size)}
uniform vec3 from[${kMaxCapsules}];
uniform vec3 to[${kMaxCapsules}];
uniform vec3 fromNormal[${kMaxCapsules}];
uniform vec3 toNormal[${kMaxCapsules}];
uniform vec2 radii[${kMaxCapsules}];
uniform int count;
uniform float hardness;
uniform float fade;
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
    float radius = mix(radii[i].x, radii[i].y, share);
    float hard = clamp(1.0 - fade / radius, 0.0, hardness);
    cover = max(cover, 1.0 - smoothstep(hard, 1.0, distance(point, from[i] + share * way) / radius));
  }
  if (cover == 0.0) discard;
  color = cover * vec4(paint, 1.0);
}
`;

// `pitch` is the length of a texel in space, `texel` the same in texels of the picture. What faces away, lies far behind or is not reached
// is left out: it is another surface that happens to be underneath or beside it. Each texel takes `kSamples` samples a side, as one of a smaller level would blur thin
// lines, and be jagged in the narrow direction of a long text.
export const stickerShader = (size: number): string => /* glsl */ `
${surfacePointShader(size)}
uniform sampler2D picture;
uniform sampler2D reached;
uniform sampler2D mask;
uniform bool keeps;
uniform vec3 center;
uniform vec3 outward;
uniform vec3 right;
uniform vec3 up;
uniform vec2 extent;
uniform float pitch;
uniform float texel;
uniform float opacity;
const int kSamples = 4;
out vec4 color;

void main() {
  vec3 point, normal;
  if (!surfacePoint(point, normal)) discard;
  int owner = texelFetch(owners, ivec2(gl_FragCoord.xy), 0).r;
  if (texelFetch(reached, ivec2(owner & ${kTableWidth - 1}, owner >> ${Math.log2(kTableWidth)}), 0).r == 0.0) discard;
  if (keeps && texelFetch(mask, ivec2(gl_FragCoord.xy), 0).a == 0.0) discard;
  vec3 from = point - center;
  vec2 at = vec2(dot(from, right), -dot(from, up)) / extent + 0.5;
  vec2 reach = pitch / extent;
  if (dot(normal, outward) < 0.1 || abs(dot(from, outward)) > 0.5 * max(extent.x, extent.y)) discard;
  if (any(lessThan(at, -reach)) || any(greaterThan(at, 1.0 + reach))) discard;
  float level = log2(max(texel / float(kSamples), 1.0));
  color = vec4(0.0);
  for (int i = 0; i < kSamples * kSamples; i++) {
    vec2 offset = (vec2(i % kSamples, i / kSamples) + 0.5) / float(kSamples) - 0.5;
    vec2 spot = at + offset * reach;
    if (all(greaterThan(spot, vec2(0.0))) && all(lessThan(spot, vec2(1.0)))) color += textureLod(picture, spot, level);
  }
  color *= opacity / float(kSamples * kSamples);
}
`;

export const fillShader = (size: number): string => /* glsl */ `
${surfacePointShader(size)}
uniform vec3 paint;
uniform bool guttersOnly;
out vec4 color;

void main() {
  int owner = texelFetch(owners, ivec2(gl_FragCoord.xy), 0).r;
  if (owner < 0) discard;
  if (guttersOnly) {
    vec4 growth = row(owner, 3);
    vec2 from = gl_FragCoord.xy / ${size}.0 - vec2(row(owner, 0).w, row(owner, 1).w);
    vec2 shares = vec2(dot(from, growth.xy), dot(from, growth.zw));
    if (min(1.0 - shares.x - shares.y, min(shares.x, shares.y)) > -1e-6) discard;
  }
  color = vec4(paint, 1.0);
}
`;

export const kCommitShader = /* glsl */ `
uniform sampler2D stroke;
uniform float opacity;
out vec4 color;
void main() { color = opacity * texelFetch(stroke, ivec2(gl_FragCoord.xy), 0); }
`;

export const kEraseShader = /* glsl */ `
uniform sampler2D sheet;
uniform sampler2D stroke;
uniform float opacity;
out vec4 color;
${kErased}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  color = erased(texelFetch(sheet, at, 0), opacity * texelFetch(stroke, at, 0).a);
}
`;

export const kClearShader = /* glsl */ `
out vec4 color;
void main() { color = vec4(0.0); }
`;

export function brushUniforms(owners: Texture, patches: Texture) {
  const vectors = (): Vector3[] => Array.from({ length: kMaxCapsules }, () => new Vector3());
  return {
    owners: { value: owners } as IUniform<Texture>,
    patches: { value: patches } as IUniform<Texture>,
    from: { value: vectors() },
    to: { value: vectors() },
    fromNormal: { value: vectors() },
    toNormal: { value: vectors() },
    radii: { value: Array.from({ length: kMaxCapsules }, () => new Vector2()) },
    count: { value: 0 },
    hardness: { value: 1 },
    fade: { value: 0 },
    paint: { value: new Vector3() },
  };
}

export function stickerUniforms(owners: Texture, patches: Texture, reached: Texture) {
  return {
    reached: { value: reached } as IUniform<Texture>,
    mask: { value: null as Texture | null },
    keeps: { value: false },
    owners: { value: owners } as IUniform<Texture>,
    patches: { value: patches } as IUniform<Texture>,
    picture: { value: null as Texture | null },
    center: { value: new Vector3() },
    outward: { value: new Vector3() },
    right: { value: new Vector3() },
    up: { value: new Vector3() },
    extent: { value: new Vector2() },
    pitch: { value: 1 },
    texel: { value: 1 },
    opacity: { value: 1 },
  };
}

export function commitUniforms() {
  return { sheet: { value: null as Texture | null }, stroke: { value: null as Texture | null }, opacity: { value: 1 } };
}
