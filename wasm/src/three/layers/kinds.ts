import type { Texture } from 'three';
import type { Layer } from './layer.js';

/** What layers show besides their colour, each in a texture of its own. */
export const channels = ['surface', 'glow', 'normals'] as const;
export type Channel = (typeof channels)[number];
/** What a texture shows of layers. */
export type Kind = 'color' | Channel;

/** Layers that one pass draws: there may be only 16 textures in a shader, and those with normal maps need two each. */
export const maxAtOnce = { color: 8, surface: 8, glow: 8, normals: 6 } as const satisfies Record<Kind, number>;

const isLoaded = ({ image, version, isRenderTargetTexture }: Texture): boolean =>
  Boolean(image) && (version > 0 || isRenderTargetTexture);

const glows = ({ emissive }: Layer): boolean => emissive > 0;

/** The visible layers that change a texture. */
export function layersOf(kind: Kind, layers: readonly Layer[]): readonly Layer[] {
  if (kind === 'color') return layers.filter(({ blend }) => blend !== 'none');
  if (kind === 'surface') return layers.filter(({ roughness, metalness }) => roughness !== null || metalness !== null);
  if (kind === 'normals') return layers.filter(({ normal }) => normal !== null && isLoaded(normal));
  // Those above a glow cover it.
  const first = layers.findIndex(glows);
  return first < 0 ? [] : layers.slice(first).filter((layer) => glows(layer) || layer.blend === 'normal');
}
