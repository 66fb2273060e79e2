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
  /** How far the layer is moved, in shares of the texture: to where u and v grow. What lies beyond its border is not repeated then. Default: [0, 0]. */
  offset: readonly [u: number, v: number];
  /** How large it is, 0.001 to 1000; about `center`, as it was before it was moved. Default: 1. */
  scale: number;
  /** By how much it is turned about `center`, in radians, clockwise where v grows downwards. Default: 0. */
  rotation: number;
  /** Where `scale` and `rotation` leave it in place. Default: [0.5, 0.5], the middle. */
  center: readonly [u: number, v: number];
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
  offset: [0, 0],
  scale: 1,
  rotation: 0,
  center: [0.5, 0.5],
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
  checkPlace(channels);
  return given;
}

/** Where a layer lies. */
type Place = Pick<PlainStyle, 'offset' | 'scale' | 'rotation' | 'center'>;

function checkPlace(style: Place): void {
  for (const name of ['offset', 'center'] as const) {
    const value = style[name];
    const fits = Array.isArray(value) && value.length === 2 && value.every(Number.isFinite);
    check(fits, name, value, 'two finite numbers [u, v]');
  }
  const { scale, rotation } = style;
  check(
    typeof scale === 'number' && scale >= kMinScale && scale <= 1 / kMinScale,
    'scale',
    scale,
    `a number from ${kMinScale} to ${1 / kMinScale}`,
  );
  check(Number.isFinite(rotation), 'rotation', rotation, 'a finite number of radians');
}

const kMinScale = 1e-3;

/** Whether a layer lies elsewhere than its image. */
export const isMoved = ({ offset: [u, v], scale, rotation }: Place): boolean =>
  u !== 0 || v !== 0 || scale !== 1 || rotation !== 0;

/** Where in its image a layer is read: 6 numbers, u = m[0] · u + m[1] · v + m[2], and the same for v. */
export function readingOf({
  offset,
  scale,
  rotation,
  center: [x, y],
}: Place): readonly [number, number, number, number, number, number] {
  const [c, s] = [Math.cos(rotation) / scale, Math.sin(rotation) / scale];
  const [fromX, fromY] = [x + offset[0], y + offset[1]];
  return [c, s, x - c * fromX - s * fromY, -s, c, y + s * fromX - c * fromY];
}

/** The most places along each side of a texel at which a layer is read that is drawn smaller. */
const kMostSamples = 4;

/** At how many places along each side of a texel of a texture a layer is read. @param texels  Of its image, along the longer side. */
export const samplesOf = ({ scale }: Place, texels: number, size: number): number =>
  Math.min(kMostSamples, Math.max(1, Math.ceil(texels / size / scale)));

/** Whether two values of a style are equal. */
export const areEqual = (a: unknown, b: unknown): boolean =>
  a === b || (Array.isArray(a) && Array.isArray(b) && a.length === b.length && a.every((one, k) => one === b[k]));

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
