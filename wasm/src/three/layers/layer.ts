import { SRGBColorSpace, type Texture } from 'three';
import { areEqual, type PlainStyle, plainData, readPlainStyle } from '../../gltf/look/style.js';
import { check, notA } from '../errors.js';

export { type Blend, blendModes } from '../../gltf/look/style.js';

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

/** How a layer is blended, and what it makes of the surface where it covers it: as far as it is opaque and within its region. */
export interface Style extends PlainStyle {
  /**
   * A normal map in the cage's UV space, such as scars or embossing, in tangent space as glTF has them: data, without a colour space; its
   * `flipY` counts. It lies on the relief that the model has of its own. Default: null, that of what is below. It is the caller's.
   */
  normal: Texture | null;
}

/** The style of a layer by default. */
export const plainStyle: Style = { ...plainData, normal: null };

/**
 * The fields of a style that are not undefined, and no others that were given with it.
 * @param argument  The name of the argument, for messages.
 * @throws {CagecastError} `badOption` that names the field and its value.
 */
export function readStyle(style: Partial<Style>, argument = 'style'): Partial<Style> {
  readPlainStyle(style, argument);
  const { normal = null } = style;
  const isData = normal?.isTexture === true && normal.colorSpace !== SRGBColorSpace;
  check(normal === null || isData, 'normal', normal, 'a Texture of data, without a colour space, or null');
  const isGiven = ([name, value]: [string, unknown]) => name in plainStyle && value !== undefined;
  return Object.fromEntries(Object.entries(style).filter(isGiven));
}

/** A name that no layer has: a kind and a number. */
export function freeName(kind: string, layers: readonly Layer[]): string {
  let number = 1;
  while (layers.some(({ name }) => name === `${kind} ${number}`)) number++;
  return `${kind} ${number}`;
}

/** @throws {CagecastError} `badArgument` if a value is not a texture. */
export function checkTexture(texture: Texture, argument: string): void {
  if (texture?.isTexture !== true) throw notA('a Texture', argument, texture);
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
  const keys = kKeys.filter((key) => !areEqual(layer[key], other[key]));
  return Object.fromEntries(keys.map((key) => [key, other[key]]));
}

/** Whether two states of the stack are equal. */
export function areSame(layers: readonly Layer[], others: readonly Layer[]): boolean {
  const isSame = (layer: Layer, other: Layer | undefined): boolean =>
    layer.id === other?.id && Object.keys(difference(layer, other)).length === 0;
  return layers.length === others.length && layers.every((layer, place) => isSame(layer, others[place]));
}
