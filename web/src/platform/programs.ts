import type { Material } from 'three';

/**
 * Frees materials once the next frame is drawn. A program for the graphics processor lives as long as a material that uses it; so what
 * replaces them, such as the next model, can use their programs. Linking its own would take tenths of a second.
 */
export function disposeAfterFrame(materials: readonly Material[]): void {
  // Frames are drawn in such a callback: one that was requested by now comes before the second of these.
  requestAnimationFrame(() => requestAnimationFrame(() => materials.forEach((material) => material.dispose())));
}
