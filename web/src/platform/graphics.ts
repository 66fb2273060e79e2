import type { WebGLRenderer } from 'three';

/**
 * Call this before something that was drawn is read, to be saved.
 * @throws Error if the browser has taken the graphics away: what is read then is empty.
 */
export function requireGraphics(renderer: WebGLRenderer): void {
  if (renderer.getContext().isContextLost())
    throw new Error('the browser has reset the graphics; try again in a moment');
}
