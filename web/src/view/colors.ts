import { Color, MathUtils } from 'three';

/** sRGB bytes. */
export type Rgb = readonly [number, number, number];

/** A color map: evenly spaced colours for 0 to 1, interpolated linearly. */
export type ColorMap = readonly Rgb[];

const parse = (hex: string): Rgb => [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16)) as unknown as Rgb;

/** Matplotlib's viridis: perceptually uniform and colour-blind safe. */
export const kSequential: ColorMap = [
  '#440154',
  '#482878',
  '#3e4989',
  '#31688e',
  '#26828e',
  '#1f9e89',
  '#35b779',
  '#6ece58',
  '#b5de2b',
  '#fde725',
].map(parse);

/** ColorBrewer's RdBu, reversed: low is blue, the middle white, high red. */
export const kDiverging: ColorMap = ['#2166ac', '#67a9cf', '#d1e5f0', '#f7f7f7', '#fddbc7', '#ef8a62', '#b2182b'].map(
  parse,
);

/** The colour of a value, clamped to 0..1. */
export function colorAt(map: ColorMap, share: number): Rgb {
  const place = MathUtils.clamp(share, 0, 1) * (map.length - 1);
  const below = Math.min(Math.floor(place), map.length - 2);
  return map[below]!.map((from, channel) =>
    Math.round(MathUtils.lerp(from, map[below + 1]![channel]!, place - below)),
  ) as unknown as Rgb;
}

/** A colour for each index, the first ones most distinct: hues by the golden ratio, in three lightnesses. */
export function distinctColor(number: number): Rgb {
  const hue = (0.55 + number * 0.618034) % 1;
  return parse(`#${new Color().setHSL(hue, 0.6, [0.5, 0.38, 0.62][number % 3]!).getHexString()}`);
}

export const cssColor = (rgb: Rgb): string => `rgb(${rgb.join(' ')})`;
