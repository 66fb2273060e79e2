import { check, checkColor, checkShare } from '../../core/checks.js';

/** How the colour of a layer is blended with the layers below: as in “Compositing and Blending” of the W3C, in linear light. */
export const blendModes = ['normal', 'multiply', 'screen', 'add'] as const;
export type Blend = (typeof blendModes)[number];

/** The greatest strength of a layer's glow. */
export const maxEmissive = 10;

/** What plain data says of how a layer is blended, and what it makes of the surface. */
export interface PlainStyle {
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
  /** How strong the relief of `normal` is; below 0, what it raises is pressed in. Default: 1. */
  normalScale: number;
}

/** The style by default. */
export const plainData: PlainStyle = {
  opacity: 1,
  tint: '#ffffff',
  blend: 'normal',
  visible: true,
  region: null,
  roughness: null,
  metalness: null,
  emissive: 0,
  normalScale: 1,
};

/**
 * The fields of a style that are not undefined, and no others that were given with it.
 * @param argument  The name of the argument, for messages.
 * @throws {CagecastError} `badOption` that names the field and its value.
 */
export function readPlainStyle(style: Partial<PlainStyle>, argument = 'style'): Partial<PlainStyle> {
  check(typeof style === 'object' && style !== null, argument, style, 'an object');
  const isGiven = ([name, value]: [string, unknown]) => name in plainData && value !== undefined;
  const given = Object.fromEntries(Object.entries(style).filter(isGiven));
  const { opacity, tint, blend, visible, region, ...channels } = { ...plainData, ...given };
  checkShare('opacity', opacity);
  checkColor('tint', tint);
  const blends: readonly PlainStyle['blend'][] = [...blendModes, 'none'];
  check(blends.includes(blend), 'blend', blend, `one of ${blends.join(', ')}`);
  check(typeof visible === 'boolean', 'visible', visible, 'true or false');
  check(region === null || typeof region === 'string', 'region', region, 'the name of a region, or null');
  checkChannels(channels);
  return given;
}

function checkChannels(style: Pick<PlainStyle, 'roughness' | 'metalness' | 'emissive' | 'normalScale'>): void {
  const { emissive, normalScale } = style;
  for (const name of ['roughness', 'metalness'] as const) {
    const value = style[name];
    const fits = value === null || (typeof value === 'number' && value >= 0 && value <= 1);
    check(fits, name, value, 'a number from 0 to 1, or null');
  }
  const shines = typeof emissive === 'number' && emissive >= 0 && emissive <= maxEmissive;
  check(shines, 'emissive', emissive, `a number from 0 to ${maxEmissive}`);
  check(Number.isFinite(normalScale), 'normalScale', normalScale, 'a finite number');
}
