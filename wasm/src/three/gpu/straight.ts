import { NoColorSpace, type Texture, type WebGLRenderer, WebGLRenderTarget } from 'three';
import { Pass } from './pass.js';
import { kWhole, toTexels } from './rect.js';

const kShader = /* glsl */ `
uniform sampler2D source;
uniform float size;
out vec4 color;

vec3 encode(vec3 linear) {
  return mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
}

void main() {
  vec4 found = texture(source, gl_FragCoord.xy / size);
  color = found.a > 0.0 ? vec4(encode(min(found.rgb / found.a, 1.0)), found.a) : vec4(0.0);
}
`;

// By renderer, as what it has drawn with holds it.
const passes = new WeakMap<WebGLRenderer, Pass<{ source: { value: Texture | null }; size: { value: number } }>>();

/**
 * Reads a premultiplied texture as an image file has it: sRGB, colours not multiplied by alpha, upper row first.
 * @param size Pixels a side of the image. Waits for the GPU.
 */
export function readStraight(renderer: WebGLRenderer, source: Texture, size: number): ImageData {
  const target = new WebGLRenderTarget(size, size, { colorSpace: NoColorSpace, depthBuffer: false });
  const pass = passes.get(renderer) ?? new Pass(kShader, { source: { value: null }, size: { value: 1 } });
  passes.set(renderer, pass);
  pass.uniforms.source.value = source;
  pass.uniforms.size.value = size;
  pass.run(renderer, target, [toTexels(kWhole, size)]);
  pass.uniforms.source.value = null;
  const image = new ImageData(size, size);
  renderer.readRenderTargetPixels(target, 0, 0, size, size, image.data);
  target.dispose();
  return image;
}
