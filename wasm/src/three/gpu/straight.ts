import { NoColorSpace, type Texture, type WebGLRenderer, WebGLRenderTarget } from 'three';
import { Pass } from './pass.js';
import { kWhole, toTexels } from './rect.js';

// Bilinear, but not by `texture`: with anisotropic filtering, some drivers blur even what has the same size.
const kShader = /* glsl */ `
uniform sampler2D source;
uniform int level;
uniform float size;
uniform bool isData;
out vec4 color;

vec4 texel(ivec2 at) {
  return texelFetch(source, clamp(at, ivec2(0), textureSize(source, level) - 1), level);
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
  if (isData) color = vec4(found.rgb, 1.0);
  else color = found.a > 0.0 ? vec4(encode(min(found.rgb / found.a, 1.0)), found.a) : vec4(0.0);
}
`;

// By renderer, as what it has drawn with holds it.
const passes = new WeakMap<WebGLRenderer, Pass<ReturnType<typeof uniforms>>>();
const uniforms = () => ({
  source: { value: null as Texture | null },
  level: { value: 0 },
  size: { value: 1 },
  isData: { value: false },
});

/**
 * Reads a premultiplied texture as an image file has it: sRGB, colours not multiplied by alpha, upper row first.
 * Waits for the GPU.
 * @param size    Pixels a side of the image.
 * @param isData  Whether it has data instead of colours, which are read as they are. Default: false.
 * @internal
 */
export function readStraight(renderer: WebGLRenderer, source: Texture, size: number, isData = false): ImageData {
  const target = new WebGLRenderTarget(size, size, { colorSpace: NoColorSpace, depthBuffer: false });
  const pass = passes.get(renderer) ?? new Pass(kShader, uniforms());
  passes.set(renderer, pass);
  pass.uniforms.source.value = source;
  pass.uniforms.size.value = size;
  pass.uniforms.isData.value = isData;
  // The smallest level with at least as many texels a side.
  const { width } = source.image as { width: number };
  pass.uniforms.level.value = source.generateMipmaps && !isData ? Math.max(0, Math.floor(Math.log2(width / size))) : 0;
  pass.run(renderer, target, [toTexels(kWhole, size)]);
  pass.uniforms.source.value = null;
  const image = new ImageData(size, size);
  renderer.readRenderTargetPixels(target, 0, 0, size, size, image.data);
  target.dispose();
  return image;
}
