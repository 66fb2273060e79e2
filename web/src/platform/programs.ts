import type { Material } from 'three';

/**
 * Frees materials once the next frame is drawn. three.js deletes a shader program with the last material that uses it; freed later,
 * they hand their programs on to what replaces them, such as the next model. Linking new ones takes tenths of a second.
 */
export function disposeAfterFrame(materials: readonly Material[]): void {
  // The viewer draws in such a callback too: a frame that was requested by now is drawn before the second of these.
  requestAnimationFrame(() => requestAnimationFrame(() => materials.forEach((material) => material.dispose())));
}
