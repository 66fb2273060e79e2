import { type Image, resize } from '../bake/index.js';
import { opaque, smallSize } from '../bake/small-image.js';
import type { BaseColor, CageModel } from '../cages/types.js';
import type { Part } from './extract.js';
import type { ImageCodec, Materials, TextureUse } from './materials.js';
import { layUvs } from './uv-layout.js';

/** A small image, with its alpha and without. */
export interface Pictures {
  asIs: Image;
  opaque: Image;
}

export const picturesOf = (image: Image): Pictures => ({ asIs: image, opaque: opaque(image) });

/** A part of a model, and what each of its groups looks like: `undefined` for one without a material. */
interface ColoredPart<Texture> {
  firstVertex: number;
  /** 2 per vertex, where it is in the textures of its groups; `undefined` if its UVs do not say. */
  uvs: Float32Array | undefined;
  groups: readonly (GroupColor<Texture> | undefined)[];
}

interface GroupColor<Texture> {
  /** Red, green and blue. */
  factor: readonly number[] | undefined;
  /** Not one that lies by other UVs. */
  texture: Texture | undefined;
  /** Whether the alpha of the texture does not count. */
  isOpaque: boolean;
}

/**
 * What the groups of a model look like, as `CageModel` has it.
 * @param imageOf  Reads a texture; an image that cannot be read is left out.
 */
export async function readBaseColors<Texture>(
  vertices: number,
  parts: readonly ColoredPart<Texture>[],
  imageOf: (texture: Texture) => Promise<Pictures | undefined>,
): Promise<Required<Pick<CageModel, 'uvs' | 'baseColors'>>> {
  const all = new Float32Array(2 * vertices);
  const baseColors: BaseColor[] = [];
  for (const { firstVertex, uvs, groups } of parts) {
    if (uvs) all.set(uvs, 2 * firstVertex);
    for (const group of groups) {
      const image = uvs && group?.texture ? await imageOf(group.texture) : undefined;
      const factor = group?.factor?.map((x) => Math.min(1, Math.max(0, x))) as [number, number, number] | undefined;
      const isKnown = !group?.texture || image !== undefined;
      baseColors.push(group ? { factor, image: group.isOpaque ? image?.opaque : image?.asIs, isKnown } : {});
    }
  }
  return { uvs: all, baseColors };
}

/**
 * What the parts of a glTF look like: a group for each part. An image that is missing or cannot be decoded, such as KTX2, is left out,
 * and so is one of a part without UVs that could be used.
 */
export function baseColorsOf(
  materials: Materials,
  decode: ImageCodec['decode'],
): ReturnType<typeof readBaseColors<TextureUse>> {
  const { parts } = materials;
  const imageOf = remembered(async (texture: number) => smallImageOf(materials, texture, decode));
  const vertices = parts.reduce((sum, { vertexCount }) => sum + vertexCount, 0);
  const colored = parts.map((part) => {
    const material = materials.materialOf(part);
    const use = materials.colorUseOf(part);
    const group = material !== undefined && {
      factor: materials.factorOf(material, 'color'),
      texture: use,
      isOpaque: materials.isOpaque(material),
    };
    const uvs = use && laidUvs(materials, part, use);
    return { firstVertex: part.firstVertex, uvs, groups: [group || undefined] };
  });
  return readBaseColors(vertices, colored, ({ texture }) => imageOf(texture));
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
export function laidUvs(materials: Materials, part: Part, { set, transform }: TextureUse): Float32Array | undefined {
  const own = materials.uvsOf(part, set);
  try {
    const laid = own && layUvs(own, transform);
    return laid?.every(Number.isFinite) ? laid : undefined;
  } catch {
    return undefined;
  }
}

async function smallImageOf(
  { source }: Materials,
  texture: number,
  decode: ImageCodec['decode'],
): Promise<Pictures | undefined> {
  try {
    const file = await source.imageOf(texture);
    const image = file && (await decode(file.bytes, file.mimeType));
    return image && picturesOf(resize(image, ...smallSize(image)));
  } catch {
    return undefined;
  }
}
