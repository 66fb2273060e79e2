import type { Image } from './image.js';

/** The longest side of an image that a face is looked for in: more pixels show nothing new. */
const kSmall = 512;

/** The width and height that an image is scaled to, so that no side is longer than 512 pixels. */
export function smallSize({ width, height }: { width: number; height: number }): [width: number, height: number] {
  const scale = Math.min(1, kSmall / Math.max(width, height));
  return [Math.max(1, Math.round(scale * width)), Math.max(1, Math.round(scale * height))];
}

/** A copy of an image without transparency, for materials that ignore it. */
export function opaque({ width, height, data }: Image): Image {
  const copy = Uint8Array.from(data);
  for (let i = 3; i < copy.length; i += 4) copy[i] = 255;
  return { width, height, data: copy };
}
