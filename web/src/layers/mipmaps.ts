import type { WebGLRenderer, WebGLRenderTarget } from 'three';
import { apart, type Rect } from './rect';

// Each part takes a call for every level: few that are larger cost less than many.
const kMostParts = 8;
const kTile = 256;

/**
 * Makes the smaller levels of a texture again, under the parts of it that changed: each level is half of the one before.
 * @param target Square, of a power of two, with storage for its levels. @param rects In texels of its first level.
 * Cost: some calls for each part and level; little more than the parts' texels, where making all levels costs them all.
 */
export function refreshMipmaps(renderer: WebGLRenderer, target: WebGLRenderTarget, rects: readonly Rect[]): void {
  const gl = renderer.getContext() as WebGL2RenderingContext;
  const texture = (renderer.properties.get(target.texture) as { __webglTexture: WebGLTexture }).__webglTexture;
  const [from, to] = buffersOf(gl);
  const { state } = renderer;
  state.bindFramebuffer(gl.READ_FRAMEBUFFER, from);
  state.bindFramebuffer(gl.DRAW_FRAMEBUFFER, to);
  // Copies keep within the scissor, if there is one.
  state.setScissorTest(false);
  let parts = apart(rects, kMostParts, kTile);
  for (let level = 1; target.width >> level > 0; level++) {
    gl.framebufferTexture2D(gl.READ_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, level - 1);
    gl.framebufferTexture2D(gl.DRAW_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, level);
    parts = parts.map(half);
    for (const { left, top, right, bottom } of parts) {
      gl.blitFramebuffer(
        2 * left,
        2 * top,
        2 * right,
        2 * bottom,
        left,
        top,
        right,
        bottom,
        gl.COLOR_BUFFER_BIT,
        gl.LINEAR,
      );
    }
  }
  state.bindFramebuffer(gl.READ_FRAMEBUFFER, null);
  state.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
  renderer.setRenderTarget(null);
}

function half({ left, top, right, bottom }: Rect): Rect {
  return { left: left >> 1, top: top >> 1, right: (right + 1) >> 1, bottom: (bottom + 1) >> 1 };
}

const buffers = new WeakMap<WebGL2RenderingContext, [WebGLFramebuffer, WebGLFramebuffer]>();

function buffersOf(gl: WebGL2RenderingContext): [WebGLFramebuffer, WebGLFramebuffer] {
  const known = buffers.get(gl);
  // After a context was lost its buffers are gone.
  if (known && gl.isFramebuffer(known[0])) return known;
  const made: [WebGLFramebuffer, WebGLFramebuffer] = [gl.createFramebuffer()!, gl.createFramebuffer()!];
  buffers.set(gl, made);
  return made;
}
