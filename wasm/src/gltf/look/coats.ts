import { colorByte, type Image, linearOf } from '../../bake/image.js';
import { type Baked, layOver } from '../../bake/index.js';
import { type Coat, type Coats, inShade } from '../bake/plan.js';
import type { Look } from './compose.js';

/** An image that says where paint is. */
const kFull: Image = { width: 1, height: 1, data: new Uint8Array(4).fill(255) };
const kOne = [1, 1, 1] as const;

/** A look as it is laid over textures: what three.js shows of its layers. */
export function coatsOfLook(look: Look): Coats {
  const { color, roughness, metalness, normal, glow, tint } = look;
  return {
    ...((color || tint) && { color: { lay: colorCoat(look) }, shade: { lay: colorCoat(look, true), on: ['toon'] } }),
    ...(normal && { normal: { lay: normalCoat(normal), on: ['standard', 'toon'] } }),
    ...((roughness || metalness) && { orm: { lay: surfaceCoat(look), on: ['standard'] } }),
    ...(glow && { emissive: { lay: glowCoat(glow, look.strength), on: ['standard', 'toon'] } }),
  };
}

const hasAny = ({ data }: Baked): boolean => data.some((byte, at) => at % 4 === 3 && byte > 0);

/** A copy of an image, with other colours. @param change  Of the texel whose red is at a place. */
function changed(image: Image, change: (data: Uint8ClampedArray, at: number) => void): Image {
  const data = new Uint8ClampedArray(image.data);
  for (let at = 0; at < data.length; at += 4) change(data, at);
  return { ...image, data };
}

/** @param isShade  Whether it is for the texture of the shade, whose factor is that of the paint. */
const colorCoat =
  ({ color, tint }: Look, isShade = false): Coat =>
  ({ image, factor: whole }, fill) => {
    const [factor, ofPaint] = isShade ? [kOne, whole] : [whole, kOne];
    const toByte = colorByte();
    const where = tint && fill(kFull, 'data');
    const base = where
      ? changed(image, (data, at) => {
          const share = where.data[at + 3]! / 255;
          for (let k = 0; k < 3; ++k)
            data[at + k] = toByte(linearOf[data[at + k]!]! * factor[k]! * (1 + share * (tint[k]! - 1)));
        })
      : image;
    if (!color) return { image: base, baked: where! };
    const baked = fill(color, 'color');
    return { baked, image: layOver(base, inShade(baked, ofPaint), where ? kOne : factor) };
  };

const surfaceCoat =
  ({ roughness, metalness }: Look): Coat =>
  ({ image, factor }, fill) => {
    const layers = [roughness, metalness].map((one) => one && fill(one, 'data'));
    const baked = layers.find((one) => one && hasAny(one));
    if (!baked) return undefined;
    return {
      baked,
      image: changed(image, (data, at) => {
        layers.forEach((over, i) => {
          const share = (over?.data[at + 3] ?? 0) / 255;
          const value = over?.data[at] ?? 0;
          data[at + 1 + i] = share * value + (1 - share) * factor[1 + i]! * data[at + 1 + i]!;
        });
      }),
    };
  };

const normalCoat =
  (relief: Image): Coat =>
  ({ image, relief: scale }, fill) => {
    const baked = fill(relief, 'normal');
    const isFlat = (at: number) => baked.data[at + 3] === 0 || (isZero(baked.data[at]!) && isZero(baked.data[at + 1]!));
    if (scale === 0 || baked.data.every((_, at) => at % 4 !== 0 || isFlat(at))) return undefined;
    return {
      baked,
      // The relief lies on that of the model, which its material multiplies by a scale.
      image: changed(image, (data, at) => {
        if (isFlat(at)) return;
        const share = baked.data[at + 3]! / 255;
        const [x, y, z] = vectorAt(baked.data, at);
        const [u, v, w] = vectorAt(data, at);
        const up = 1 - share + share * z;
        const mixed = [u * up + (share * x) / scale, v * up + (share * y) / scale, w * up];
        const length = Math.hypot(...mixed) || 1;
        for (let k = 0; k < 3; ++k) data[at + k] = 127.5 * (1 + mixed[k]! / length);
      }),
    };
  };

const vectorAt = (data: Image['data'], at: number) =>
  [0, 1, 2].map((k) => data[at + k]! / 127.5 - 1) as [number, number, number];

/** Whether a byte of a normal map is 0, as well as it can be. */
const isZero = (byte: number): boolean => byte === 127 || byte === 128;

const glowCoat =
  (glow: Image, strength: number): Coat =>
  ({ image, factor }, fill) => {
    const baked = fill(glow, 'color');
    const lightOf = (at: number, k: number) => (strength * linearOf[baked.data[at + k]!]! * baked.data[at + 3]!) / 255;
    const mixed = new Float32Array(image.data.length);
    let [most, isDark] = [0, true];
    for (let i = 0; i < mixed.length; ++i) {
      if (i % 4 === 3) continue;
      const own = lightOf(i - (i % 4), i % 4);
      isDark &&= own === 0;
      mixed[i] = factor[i % 4]! * linearOf[image.data[i]!]! + own;
      most = Math.max(most, mixed[i]!);
    }
    if (isDark) return undefined;
    const toByte = colorByte();
    const whole = Math.max(1, most);
    return {
      baked,
      strength: whole,
      image: changed(image, (data, at) => {
        for (let k = 0; k < 3; ++k) data[at + k] = toByte(mixed[at + k]! / whole);
      }),
    };
  };
