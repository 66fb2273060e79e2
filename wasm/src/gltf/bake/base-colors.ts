import { type Image, resize } from '../../bake/index.js';
import { opaque, smallSize } from '../../bake/small-image.js';
import type { BaseColor, CageModel } from '../../cages/types.js';
import type { Piece } from '../pieces.js';
import { layUvs } from '../uv-layout.js';
import { type BakeModel, type ImageCodec, type TextureUse, uvsOf } from './plan.js';

/**
 * What the parts of a model look like, as `CageModel` has it: a group for each part. An image that is missing or cannot be decoded, such
 * as KTX2, is left out, and so is one of a part without UVs that could be used.
 */
export async function baseColorsOf<Material, Texture>(
  model: BakeModel<Material, Texture>,
  decode: ImageCodec['decode'],
): Promise<Required<Pick<CageModel, 'uvs' | 'baseColors'>>> {
  const imageOf = remembered(async (texture: Texture) => smallImageOf(model, texture, decode));
  const opaqueOf = remembered(opaque);
  const uvs = new Float32Array(2 * model.parts.reduce((sum, { vertexCount }) => sum + vertexCount, 0));
  const baseColors: BaseColor[] = [];
  for (const part of model.parts) {
    const material = model.materialOf(part);
    if (material === undefined) {
      baseColors.push({});
      continue;
    }
    const factor = model.factorOf(material, 'color').map((x) => Math.min(1, Math.max(0, x)));
    const use = model.useOf(material, 'color');
    const laid = use && laidUvs(model, part, use);
    const image = laid && (await imageOf(use.texture));
    if (laid) uvs.set(laid, 2 * part.firstVertex);
    baseColors.push({
      factor: factor as [number, number, number],
      image: image && model.isOpaque(material) ? opaqueOf(image) : image,
    });
  }
  return { uvs, baseColors };
}

/** A function that is called once for each value. */
export function remembered<Value, Result>(fn: (value: Value) => Result): typeof fn {
  const known = new Map<Value, Result>();
  return (value) => {
    if (!known.has(value)) known.set(value, fn(value));
    return known.get(value)!;
  };
}

/** Where a part is in its texture; undefined if its UVs say that of none. */
export function laidUvs<Texture>(
  model: BakeModel<unknown, Texture>,
  part: Piece,
  { set, transform }: TextureUse<Texture>,
): Float32Array | undefined {
  const own = uvsOf(model, part, set);
  try {
    const laid = own && layUvs(own, transform);
    return laid?.every(Number.isFinite) ? laid : undefined;
  } catch {
    return undefined;
  }
}

async function smallImageOf<Texture>(
  model: BakeModel<unknown, Texture>,
  texture: Texture,
  decode: ImageCodec['decode'],
): Promise<Image | undefined> {
  try {
    const file = await model.imageOf(texture);
    const image = file && (await decode(file.bytes, file.mimeType));
    return image && resize(image, ...smallSize(image));
  } catch {
    return undefined;
  }
}
