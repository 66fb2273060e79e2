import type { Masks } from '../../api/index.js';
import { type MaskImages, maskTriangles, maskVertices } from '../../bake/index.js';
import { InputError } from '../../scene/input-error.js';
import type { Materials } from '../../scene/materials.js';
import { endOf } from '../../scene/pieces.js';
import { layUvs } from '../../scene/uv-layout.js';

/** Where masks can come from, beside arrays. */
export interface MaskSources {
  /**
   * Images in the model's own UVs, those of its base colour texture: white where it is never, or always, painted. They hold for every
   * part with UVs. A triangle is masked if at least half of it is white.
   */
  maskImages?: MaskImages | undefined;
  /**
   * The attribute of colours, such as "COLOR_0", whose red says never and whose green says always: a vertex is masked if one of them
   * exceeds the other by at least half.
   */
  maskColors?: string | undefined;
}

/**
 * Masks for the arrays of a model: given ones first, then those of colours and images.
 * @throws {InputError} if no part has UVs or colours for them.
 */
export function masksOf(
  model: Materials,
  given: Masks | undefined,
  { images, colors }: { images: MaskImages | undefined; colors: string | undefined },
): Masks | undefined {
  const { parts } = model;
  const shown = images?.never || images?.always ? images : undefined;
  if (parts.length === 0 || (!shown && colors === undefined)) return given;
  const [vertices, triangles] = endOf(parts).map((count) => new Int8Array(count)) as [Int8Array, Int8Array];
  let hasUvs = false;
  let hasColors = false;
  for (const part of parts) {
    const found = colors === undefined ? undefined : model.colorsOf(part, colors);
    if (found && found.size >= 3) {
      hasColors = true;
      vertices.set(maskVertices(found.values, found.size as 3 | 4), part.firstVertex);
    }
    const use = model.colorUseOf(part);
    const stored = shown && model.uvsOf(part, use?.set ?? 'TEXCOORD_0');
    if (!stored) continue;
    hasUvs = true;
    const uvs = layUvs(stored, use?.transform);
    triangles.set(maskTriangles({ indices: part.localIndices, uvs }, shown), part.firstTriangle);
  }
  if (colors !== undefined && !hasColors) throw new InputError(`no part has ${colors} of 3 or 4 numbers`);
  if (shown && !hasUvs) throw new InputError('no part has UVs for a mask');
  return { vertices: over(given?.vertices, vertices), triangles: over(given?.triangles, triangles) };
}

/** Masks under those that are given. Ones of a wrong length are left to be refused. */
function over(given: Int8Array | undefined, found: Int8Array): Int8Array {
  if (!(given instanceof Int8Array)) return given ?? found;
  return given.length === found.length ? found.map((mask, i) => given[i] || mask) : given;
}
