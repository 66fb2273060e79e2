import type { Texture } from 'three';
import { check, checkColor, checkShare, kPaint, notA } from '../errors.js';

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
  /** The name of a region of the cage, such as `lips`, beyond which the layer is not seen; null for none. */
  region: string | null;
}

/** The style of a layer by default. */
export const plainStyle: Style = { opacity: 1, tint: '#ffffff', blend: 'normal', visible: true, region: null };

/**
 * The fields of a style that are not undefined, and no others that were given with it.
 * @param argument  The name of the argument, for messages.
 * @throws {CagecastError} `badOption` that names the field and its value.
 */
export function readStyle(style: Partial<Style>, argument = 'style'): Partial<Style> {
  check(typeof style === 'object' && style !== null, argument, style, 'an object');
  const isGiven = ([name, value]: [string, unknown]) => name in plainStyle && value !== undefined;
  const given = Object.fromEntries(Object.entries(style).filter(isGiven));
  const { opacity, tint, blend, visible, region } = { ...plainStyle, ...given };
  checkShare('opacity', opacity);
  checkColor('tint', tint);
  check(blendModes.includes(blend), 'blend', blend, `one of ${blendModes.join(', ')}`);
  check(typeof visible === 'boolean', 'visible', visible, 'true or false');
  check(region === null || typeof region === 'string', 'region', region, 'the name of a region, or null');
  return given;
}

/** A name that no layer has: a kind and a number. */
export function freeName(kind: string, layers: readonly Layer[]): string {
  let number = 1;
  while (layers.some(({ name }) => name === `${kind} ${number}`)) number++;
  return `${kind} ${number}`;
}

/** @throws {CagecastError} `badArgument` if a value is not a texture. */
export function checkTexture(texture: Texture, argument: string): void {
  if (texture?.isTexture !== true) throw notA('a Texture', argument, texture, kPaint);
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
