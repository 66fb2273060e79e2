import type { WebGLRenderer, WebGLRenderTarget } from 'three';
import { disjoint, type Rect } from './rect.js';

// Each rectangle takes a call per level: a few large ones cost less than many small ones.
const kMaxParts = 8;
const kTile = 256;

/**
 * Rebuilds the mipmap levels of a texture where it changed; each level is half the size of the previous one.
 * @param target Square, of a power of two, with storage for its levels. @param rects In texels of its first level.
 * Cost: one call per rectangle and level; proportional to the changed texels, not to the texture.
 */
export function refreshMipmaps(renderer: WebGLRenderer, target: WebGLRenderTarget, rects: readonly Rect[]): void {
  const gl = renderer.getContext() as WebGL2RenderingContext;
  const texture = (renderer.properties.get(target.texture) as { __webglTexture: WebGLTexture }).__webglTexture;
  const [from, to] = buffersOf(gl);
  const { state } = renderer;
  state.bindFramebuffer(gl.READ_FRAMEBUFFER, from);
  state.bindFramebuffer(gl.DRAW_FRAMEBUFFER, to);
  // Blits are clipped to the scissor.
  state.setScissorTest(false);
  let parts = disjoint(rects, kMaxParts, kTile);
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
  // Binds what the renderer draws to again, with its scissor.
  renderer.setRenderTarget(renderer.getRenderTarget(), renderer.getActiveCubeFace(), renderer.getActiveMipmapLevel());
}

function half({ left, top, right, bottom }: Rect): Rect {
  return { left: left >> 1, top: top >> 1, right: (right + 1) >> 1, bottom: (bottom + 1) >> 1 };
}

const buffers = new WeakMap<WebGL2RenderingContext, [WebGLFramebuffer, WebGLFramebuffer]>();

function buffersOf(gl: WebGL2RenderingContext): [WebGLFramebuffer, WebGLFramebuffer] {
  const known = buffers.get(gl);
  // A lost context takes its framebuffers with it.
  if (known && gl.isFramebuffer(known[0])) return known;
  const made: [WebGLFramebuffer, WebGLFramebuffer] = [gl.createFramebuffer()!, gl.createFramebuffer()!];
  buffers.set(gl, made);
  return made;
}
