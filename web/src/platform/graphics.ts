import type { WebGLRenderer } from 'three';

/**
 * Call this before something that was drawn is read, to be saved.
 * @throws Error if the browser has taken the graphics away: what is read then is empty.
 */
export function requireGraphics(renderer: WebGLRenderer): void {
  if (renderer.getContext().isContextLost())
    throw new Error('the browser has reset the graphics; try again in a moment');
}

/** Whether the processor draws, as the machine has no GPU: each frame takes long then. */
export function isSoftware(renderer: WebGLRenderer): boolean {
  const gl = renderer.getContext();
  const names = gl.getExtension('WEBGL_debug_renderer_info');
  const name: unknown = gl.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER);
  return /swiftshader|llvmpipe|software|basic render/i.test(String(name));
}
