import type { Texture } from 'three';
import { CagecastError } from '../../index.js';
import { describe } from '../describe.js';

/** How a layer is blended with the layers below: as in “Compositing and Blending” of the W3C, in linear light. */
export const blendModes = ['normal', 'multiply', 'screen', 'add'] as const;
export type Blend = (typeof blendModes)[number];

/** The content of a layer: a texture in the cage's UV space. */
export interface Sheet {
  /** sRGB; its first row is at v = 0. */
  readonly texture: Texture;
  /** Whether its colours are premultiplied by alpha, in linear light; those of images are not. */
  readonly premultiplied?: boolean;
  /** URL of a thumbnail, for lists. */
  readonly picture?: string;
  /** Frees its GPU memory, if that is not the caller's. */
  dispose?(): void;
  /** Bytes of memory besides the texture, which count in the undo history. */
  readonly bytes?: number;
}

/** How a layer is blended. */
export interface Style {
  /** 0 to 1. */
  opacity: number;
  /** #rrggbb; the sheet is multiplied by it. White changes nothing. */
  tint: string;
  blend: Blend;
  visible: boolean;
}

/** The style of a layer by default. */
export const plainStyle: Style = { opacity: 1, tint: '#ffffff', blend: 'normal', visible: true };

/** The fields of a style that are not undefined, and no others that were given with it. @throws {CagecastError} `badOption` that names the field and its value. */
export function readStyle(style: Partial<Style>): Partial<Style> {
  const check = (fits: boolean, name: string, value: unknown, what: string): void => {
    if (!fits)
      throw new CagecastError('badOption', 'cagecast/three/layers', `${name} is ${describe(value)}, not ${what}`);
  };
  check(typeof style === 'object' && !!style, 'style', style, 'an object');
  const { opacity = 1, tint = '#ffffff', blend = 'normal', visible = true } = style;
  check(opacity >= 0 && opacity <= 1, 'opacity', opacity, 'a number from 0 to 1');
  check(/^#[0-9a-f]{6}$/i.test(tint), 'tint', tint, 'a colour such as #ff8800');
  check(blendModes.includes(blend), 'blend', blend, `one of ${blendModes.join(', ')}`);
  check(typeof visible === 'boolean', 'visible', visible, 'true or false');
  // Spread, undefined would take the place of a value.
  return Object.fromEntries(Object.entries(style).filter(([name, value]) => name in plainStyle && value !== undefined));
}

/** A name that no layer has: a kind and a number. */
export function freeName(kind: string, layers: readonly Layer[]): string {
  let number = 1;
  while (layers.some(({ name }) => name === `${kind} ${number}`)) number++;
  return `${kind} ${number}`;
}

/** @throws {CagecastError} `badArgument` if a value is not a texture. */
export function checkTexture(texture: Texture, argument: string): void {
  if (texture?.isTexture !== true)
    throw new CagecastError(
      'badArgument',
      'cagecast/three/layers',
      `${argument} is ${describe(texture)}, not a Texture`,
    );
}

/** One layer of paint. A change of the stack makes a new object; the `id` stays. */
export interface Layer extends Readonly<Style> {
  readonly id: number;
  /** For people. */
  readonly name: string;
  readonly sheet: Sheet;
}

const kKeys = ['name', 'sheet', ...(Object.keys(plainStyle) as (keyof Style)[])] as const;

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
