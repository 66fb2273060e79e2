import { Matrix3, type Texture, type WebGLProgramParametersWithUniforms } from 'three';

type Shader = Pick<WebGLProgramParametersWithUniforms, 'vertexShader' | 'fragmentShader' | 'uniforms'>;

/**
 * What each vertex tells the shader: the UV of the paint; 0, or 1 if no triangle at it is painted; and 1 plus its distance from the
 * border of the paint along the surface. Without the attribute WebGL reads 0, which means no paint.
 */
export const paintAttribute = '_cagecast_paint';

/** The paint of a model, as its materials read it: every change shows in the next frame. */
export interface Paint {
  texture: Texture | undefined;
  /** 0 to 1. */
  opacity: number;
  /** The width of the soft border, in the unit of the attribute's distances. */
  feather: number;
}

const kVertex = `attribute vec4 ${paintAttribute};
varying vec4 vCagecastPaint;
`;

// A triangle is painted if all its vertices are: what is interpolated from three zeros is exactly zero, on every GPU.
const kFragment = `#define CAGECAST_PAINT
varying vec4 vCagecastPaint;
uniform sampler2D cagecastMap;
uniform mat3 cagecastPlace;
vec4 cagecastTexel() {
  // The last row of a transform of UVs is 0, 0, 1, so there is room for opacity, feather and whether to decode sRGB.
  vec3 amount = vec3(cagecastPlace[0].z, cagecastPlace[1].z, cagecastPlace[2].z);
  vec4 texel = texture2D(cagecastMap, (cagecastPlace * vec3(vCagecastPaint.xy, 1.0)).xy);
  vec3 linear = mix(pow((texel.rgb + 0.055) / 1.055, vec3(2.4)), texel.rgb / 12.92, vec3(lessThanEqual(texel.rgb, vec3(0.04045))));
  texel.rgb = mix(texel.rgb, linear, amount.z);
  float inside = vCagecastPaint.w - 1.0;
  float border = amount.y > 0.0 ? smoothstep(0.0, amount.y, inside) : step(-0.5, inside);
  texel.a *= amount.x * border * step(abs(vCagecastPaint.z), 1e-6);
  return texel;
}
vec3 cagecastPaint(vec3 base) {
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
  material.shadeColor = mix(material.shadeColor, cagecastShade.rgb * min(shadeColorFactor / max(litFactor, 1e-3), 1.0), cagecastShade.a);
`;

/** Whether a fragment shader asks for paint by itself. */
const asks = (fragmentShader: string): boolean => fragmentShader.includes('CAGECAST_PAINT');

/** Whether paint can be mixed into the colours that a shader lights. */
export const takesPaint = (fragmentShader: string): boolean =>
  asks(fragmentShader) || (kColorKnown.test(fragmentShader) && fragmentShader.includes('diffuseColor'));

/**
 * Adds paint to a shader of three.js, before its includes are resolved.
 * @param paintOf  The paint at the time of a frame.
 * @param alone    Whether the paint is all that the material shows, with the opacity of the material; else it is mixed into its colour.
 */
export function addPaint(shader: Shader, paintOf: () => Paint | undefined, alone: boolean): void {
  const place = new Matrix3();
  Object.assign(shader.uniforms, {
    cagecastMap: new LiveUniform(() => paintOf()?.texture ?? null),
    cagecastPlace: new LiveUniform(() => writePlace(place, paintOf())),
  });
  shader.vertexShader =
    kVertex + shader.vertexShader.replace(kMain, (main) => `${main}\n  vCagecastPaint = ${paintAttribute};\n`);
  if (!asks(shader.fragmentShader)) {
    const mixed = alone
      ? 'vec4 cagecastAlone = cagecastTexel();\n  diffuseColor = vec4(cagecastAlone.rgb, cagecastAlone.a * diffuseColor.a);'
      : 'diffuseColor.rgb = cagecastPaint(diffuseColor.rgb);';
    shader.fragmentShader = shader.fragmentShader
      .replace(kColorKnown, (line) => `  ${mixed}\n${line}`)
      .replace(kShadeKnown, (line) => `${kPaintShade}${line}`);
  }
  shader.fragmentShader = kFragment + shader.fragmentShader;
}

/** The names of the uniforms that `addPaint` adds. */
export const paintUniforms = ['cagecastMap', 'cagecastPlace'] as const;

/**
 * A uniform that is asked for its value whenever it is uploaded, so that nothing has to be told of a change. It is a class, because
 * objects with accessors of their own would make engines slow at reading all uniforms.
 */
class LiveUniform<T> {
  readonly #read: () => T;
  constructor(read: () => T) {
    this.#read = read;
  }
  get value(): T {
    return this.#read();
  }
}

/** Writes how a texture is placed, and how much of it shows. Runs for each material in each frame, so it makes nothing new. */
function writePlace(place: Matrix3, paint: Paint | undefined): Matrix3 {
  const out = place.elements;
  const texture = paint?.texture;
  if (!texture) return place.set(0, 0, 0, 0, 0, 0, 0, 0, 0);
  if (texture.matrixAutoUpdate) texture.updateMatrix();
  const from = texture.matrix.elements;
  for (let i = 0; i < 9; ++i) out[i] = from[i]!;
  out[2] = paint.opacity;
  out[5] = paint.feather;
  // The GPU decodes all but videos.
  out[8] = (texture as { isVideoTexture?: true }).isVideoTexture === true && texture.colorSpace === 'srgb' ? 1 : 0;
  return place;
}
