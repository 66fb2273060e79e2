import type { BufferGeometry, MeshStandardMaterial, Object3D, Texture } from 'three';
import { resize } from '../../bake/index.js';
import { smallSize } from '../../bake/small-image.js';
import { type Pictures, picturesOf, readBaseColors } from '../../scene/base-colors.js';
import { type PixelSource, pixelsOf } from '../pixels.js';
import { valuesOf } from './attributes.js';
import { asItWas, extract, type Part } from './extract-scene.js';
import { materialOfGroups } from './names.js';
import { inTexture, uvAttribute, uvLayoutOf } from './uv-layout.js';

/**
 * What the parts of a scene look like, as `CageModel` has it. Each texture is read once, in a task of its own; one whose pixels cannot be
 * read (compressed, of another origin, not loaded) is left out.
 */
export function baseColorsOf(object: Object3D | BufferGeometry): ReturnType<typeof readBaseColors<Texture>> {
  const { vertices, parts } = asItWas(object, undefined, () => {
    const { mesh, parts } = extract(object, 'model');
    return { vertices: mesh.positions.length / 3, parts: parts.map(coloredPart) };
  });
  return readBaseColors(vertices, parts, imageOf);
}

/** A part, and what its material groups look like. */
function coloredPart(part: Part) {
  const materials = materialOfGroups(part) as (Partial<MeshStandardMaterial> | undefined)[];
  const shown = materials.find((material) => material?.map)?.map;
  const groups = materials.map((material) => {
    const { color, transparent, alphaTest = 0, map } = material ?? {};
    return {
      factor: color?.isColor ? [color.r, color.g, color.b] : undefined,
      // The UVs of a part are those of one texture.
      texture: map && map.channel === shown!.channel ? map : undefined,
      isOpaque: !transparent && alphaTest === 0,
    };
  });
  return { firstVertex: part.firstVertex, uvs: shown ? uvsOf(part) : undefined, groups };
}

/** Where a part is in its texture; undefined if its UVs do not say. */
function uvsOf(part: Part): Float32Array | undefined {
  const layout = uvLayoutOf(part);
  const uv = uvAttribute(part, layout);
  if (uv?.count !== part.vertexCount || uv.itemSize !== 2) return undefined;
  const laid = inTexture(valuesOf(uv), layout);
  return laid.every(Number.isFinite) ? laid : undefined;
}

/** What was read of each source of a texture, and in which version. */
const known = new WeakMap<object, { version: number; pictures: Pictures | undefined }>();

async function imageOf({ source, flipY }: Texture): Promise<Pictures | undefined> {
  const before = known.get(source);
  if (before?.version === source.version) return before.pictures;
  await new Promise((resolve) => setTimeout(resolve));
  const image = pixelsOf(source.data as PixelSource | undefined, flipY);
  const pictures = image && picturesOf(resize(image, ...smallSize(image)));
  known.set(source, { version: source.version, pictures });
  return pictures;
}
