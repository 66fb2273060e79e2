import type { BufferGeometry, Object3D, Texture } from 'three';
import { type Image, maskTriangles, maskVertices } from '../bake/index.js';
import { CagecastError, type Masks } from '../index.js';
import { extract } from './extract.js';

/** Where the masks of a model come from. */
export interface ModelMasks {
  /** White where the model is never painted, in its own UVs: the attribute `uv`. Its image must be loaded. */
  never?: Texture | Image | undefined;
  /** White where it is always painted. */
  always?: Texture | Image | undefined;
  /** An attribute of colours, such as "color": red vertices are never painted, green ones always. */
  attribute?: string | undefined;
}

/**
 * Masks for `applyTransfer`, from textures in a model's own UVs or from vertex colours: for a scan in one piece, whose eyes no lock
 * can name. Textures hold for every part with UVs; a triangle is masked if at least half of it is white.
 * @param target  Before a transfer was applied to it.
 * @throws {CagecastError} `badArgument` if no part has UVs or the attribute, or a texture has no image that can be read.
 *
 * @example
 * applyTransfer(scan.scene, cage.scene, { texture: paint, masks: modelMasks(scan.scene, { never: eyes }) });
 */
export function modelMasks(target: Object3D | BufferGeometry, { never, always, attribute }: ModelMasks): Masks {
  const { mesh, parts } = extract(target, 'target');
  const images = { never: never && imageOf('never', never), always: always && imageOf('always', always) };
  const vertices = new Int8Array(mesh.positions.length / 3);
  const triangles = new Int8Array(mesh.indices.length / 3);
  const wanted = { uv: Boolean(never || always), [attribute ?? '']: attribute !== undefined };
  for (const { geometry, firstVertex, vertexCount, firstTriangle, triangleCount } of parts) {
    const values = (name: string, size: number) => {
      const found = geometry.getAttribute(name);
      if (!found || found.itemSize < size) return undefined;
      wanted[name] = false;
      return Float32Array.from({ length: size * vertexCount }, (_, i) =>
        found.getComponent(Math.floor(i / size), i % size),
      );
    };
    const colors = attribute === undefined ? undefined : values(attribute, 3);
    if (colors) vertices.set(maskVertices(colors, 3), firstVertex);
    const uvs = never || always ? values('uv', 2) : undefined;
    if (!uvs) continue;
    const indices = mesh.indices
      .subarray(3 * firstTriangle, 3 * (firstTriangle + triangleCount))
      .map((v) => v - firstVertex);
    triangles.set(maskTriangles({ indices, uvs }, images), firstTriangle);
  }
  const missing = Object.keys(wanted).find((name) => wanted[name]);
  if (missing !== undefined)
    throw new CagecastError('badArgument', `modelMasks: no part of target has the attribute ${missing}`);
  return { vertices, triangles };
}

/** The pixels of a texture. A row that is upside down, as three.js reads most textures, is turned. */
function imageOf(name: string, given: Texture | Image): Image {
  if (!('isTexture' in given)) return given;
  const image = given.image as Partial<Image> & CanvasImageSource;
  const wrong = (text: string) => new CagecastError('badArgument', `modelMasks: the texture "${name}" ${text}`);
  const [width, height] = [image?.width as number, image?.height as number];
  if (!(width > 0 && height > 0)) throw wrong('has no image yet; wait until it is loaded');
  let data = image.data;
  if (data === undefined) {
    const context = new OffscreenCanvas(width, height).getContext('2d')!;
    context.drawImage(image, 0, 0);
    data = context.getImageData(0, 0, width, height).data;
  }
  if (data.length !== 4 * width * height) throw wrong(`has ${data.length} values, not 4 bytes per pixel`);
  if (!given.flipY) return { width, height, data };
  const turned = new Uint8Array(data.length);
  for (let y = 0; y < height; ++y)
    turned.set(data.subarray(4 * width * y, 4 * width * (y + 1)), 4 * width * (height - 1 - y));
  return { width, height, data: turned };
}
