import { NoColorSpace, type Texture, Vector2, type WebGLRenderer, WebGLRenderTarget } from 'three';
import { Pass } from './pass.js';

// Bilinear, but not by `texture`: with anisotropic filtering, some drivers blur even what has the same size.
const kShader = /* glsl */ `
uniform sampler2D source;
uniform int level;
uniform vec2 size;
uniform int stored;
out vec4 color;

vec3 decode(vec3 srgb) {
  return mix(pow((srgb + 0.055) / 1.055, vec3(2.4)), srgb / 12.92, lessThanEqual(srgb, vec3(0.04045)));
}

vec4 texel(ivec2 at) {
  vec4 found = texelFetch(source, clamp(at, ivec2(0), textureSize(source, level) - 1), level);
  if (stored == 2) found.rgb = decode(found.rgb);
  return stored == 0 || stored == 2 ? vec4(found.rgb * found.a, found.a) : found;
}

vec3 encode(vec3 linear) {
  return mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
}

void main() {
  vec2 at = gl_FragCoord.xy / size * vec2(textureSize(source, level)) - 0.5;
  ivec2 least = ivec2(floor(at));
  vec4 lower = mix(texel(least), texel(least + ivec2(1, 0)), at.x - float(least.x));
  vec4 upper = mix(texel(least + ivec2(0, 1)), texel(least + 1), at.x - float(least.x));
  vec4 found = mix(lower, upper, at.y - float(least.y));
  if (stored == 3) color = vec4(found.rgb, 1.0);
  else color = found.a > 0.0 ? vec4(encode(min(found.rgb / found.a, 1.0)), found.a) : vec4(0.0);
}
`;

/** How a texture has its colours: straight, multiplied by alpha, straight and in sRGB as videos are, or data instead of colours. @internal */
export const Stored = { straight: 0, premultiplied: 1, video: 2, data: 3 } as const;

// By renderer, as what it has drawn with holds it.
const passes = new WeakMap<WebGLRenderer, Pass<ReturnType<typeof uniforms>>>();
const uniforms = () => ({
  source: { value: null as Texture | null },
  level: { value: 0 },
  size: { value: new Vector2() },
  stored: { value: 0 },
});

/**
 * Reads a texture as an image file has it: sRGB, colours not multiplied by alpha, the row at v = 0 first. Waits for the GPU.
 * @param size    Pixels a side of the image, or its width and height.
 * @param stored  One of `Stored`. Only of what is premultiplied, as layers are, the mipmaps are read. Data is read as it is.
 * @internal
 */
export function readStraight(
  renderer: WebGLRenderer,
  source: Texture,
  size: number | readonly [width: number, height: number],
  stored: number = Stored.premultiplied,
): ImageData {
  const [width, height] = typeof size === 'number' ? [size, size] : size;
  const target = new WebGLRenderTarget(width, height, { colorSpace: NoColorSpace, depthBuffer: false });
  const pass = passes.get(renderer) ?? new Pass(kShader, uniforms());
  passes.set(renderer, pass);
  pass.uniforms.source.value = source;
  pass.uniforms.size.value.set(width, height);
  pass.uniforms.stored.value = stored;
  // The smallest level with at least as many texels a side.
  const hasLevels = source.generateMipmaps && stored === Stored.premultiplied;
  const ratio = (source.image as { width: number }).width / width;
  pass.uniforms.level.value = hasLevels ? Math.max(0, Math.floor(Math.log2(ratio))) : 0;
  pass.run(renderer, target, [{ left: 0, top: 0, right: width, bottom: height }]);
  pass.uniforms.source.value = null;
  const image = new ImageData(width, height);
  renderer.readRenderTargetPixels(target, 0, 0, width, height, image.data);
  target.dispose();
  return image;
}
