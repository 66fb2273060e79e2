import type { Texture } from 'three';
import type { Masks } from '../api/index.js';
import type { Parts } from '../api/parts.js';
import { type Image, maskTriangles, maskVertices } from '../bake/index.js';
import { localIndices } from '../parts/prepare.js';
import { valuesOf } from './apply/attributes.js';
import { extract } from './apply/extract-scene.js';
import type { Loaded } from './apply/models.js';
import { type Context, makeCanvas } from './canvas.js';
import { checkNames, wrong } from './errors.js';

/** Where the masks of a model come from. */
export interface ModelMasks {
  /** White where the model is never painted, in its own UVs: the attribute `uv`. Its image must be loaded. */
  never?: Texture | Image | undefined;
  /** White where it is always painted. */
  always?: Texture | Image | undefined;
  /** An attribute of colours, 3 or 4 numbers each, such as "color": red vertices are never painted, green ones always. */
  attribute?: string | undefined;
  /** The same as of `applyTransfer`. */
  parts?: Parts | undefined;
}

/**
 * Masks for `applyTransfer`, from textures in a model's own UVs or from vertex colours: for a scan in one piece, whose eyes no lock
 * can name. Textures hold for every part with UVs; a triangle is masked if at least half of it is white.
 * @param target  Before a transfer was applied to it.
 * @throws {CagecastError} `badArgument` if no part has UVs or the attribute, or a texture has no image that can be read; `badOption`.
 *
 * @example
 * applyTransfer(scan, { cage, texture: paint, masks: modelMasks(scan, { never: eyes }) });
 */
export function modelMasks(target: Loaded, options: ModelMasks): Masks {
  checkNames('modelMasks', 'options', options, ['never', 'always', 'attribute', 'parts']);
  const { never, always, attribute, parts: patterns } = options;
  const { mesh, parts } = extract(target, 'target', patterns);
  const images = { never: never && imageOf('never', never), always: always && imageOf('always', always) };
  const vertices = new Int8Array(mesh.positions.length / 3);
  const triangles = new Int8Array(mesh.indices.length / 3);
  const missing = new Set<string>();
  if (never || always) missing.add('uv');
  if (attribute !== undefined) missing.add(attribute);
  for (const part of parts) {
    const { geometry, firstVertex, vertexCount, firstTriangle } = part;
    const values = (name: string, ...sizes: number[]) => {
      const found = geometry.getAttribute(name);
      if (!sizes.includes(found?.itemSize)) return undefined;
      missing.delete(name);
      return valuesOf(found).subarray(0, found.itemSize * vertexCount);
    };
    const colors = attribute !== undefined && values(attribute, 3, 4);
    if (colors) vertices.set(maskVertices(colors, (colors.length / vertexCount) as 3 | 4), firstVertex);
    const uvs = (never || always) && values('uv', 2);
    if (!uvs) continue;
    const indices = localIndices({ ...part, mirrored: false }, mesh.indices);
    triangles.set(maskTriangles({ indices, uvs }, images), firstTriangle);
  }
  for (const name of missing) throw wrong(`no part of target has the attribute ${name}`, 'modelMasks');
  return { vertices, triangles };
}

/** The pixels of a texture, in the order of v: three.js flips most textures as it reads them, so they are flipped here, too. */
function imageOf(name: string, given: Texture | Image): Image {
  if (!('isTexture' in given)) return given;
  const image = (given.image ?? {}) as HTMLImageElement & { data?: Image['data'] };
  const unreadable = (text: string) => wrong(`the texture "${name}" ${text}`, 'modelMasks');
  // The width of an element is that of its place on the page.
  const { naturalWidth: width = image.width, naturalHeight: height = image.height } = image;
  if (!(width > 0 && height > 0)) throw unreadable('is not loaded yet');
  let { data } = image;
  if (data === undefined) {
    try {
      const context = makeCanvas(width, height).getContext('2d') as Context;
      context.drawImage(image, 0, 0);
      data = context.getImageData(0, 0, width, height).data;
    } catch (error) {
      throw unreadable(`cannot be read: ${(error as Error).message}`);
    }
  }
  if (data.length !== 4 * width * height) throw unreadable(`has ${data.length} values, not 4 bytes per pixel`);
  if (!given.flipY) return { width, height, data };
  const [row, flipped] = [4 * width, new Uint8Array(data.length)];
  for (let at = 0; at < data.length; at += row) flipped.set(data.subarray(at, at + row), data.length - row - at);
  return { width, height, data: flipped };
}
