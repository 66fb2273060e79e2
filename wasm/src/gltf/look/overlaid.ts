import { fillGutter } from '../../bake/gutter.js';
import type { Baked, Image } from '../../bake/index.js';
import type { Part } from '../../scene/extract.js';
import type { ImageCodec, Materials } from '../../scene/materials.js';
import type { Fill } from '../bake/plan.js';
import type { OverlaidLook } from '../overlay.js';
import { coatsOfLook } from './coats.js';
import type { Look } from './compose.js';
import { type Channels, overlaidBy } from './surface.js';

const kWhite = [255, 255, 255, 255];
/** What a texture is that a material lacks. */
const kPlain = { color: kWhite, normal: [128, 128, 255, 255], orm: kWhite, emissive: kWhite };

/** A look in the cage's UVs, for materials whose textures cannot hold it: with their own values where no layer is. */
export async function overlaidLook(
  look: Look,
  model: Materials,
  parts: readonly Part[],
  encode: ImageCodec['encode'],
): Promise<OverlaidLook> {
  const coats = coatsOfLook(look);
  const size = (look.color ?? look.normal ?? look.roughness ?? look.metalness ?? look.glow)?.width ?? 1;
  const channels = new Map<number, Channels>();
  /** Images that were written, by what is in them. */
  const known = new Map<string, { bytes: Uint8Array; strength: number } | undefined>();
  for (const material of new Set(parts.flatMap((part) => model.materialOf(part) ?? []))) {
    const lighting = model.lightingOf(material);
    const isOneColor = parts.every((part) => model.materialOf(part) !== material || !model.colorsOf(part, 'COLOR_0'));
    const made: Channels = { images: {}, strength: 1 };
    for (const slot of ['color', 'normal', 'orm', 'emissive'] as const) {
      const coat = coats[slot];
      if (!coat || model.useOf(material, slot) || !(coat.on?.includes(lighting) ?? true)) continue;
      if (slot === 'color' && (lighting === 'toon' || !isOneColor)) continue;
      const factor = model.factorOf(material, slot);
      const key = JSON.stringify([slot, factor]);
      if (!known.has(key)) {
        const coated = coat.lay({ image: full(kPlain[slot], size), factor, relief: 1 }, inPlace(size));
        const { image, strength = 1 } = coated ?? {};
        known.set(key, image && { bytes: await encode(image), strength });
      }
      const found = known.get(key);
      if (!found) continue;
      made.images[slot] = found.bytes;
      made.strength = Math.max(made.strength, found.strength);
    }
    channels.set(material, made);
  }
  return overlaidBy(look.tint, channels);
}

/** Texels around what is opaque that get its colours. */
const kRings = 8;

/** Gives transparent texels the colours beside them, as filters mix these in whatever their alpha is. */
export function withoutFringes({ width, height, data }: Image): Image {
  const colors = Float32Array.from(data);
  const covered = Uint8Array.from({ length: width * height }, (_, i) => Number(data[4 * i + 3]! > 0));
  const isClear = (at: number) => data[at - (at % 4) + 3] === 0;
  const within = (count: number) => (at: number) => (at >= 0 && at < count ? at : -1);
  fillGutter({ width, height, columnOf: within(width), rowOf: within(height), colors }, covered, kRings);
  return { width, height, data: data.map((byte, at) => (at % 4 < 3 && isClear(at) ? colors[at]! : byte)) };
}

const full = (color: readonly number[], size: number): Image => ({
  width: size,
  height: size,
  data: new Uint8ClampedArray(4 * size * size).map((_, i) => color[i % 4]!),
});

/** Leaves images in the cage's UVs. */
const inPlace =
  (size: number): Fill =>
  (image, kind): Baked => {
    const { data } = image.width === size ? image : full([...image.data.subarray(0, 4)], size);
    const mask = new Uint8Array(size * size).fill(255);
    const overlap = { texels: 0, lost: 0, parts: [] };
    return { width: size, height: size, kind, mask, overlap, data: data as Uint8ClampedArray<ArrayBuffer> };
  };
