import type { Texture } from 'three';

/** How a layer is joined with what lies under it; `composite.ts` says the formulas. */
export const kBlends = ['normal', 'multiply', 'screen', 'add'] as const;
export type Blend = (typeof kBlends)[number];

/** What is in a layer: a texture in the cage's UV space. */
export interface Sheet {
  /** sRGB; its first row is at v = 0. */
  readonly texture: Texture;
  /** Whether its colours were multiplied by their alpha, in linear light; those of images were not. */
  readonly premultiplied?: boolean;
  /** The address of a small picture of it. */
  readonly picture: string;
  /** What keeping it takes beside its texture, in bytes. */
  readonly bytes?: number;
}

/** How a layer is laid. */
export interface Style {
  /** 0..1 */
  opacity: number;
  /** The colour that all of it is multiplied by, as #rrggbb; white leaves it as it is. */
  tint: string;
  blend: Blend;
  visible: boolean;
}

export const kPlain: Style = { opacity: 1, tint: '#ffffff', blend: 'normal', visible: true };

/** One paint of several that lie over one another. */
export interface Layer extends Readonly<Style> {
  readonly id: number;
  /** For people. */
  readonly name: string;
  readonly sheet: Sheet;
}

const kKeys = ['name', 'sheet', ...(Object.keys(kPlain) as (keyof Style)[])] as const;

/** What another state of a layer has differently: the other's. */
export function apart(layer: Layer, other: Layer): Partial<Layer> {
  const keys = kKeys.filter((key) => layer[key] !== other[key]);
  return Object.fromEntries(keys.map((key) => [key, other[key]]));
}

/** Whether the same layers lie in the same order, in the same way. */
export function areSame(layers: readonly Layer[], others: readonly Layer[]): boolean {
  const isSame = (layer: Layer, other: Layer | undefined): boolean =>
    layer.id === other?.id && Object.keys(apart(layer, other)).length === 0;
  return layers.length === others.length && layers.every((layer, place) => isSame(layer, others[place]));
}
