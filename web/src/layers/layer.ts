import type { Texture } from 'three';

/** How a layer is blended with the layers below; `composite.ts` has the formulas. */
export const kBlends = ['normal', 'multiply', 'screen', 'add'] as const;
export type Blend = (typeof kBlends)[number];

/** The content of a layer: a texture in the cage's UV space. */
export interface Sheet {
  /** sRGB; its first row is at v = 0. */
  readonly texture: Texture;
  /** Whether its colours are premultiplied by alpha, in linear light; those of images are not. */
  readonly premultiplied?: boolean;
  /** URL of a thumbnail. */
  readonly picture: string;
  /** Bytes of memory besides the texture. */
  readonly bytes?: number;
}

/** How a layer is blended. */
export interface Style {
  /** 0..1 */
  opacity: number;
  /** #rrggbb; the sheet is multiplied by it. White changes nothing. */
  tint: string;
  blend: Blend;
  visible: boolean;
}

export const kPlain: Style = { opacity: 1, tint: '#ffffff', blend: 'normal', visible: true };

/** One layer of paint. */
export interface Layer extends Readonly<Style> {
  readonly id: number;
  /** For people. */
  readonly name: string;
  readonly sheet: Sheet;
}

const kKeys = ['name', 'sheet', ...(Object.keys(kPlain) as (keyof Style)[])] as const;

/** The fields in which `other`, another state of the layer, differs from `layer`. */
export function difference(layer: Layer, other: Layer): Partial<Layer> {
  const keys = kKeys.filter((key) => layer[key] !== other[key]);
  return Object.fromEntries(keys.map((key) => [key, other[key]]));
}

/** Whether two states of the stack are equal. */
export function areSame(layers: readonly Layer[], others: readonly Layer[]): boolean {
  const isSame = (layer: Layer, other: Layer | undefined): boolean =>
    layer.id === other?.id && Object.keys(difference(layer, other)).length === 0;
  return layers.length === others.length && layers.every((layer, place) => isSame(layer, others[place]));
}
