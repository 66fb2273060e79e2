import { colorByte, type Image, linearOf, shareOf } from '../../bake/image.js';
import { regionMask } from '../../bake/index.js';
import { wrong } from '../../core/checks.js';
import { CagecastError } from '../../core/error.js';
import { firstLine } from '../../scene/input-error.js';
import type { ImageCodec } from '../../scene/materials.js';
import { counted, maxCompositeSize, type SavedImage } from './saved-images.js';
import { type CheckedLayer, kWhite, maskSize, type Regions } from './saved-layers.js';
import { isMoved, type PlainStyle, plainData, readingOf, samplesOf } from './style.js';

type Triple = readonly [number, number, number];

/** What layers come to, in the cage's UV space: images of one size. What no layer has is undefined. */
export interface Look {
  /** Transparent where the model's own colour is seen. */
  color: Image | undefined;
  /** Grey, as opaque as it covers that of the model. */
  roughness: Image | undefined;
  /** In the same way. */
  metalness: Image | undefined;
  /** Opaque, as glTF has it; flat where there is no relief. */
  normal: Image | undefined;
  /** Light of its own, as a share of `strength`; opaque. */
  glow: Image | undefined;
  strength: number;
  /** By what the model's own colour is multiplied, in linear light. */
  tint: Triple | undefined;
}

/** Reads an image at a place: 4 numbers, colours multiplied by alpha. @param size  Texels along a side of what is drawn. */
type Take = (u: number, v: number, out: Float64Array, size: number) => void;

/** A layer as it is drawn. */
interface Drawn extends Omit<PlainStyle, 'tint'> {
  take: Take;
  tint: Triple;
  mask: Take | undefined;
  relief: Take | undefined;
  /** Whether it changes the glow: those above a glow cover it. */
  isInGlow: boolean;
}

const kSmallSize = 1024;

/**
 * Draws layers as their shaders do (`three/layers/composite-shader.ts`), without a GPU.
 * Cost: for each layer, a second for a million texels; up to five for one that is moved and made smaller.
 * @throws {CagecastError} `badArgument` for an image that cannot be read.
 */
export async function composeLook(
  { layers, baseTint }: { layers: readonly CheckedLayer[]; baseTint: string },
  regions: Regions,
  decode: ImageCodec['decode'],
): Promise<Look> {
  const seen = layers.filter(({ style: { visible = true, opacity = 1 } }) => visible && opacity > 0);
  const sides = seen.flatMap(({ image, normal }) => [
    image.width,
    image.height,
    normal?.width ?? 0,
    normal?.height ?? 0,
  ]);
  const size = Math.max(...sides, 0) > kSmallSize ? maxCompositeSize : kSmallSize;
  const drawn: Drawn[] = [];
  /** By their bytes, which layers share. */
  const known = new Map<Uint8Array, Image>();
  const readOnce = async (image: SavedImage): Promise<Image> => {
    const found = known.get(image.bytes) ?? (await read(image, decode));
    known.set(image.bytes, found);
    return found;
  };
  for (const { image, normal, style } of seen) {
    const whole = { ...plainData, ...style };
    const { region } = whole;
    const edge = isMoved(whole) ? 'clear' : 'repeat';
    const samples = samplesOf(whole, Math.max(image.width, image.height), size);
    const mask = region === null ? undefined : regionMask({ regions }, region, { width: maskSize });
    drawn.push({
      ...whole,
      take: placed(takerOf(await readOnce(image), linearOf, { edge }), whole, samples),
      relief: normal && placed(takerOf(await readOnce(normal), shareOf, { edge, isOpaque: true }), whole, samples),
      mask: mask && takerOf(mask, shareOf, { edge: 'clamp' }),
      tint: linear(whole.tint),
      isInGlow: whole.emissive > 0 || (whole.blend === 'normal' && drawn.some(({ isInGlow }) => isInGlow)),
    });
  }
  const tint = baseTint.toLowerCase() === kWhite ? undefined : linear(baseTint);
  return { ...draw(drawn, size), tint };
}

const linear = (color: string): Triple =>
  [1, 3, 5].map((at) => linearOf[Number.parseInt(color.slice(at, at + 2), 16)]!) as unknown as Triple;

async function read({ name, bytes, type, width, height }: SavedImage, decode: ImageCodec['decode']): Promise<Image> {
  let image: Image;
  try {
    image = await decode(bytes, type);
  } catch (error) {
    throw error instanceof CagecastError ? error : wrong(`${name} cannot be read: ${firstLine(error)}`);
  }
  if (image.width === width && image.height === height) return image;
  throw wrong(`${name} has ${counted(image.width)} × ${counted(image.height)} pixels, not as many as it says`);
}

/** Reads a layer that lies elsewhere, at some places along each side of a texel. */
function placed(take: Take, style: PlainStyle, samples: number): Take {
  if (!isMoved(style)) return take;
  const [a, b, c, d, e, f] = readingOf(style);
  const sum = new Float64Array(4);
  return (u, v, out, size) => {
    sum.fill(0);
    for (let i = 0; i < samples * samples; ++i) {
      const x = u + (((i % samples) + 0.5) / samples - 0.5) / size;
      const y = v + ((Math.floor(i / samples) + 0.5) / samples - 0.5) / size;
      take(a * x + b * y + c, d * x + e * y + f, out, size);
      for (let k = 0; k < 4; ++k) sum[k]! += out[k]! / samples ** 2;
    }
    out.set(sum);
  };
}

/** What lies beyond the border of an image: it once more, its last texels, or nothing. */
type Edge = 'repeat' | 'clamp' | 'clear';

/**
 * Samples an image bilinearly.
 * @param table  What its bytes stand for.
 */
function takerOf(
  { width, height, data }: Image,
  table: Float32Array,
  { edge, isOpaque = false }: { edge: Edge; isOpaque?: boolean },
): Take {
  const within =
    edge === 'clear'
      ? (at: number, count: number) => (at >= 0 && at < count ? at : Number.NaN)
      : edge === 'clamp'
        ? (at: number, count: number) => Math.min(count - 1, Math.max(0, at))
        : (at: number, count: number) => ((at % count) + count) % count;
  // Called for each texel of each layer, so nothing is allocated here.
  return (u, v, out) => {
    const x = u * width - 0.5;
    const y = v * height - 0.5;
    const left = Math.floor(x);
    const top = Math.floor(y);
    out[0] = out[1] = out[2] = out[3] = 0;
    for (let corner = 0; corner < 4; ++corner) {
      const right = corner & 1;
      const down = corner >> 1;
      const weight = (right ? x - left : 1 + left - x) * (down ? y - top : 1 + top - y);
      if (weight === 0) continue;
      const at = 4 * (within(top + down, height) * width + within(left + right, width));
      if (Number.isNaN(at)) continue;
      const share = isOpaque ? weight : (weight * data[at + 3]!) / 255;
      if (share === 0) continue;
      out[0]! += share * table[data[at]!]!;
      out[1]! += share * table[data[at + 1]!]!;
      out[2]! += share * table[data[at + 2]!]!;
      out[3]! += share;
    }
  };
}

/** Draws all layers, a texel after the other. */
function draw(layers: readonly Drawn[], size: number): Omit<Look, 'tint'> {
  const strength = Math.max(0, ...layers.map(({ emissive }) => emissive)) || 1;
  const imageIf = (isNeeded: boolean) =>
    isNeeded ? { width: size, height: size, data: new Uint8ClampedArray(4 * size * size) } : undefined;
  const look = {
    color: imageIf(layers.some(({ blend }) => blend !== 'none')),
    roughness: imageIf(layers.some(({ roughness }) => roughness !== null)),
    metalness: imageIf(layers.some(({ metalness }) => metalness !== null)),
    normal: imageIf(layers.some(({ relief }) => relief)),
    glow: imageIf(layers.some(({ emissive }) => emissive > 0)),
    strength,
  };
  const texel = new Texel(strength, size);
  const toByte = colorByte();
  for (let y = 0, at = 0; y < size; ++y)
    for (let x = 0; x < size; ++x, at += 4) {
      texel.draw(layers, (x + 0.5) / size, (y + 0.5) / size);
      const { color, rough, metal, glow, tilt } = texel;
      const alpha = color[3]!;
      if (look.color && alpha > 0) {
        for (let k = 0; k < 3; ++k) look.color.data[at + k] = toByte(color[k]! / alpha);
        look.color.data[at + 3] = 255 * alpha;
      }
      if (look.roughness) putGrey(look.roughness, at, rough);
      if (look.metalness) putGrey(look.metalness, at, metal);
      if (look.glow) {
        for (let k = 0; k < 3; ++k) look.glow.data[at + k] = toByte(glow[k]!);
        look.glow.data[at + 3] = 255;
      }
      if (look.normal) {
        const { data } = look.normal;
        data[at] = 127.5 * (1 + tilt[0]!);
        data[at + 1] = 127.5 * (1 - tilt[1]!);
        data[at + 2] = 127.5 * (1 + Math.sqrt(Math.max(0, 1 - tilt[0]! ** 2 - tilt[1]! ** 2)));
        data[at + 3] = 255;
      }
    }
  return look;
}

function putGrey({ data }: Image, at: number, values: Float64Array): void {
  const share = values[1]!;
  if (share === 0) return;
  data[at] = data[at + 1] = data[at + 2] = (255 * values[0]!) / share;
  data[at + 3] = 255 * share;
}

/** What layers come to at a place. */
class Texel {
  /** Red, green, blue, multiplied by alpha, and that. */
  readonly color = new Float64Array(4);
  /** A value, multiplied by how much it covers what is below, and how much that is. */
  readonly rough = new Float64Array(2);
  readonly metal = new Float64Array(2);
  readonly glow = new Float64Array(3);
  /** x and y of a unit vector: to where u and v grow. */
  readonly tilt = new Float64Array(2);
  readonly #all = [this.color, this.rough, this.metal, this.glow, this.tilt];
  readonly #layer = new Float64Array(4);
  readonly #other = new Float64Array(4);

  /** @param strength  Of the glow, which is a share of it. @param size  Texels along a side. */
  constructor(
    readonly strength: number,
    readonly size: number,
  ) {}

  draw(layers: readonly Drawn[], u: number, v: number): void {
    for (let i = 0; i < this.#all.length; ++i) this.#all[i]!.fill(0);
    const layer = this.#layer;
    const other = this.#other;
    for (let i = 0; i < layers.length; ++i) {
      const one = layers[i]!;
      const { take, mask, opacity, tint, blend, roughness, metalness, relief } = one;
      take(u, v, layer, this.size);
      if (layer[3] === 0) continue;
      mask?.(u, v, other, this.size);
      const share = opacity * (mask ? other[3]! : 1);
      for (let k = 0; k < 3; ++k) layer[k]! *= share * tint[k]!;
      layer[3]! *= share;
      const alpha = layer[3]!;
      if (blend !== 'none') join(this.color, layer, blend);
      if (roughness !== null) cover(this.rough, roughness, alpha);
      if (metalness !== null) cover(this.metal, metalness, alpha);
      if (one.isInGlow) {
        const left = blend === 'normal' ? 1 - alpha : 1;
        for (let k = 0; k < 3; ++k)
          this.glow[k] = Math.min(1, left * this.glow[k]! + (one.emissive / this.strength) * layer[k]!);
      }
      if (relief) {
        relief(u, v, other, this.size);
        lean(other, one);
        this.tilt[0]! += alpha * (other[0]! - this.tilt[0]!);
        this.tilt[1]! += alpha * (other[1]! - this.tilt[1]!);
      }
    }
  }
}

/** A layer over what is below: “Compositing and Blending Level 1” (W3C), in linear light, with colours multiplied by alpha. */
function join(below: Float64Array, layer: Float64Array, blend: 'normal' | 'multiply' | 'screen' | 'add'): void {
  const a = layer[3]!;
  const b = below[3]!;
  for (let k = 0; k < 3; ++k) {
    const top = layer[k]!;
    const under = below[k]!;
    let both = top * b;
    if (blend === 'multiply') both = top * under;
    if (blend === 'screen') both = top * b + under * a - top * under;
    if (blend === 'add') both = Math.min(a * b, top * b + under * a);
    below[k] = top * (1 - b) + under * (1 - a) + both;
  }
  below[3] = a + b * (1 - a);
}

function cover(below: Float64Array, value: number, alpha: number): void {
  below[0]! += alpha * (value - below[0]!);
  below[1]! += alpha * (1 - below[1]!);
}

/** Makes a unit vector of a texel of a normal map: to where u and v grow, and up. */
function lean(texel: Float64Array, { normalScale: scale, rotation }: Drawn): void {
  // Beside a layer that lies elsewhere: straight up.
  if (texel.every((value) => value === 0)) return;
  // At its border.
  const whole = texel[3]! || 1;
  for (let k = 0; k < 3; ++k) texel[k]! /= whole;
  const x = 2 * texel[0]! - 1;
  const y = 2 * texel[1]! - 1;
  // Some compressed ones have red and green only.
  const z = texel[2] === 0 ? Math.sqrt(Math.max(0, 1 - x * x - y * y)) : 2 * texel[2]! - 1;
  const length = Math.hypot(scale * x, scale * y, Math.max(z, 1e-3));
  // In glTF, v grows downwards, and green means up.
  const [across, down] = [(scale * x) / length, (-scale * y) / length];
  const [c, s] = [Math.cos(rotation), Math.sin(rotation)];
  texel[0] = c * across - s * down;
  texel[1] = s * across + c * down;
}
