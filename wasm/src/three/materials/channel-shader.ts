/** The line of three's shaders that includes a part. */
const after = (part: string): RegExp => new RegExp(`^[ \\t]*#include +<${part}>`, 'm');

const kSurface = /* glsl */ `
uniform sampler2D cagecastSurface;
vec4 cagecastSurfaceTexel() { return cagecastShare() * texture2D(cagecastSurface, cagecastUv()); }
`;

const kGlow = /* glsl */ `
uniform sampler2D cagecastGlow;
uniform float cagecastStrength;
vec3 cagecastGlowTexel() { return cagecastShare() * cagecastStrength * texture2D(cagecastGlow, cagecastUv()).rgb; }
`;

// The tangents are those of three's `getTangentFrame`, which shaders without a normal map lack.
const kNormals = /* glsl */ `
uniform sampler2D cagecastNormals;
vec3 cagecastNormal(vec3 normal, vec3 eye, float side) {
  vec2 uv = cagecastUv();
  vec2 tilt = cagecastShare() * (texture2D(cagecastNormals, uv).xy * 255.0 - 128.0) / 127.0;
  vec3 x = dFdx(eye), y = dFdy(eye);
  vec2 uvX = dFdx(uv), uvY = dFdy(uv);
  vec3 acrossY = cross(y, normal), acrossX = cross(normal, x);
  vec3 tangent = acrossY * uvX.x + acrossX * uvY.x;
  vec3 bitangent = acrossY * uvX.y + acrossX * uvY.y;
  float most = max(dot(tangent, tangent), dot(bitangent, bitangent));
  float scale = most == 0.0 ? 0.0 : side * inversesqrt(most);
  float up = sqrt(max(0.0, 1.0 - dot(tilt, tilt)));
  return normalize(scale * (tangent * tilt.x + bitangent * tilt.y) + normal * up);
}
`;

/** Where a channel is mixed in: a line of shaders, and what stands in its place. */
type Places = readonly (readonly [line: RegExp, instead: string])[];

/** MToon of three-vrm has normals and glow in lines of its own, before this one. */
const kToonKnown = /^[ \t]*#ifdef DEBUG_NORMAL/m;

const kSurfacePlaces: Places = [
  [
    after('roughnessmap_fragment'),
    `$&
  vec4 cagecastRough = cagecastSurfaceTexel();
  roughnessFactor = roughnessFactor * (1.0 - cagecastRough.g) + cagecastRough.r;`,
  ],
  [
    after('metalnessmap_fragment'),
    `$&
  vec4 cagecastMetal = cagecastSurfaceTexel();
  metalnessFactor = metalnessFactor * (1.0 - cagecastMetal.a) + cagecastMetal.b;`,
  ],
];

const kAddGlow = '  totalEmissiveRadiance += cagecastGlowTexel();';
const kGlowPlaces: Places = [
  [after('emissivemap_fragment'), `$&\n${kAddGlow}`],
  [kToonKnown, `${kAddGlow}\n$&`],
];

const kTilt = `  #ifdef DOUBLE_SIDED
    normal = cagecastNormal(normal, -vViewPosition, faceDirection);
  #else
    normal = cagecastNormal(normal, -vViewPosition, 1.0);
  #endif`;
const kNormalPlaces: Places = [
  [after('normal_fragment_maps'), `$&\n${kTilt}`],
  [kToonKnown, `${kTilt}\n$&`],
];

/**
 * Adds to a fragment shader of three.js what it shows of the channels of a paint; what a kind of material lacks, such as roughness,
 * stays out.
 * @param variant  As of `variantOf`.
 * @returns the shader, and the functions that it calls; those call the ones of the paint.
 */
export function addChannels(fragmentShader: string, variant: string): { shader: string; functions: string } {
  let [shader, functions] = [fragmentShader, ''];
  for (const [name, code, places] of [
    ['surface', kSurface, kSurfacePlaces],
    ['glow', kGlow, kGlowPlaces],
    ['normals', kNormals, kNormalPlaces],
  ] as const) {
    if (!variant.includes(name)) continue;
    const before = shader;
    for (const [line, instead] of places) shader = shader.replace(line, instead);
    if (shader !== before) functions += code;
  }
  return { shader, functions };
}
