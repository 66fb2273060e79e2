import { Color, Matrix3, type Texture, type WebGLProgramParametersWithUniforms } from 'three';
import { checkColorSpace } from '../color-space.js';
import { addChannels } from './channel-shader.js';
import { channelsOf } from './channels.js';
import { withoutFringes } from './fringes.js';

type Shader = Pick<WebGLProgramParametersWithUniforms, 'vertexShader' | 'fragmentShader' | 'uniforms'>;

/**
 * What each vertex tells the shader: the UV of the paint; 0, or 1 if no triangle at it is painted; and 2 plus its distance from the
 * border of the paint along the surface. Where another mesh with the material lacks the attribute, WebGL reads (0, 0, 0, 1), which
 * means no paint, too.
 */
export const paintAttribute = '_cagecast_paint';

/** The paint of a model, as its materials read it: every change shows in the next frame. */
export interface Paint {
  texture: Texture | null | undefined;
  /** 0 to 1. */
  opacity: number;
  /** The width of the soft border, in the unit of the attribute's distances. */
  feather: number;
  /** For the shader: `refreshMatrix` brings it up to date. */
  matrix: Matrix3;
}

const kVertex = `attribute vec4 ${paintAttribute};
varying vec4 vCagecastPaint;
`;

// The last row of a transform of UVs is 0, 0, 1, so there is room for opacity, feather and how to decode: 1 for sRGB, 2 for
// colours that are multiplied by alpha.
// A triangle is painted if all its vertices are: what is interpolated from three zeros is exactly zero, on every GPU.
const kFragment = `#define CAGECAST_PAINT
varying vec4 vCagecastPaint;
uniform sampler2D cagecastMap;
uniform mat3 cagecastMatrix;
vec2 cagecastUv() { return (cagecastMatrix * vec3(vCagecastPaint.xy, 1.0)).xy; }
float cagecastShare() {
  float inside = vCagecastPaint.w - 2.0;
  float feather = cagecastMatrix[1].z;
  float border = feather > 0.0 ? smoothstep(0.0, feather, inside) : step(-0.5, inside);
  return cagecastMatrix[0].z * border * step(abs(vCagecastPaint.z), 1e-6);
}
vec4 cagecastTexel() {
  float stored = cagecastMatrix[2].z;
  vec4 texel = texture2D(cagecastMap, cagecastUv());
  vec3 linear = mix(pow((texel.rgb + 0.055) / 1.055, vec3(2.4)), texel.rgb / 12.92, vec3(lessThanEqual(texel.rgb, vec3(0.04045))));
  texel.rgb = mix(texel.rgb, linear, step(abs(stored - 1.0), 0.5));
  texel.rgb /= stored > 1.5 ? max(texel.a, 1e-4) : 1.0;
  texel.a *= cagecastShare();
  return texel;
}
`;

/** What the model's own colour is multiplied by: white costs nothing. */
const kTinted = `uniform vec3 cagecastTint;
vec3 cagecastBase() { return mix(vec3(1.0), cagecastTint, cagecastShare()); }
`;
const kMixed = `vec3 cagecastPaint(vec3 base) {
  vec4 texel = cagecastTexel();
  return mix(base, texel.rgb, texel.a);
}
`;

/** The line of three's shaders before which the colour of the surface is known, and nothing is lit yet. */
const kColorKnown = /^[ \t]*#include +<alphatest_fragment>/m;
const kMain = /void\s+main\s*\(\s*(?:void)?\s*\)\s*\{/;

/** MToon has a second colour, for what is in the shade: paint there differs from paint in the light as the two colours do. */
const kShadeKnown = /^[ \t]*material\.shadingShift = shadingShiftFactor;/m;
const kPaintShade = `
  vec4 cagecastShade = cagecastTexel();
  material.shadeColor = mix(BASE, cagecastShade.rgb * min(shadeColorFactor / max(litFactor, 1e-3), 1.0), cagecastShade.a);
`;

/** Whether a fragment shader asks for paint by itself. */
const asks = (fragmentShader: string): boolean => fragmentShader.includes('CAGECAST_PAINT');

/** Whether paint can be mixed into the colours that a shader lights. */
export const takesPaint = (fragmentShader: string): boolean =>
  asks(fragmentShader) || (kColorKnown.test(fragmentShader) && fragmentShader.includes('diffuseColor'));

/** The uniforms of a painted material: plain objects as three's own, since engines read all uniforms slower if some are not. */
export interface PaintUniforms {
  cagecastMap: { value: Texture | null };
  cagecastMatrix: { value: Matrix3 };
  cagecastTint: { value: Color };
  cagecastSurface: { value: Texture | null };
  cagecastGlow: { value: Texture | null };
  cagecastStrength: { value: number };
  cagecastNormals: { value: Texture | null };
}

const kWhite = /* @__PURE__ */ new Color();

export const paintUniforms = (): PaintUniforms => ({
  cagecastMap: { value: null },
  cagecastMatrix: { value: kNoPaint },
  cagecastTint: { value: kWhite },
  cagecastSurface: { value: null },
  cagecastGlow: { value: null },
  cagecastStrength: { value: 1 },
  cagecastNormals: { value: null },
});

/** Makes the uniforms of a material show a paint, or none. The matrix goes on following the paint by `refreshMatrix`. */
export function setUniforms(uniforms: PaintUniforms, paint: Paint | undefined): void {
  const texture = paint?.texture;
  const { tint, surface, glow, strength, normals } = channelsOf(texture);
  uniforms.cagecastMap.value = texture ? withoutFringes(texture) : null;
  uniforms.cagecastMatrix.value = texture ? paint.matrix : kNoPaint;
  uniforms.cagecastTint.value = tint ?? kWhite;
  uniforms.cagecastSurface.value = surface ?? null;
  uniforms.cagecastGlow.value = glow ?? null;
  uniforms.cagecastStrength.value = strength;
  uniforms.cagecastNormals.value = normals ?? null;
}

/** How paint is shown by a material. */
export interface Showing {
  /** Whether the paint is all that the material shows, with the opacity of the material; else it is mixed into its colour. */
  alone: boolean;
  /** The channels that it shows, as of `variantOf`. */
  variant: string;
}

/** Adds paint to a shader of three.js, before its includes are resolved; nothing if it has paint already. */
export function addPaint(shader: Shader, uniforms: PaintUniforms, { alone, variant }: Showing): void {
  // Another copy of this module may have added its own: this paint came later.
  Object.assign(shader.uniforms, uniforms);
  if (shader.vertexShader.includes(kVertex)) return;
  shader.vertexShader = kVertex + shader.vertexShader.replace(kMain, `$&\n  vCagecastPaint = ${paintAttribute};\n`);
  const isTinted = variant.includes('tint');
  const { shader: shown, functions } = addChannels(shader.fragmentShader, variant);
  shader.fragmentShader = shown;
  if (!asks(shown)) {
    const mixed = alone
      ? 'vec4 cagecastAlone = cagecastTexel();\n  diffuseColor = vec4(cagecastAlone.rgb, cagecastAlone.a * diffuseColor.a);'
      : 'diffuseColor.rgb = cagecastPaint(diffuseColor.rgb);';
    const shade = isTinted ? 'material.shadeColor * cagecastBase()' : 'material.shadeColor';
    shader.fragmentShader = shown
      .replace(kColorKnown, `  ${mixed}\n$&`)
      .replace(kShadeKnown, `${kPaintShade.replace('BASE', shade)}$&`);
  }
  const mixes = isTinted ? kTinted + kMixed.replace('mix(base', 'mix(base * cagecastBase()') : kMixed;
  shader.fragmentShader = kFragment + mixes + functions + shader.fragmentShader;
}

/** Brings the matrix of a paint up to date: the transform of its texture's UVs, and in its last row how much of the texture shows. */
export function refreshMatrix({ texture, opacity, feather, matrix }: Paint): void {
  if (!texture) return;
  checkColorSpace(texture);
  if (texture.matrixAutoUpdate) texture.updateMatrix();
  const { elements } = matrix.copy(texture.matrix);
  elements[2] = opacity;
  elements[5] = feather;
  // The GPU decodes all but videos. What is drawn, as by `createLayers`, may be premultiplied; it is no video.
  const isDrawn = (texture as { isRenderTargetTexture?: boolean }).isRenderTargetTexture;
  const isVideo = (texture as { isVideoTexture?: true }).isVideoTexture;
  const isPremultiplied = (isDrawn && texture.premultiplyAlpha) || texture.userData?.['cagecastPremultiplied'] === true;
  elements[8] = isPremultiplied ? 2 : isVideo && texture.colorSpace === 'srgb' ? 1 : 0;
}

/** The matrix of no paint. */
export const kNoPaint = /* @__PURE__ */ new Matrix3().set(0, 0, 0, 0, 0, 0, 0, 0, 0);
