import { SRGBColorSpace, type Texture } from 'three';
import { check, checkColor, checkShare, notA } from '../errors.js';

/** How the colour of a layer is blended with the layers below: as in “Compositing and Blending” of the W3C, in linear light. */
export const blendModes = ['normal', 'multiply', 'screen', 'add'] as const;
export type Blend = (typeof blendModes)[number];

/** The greatest strength of a layer's glow. */
export const maxEmissive = 10;

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
export interface Style {
  /** 0 to 1. */
  opacity: number;
  /** #rrggbb; the sheet is multiplied by it. White changes nothing. */
  tint: string;
  /** With `none` the colour of the layer is not seen, only its roughness, metalness, glow and relief. Default: `normal`. */
  blend: Blend | 'none';
  visible: boolean;
  /** The name of a region of the cage, such as `lips`, beyond which the layer is not seen; null for none. */
  region: string | null;
  /** 0, a mirror, to 1, matt. Default: null, that of what is below. For standard and physical materials. */
  roughness: number | null;
  /** 0, no metal, to 1. Default: null, that of what is below. For standard and physical materials. */
  metalness: number | null;
  /** How strongly the layer shines in its own colour, without any light, 0 to 10. Layers above that blend as `normal` cover it. Default: 0. */
  emissive: number;
  /**
   * A normal map in the cage's UV space, such as scars or embossing, in tangent space as glTF has them: data, without a colour space; its
   * `flipY` counts. It lies on the relief that the model has of its own. Default: null, that of what is below. It is the caller's.
   */
  normal: Texture | null;
  /** How strong the relief of `normal` is; below 0, what it raises is pressed in. Default: 1. */
  normalScale: number;
}

/** The style of a layer by default. */
export const plainStyle: Style = {
  opacity: 1,
  tint: '#ffffff',
  blend: 'normal',
  visible: true,
  region: null,
  roughness: null,
  metalness: null,
  emissive: 0,
  normal: null,
  normalScale: 1,
};

/**
 * The fields of a style that are not undefined, and no others that were given with it.
 * @param argument  The name of the argument, for messages.
 * @throws {CagecastError} `badOption` that names the field and its value.
 */
export function readStyle(style: Partial<Style>, argument = 'style'): Partial<Style> {
  check(typeof style === 'object' && style !== null, argument, style, 'an object');
  const isGiven = ([name, value]: [string, unknown]) => name in plainStyle && value !== undefined;
  const given = Object.fromEntries(Object.entries(style).filter(isGiven));
  const { opacity, tint, blend, visible, region, ...channels } = { ...plainStyle, ...given };
  checkShare('opacity', opacity);
  checkColor('tint', tint);
  const blends: readonly Style['blend'][] = [...blendModes, 'none'];
  check(blends.includes(blend), 'blend', blend, `one of ${blends.join(', ')}`);
  check(typeof visible === 'boolean', 'visible', visible, 'true or false');
  check(region === null || typeof region === 'string', 'region', region, 'the name of a region, or null');
  checkChannels(channels);
  return given;
}

function checkChannels(style: Pick<Style, 'roughness' | 'metalness' | 'emissive' | 'normal' | 'normalScale'>): void {
  const { emissive, normal, normalScale } = style;
  for (const name of ['roughness', 'metalness'] as const) {
    const value = style[name];
    const fits = value === null || (typeof value === 'number' && value >= 0 && value <= 1);
    check(fits, name, value, 'a number from 0 to 1, or null');
  }
  const shines = typeof emissive === 'number' && emissive >= 0 && emissive <= maxEmissive;
  check(shines, 'emissive', emissive, `a number from 0 to ${maxEmissive}`);
  const isData = normal?.isTexture === true && normal.colorSpace !== SRGBColorSpace;
  check(normal === null || isData, 'normal', normal, 'a Texture of data, without a colour space, or null');
  check(Number.isFinite(normalScale), 'normalScale', normalScale, 'a finite number');
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
  const keys = kKeys.filter((key) => layer[key] !== other[key]);
  return Object.fromEntries(keys.map((key) => [key, other[key]]));
}

/** Whether two states of the stack are equal. */
export function areSame(layers: readonly Layer[], others: readonly Layer[]): boolean {
  const isSame = (layer: Layer, other: Layer | undefined): boolean =>
    layer.id === other?.id && Object.keys(difference(layer, other)).length === 0;
  return layers.length === others.length && layers.every((layer, place) => isSame(layer, others[place]));
}
