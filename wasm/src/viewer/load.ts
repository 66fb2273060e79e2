import { type Material, type Mesh, type Object3D, SRGBColorSpace, Texture } from 'three';
import type { GLTF, GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { checkGltf } from '../gltf/check-file.js';

/** Fetches a file. @throws Error that names the attribute and the address. */
async function fetchFile(attribute: string, address: string, signal: AbortSignal): Promise<Response> {
  const { href } = new URL(address, document.baseURI);
  const response = await fetch(href, { signal }).catch((cause: unknown) => {
    signal.throwIfAborted();
    throw new Error(`${attribute}: ${href} cannot be fetched (${(cause as Error).message})`, { cause });
  });
  if (!response.ok) throw new Error(`${attribute}: ${href}: ${response.status} ${response.statusText}`.trim());
  return response;
}

/** Loads a model. @throws Error that names the attribute and the address. */
export async function loadModel(
  loader: GLTFLoader,
  attribute: string,
  address: string,
  signal: AbortSignal,
): Promise<GLTF> {
  const response = await fetchFile(attribute, address, signal);
  const bytes = await response.arrayBuffer();
  try {
    checkCost(new Uint8Array(bytes));
    // Beside a blob or a data address there is nothing.
    const folder = /^(blob|data):/.test(response.url) ? '' : new URL('.', response.url).href;
    return await loader.parseAsync(bytes, folder);
  } catch (cause) {
    throw new Error(`${attribute}: ${response.url} cannot be read (${(cause as Error).message})`, { cause });
  }
}

/** Refuses a file that the loader, which trusts it, would take all memory for. @throws Error without the file's name. */
function checkCost(bytes: Uint8Array): void {
  const isGlb = new TextDecoder().decode(bytes.subarray(0, 4)) === 'glTF';
  // How large the other files of a .gltf are is not known before they are fetched.
  const limits = isGlb ? {} : { expansion: Infinity };
  try {
    checkGltf(bytes, { limits });
  } catch (error) {
    throw new Error((error as Error).message.replace(/^checkGltf: /, ''), { cause: error });
  }
}

/** As three.js wants pictures: not multiplied by their alpha, and without a change of colours. */
const asStored: ImageBitmapOptions = { premultiplyAlpha: 'none', colorSpaceConversion: 'none' };

/** Loads a picture as a texture as glTF has them. @throws Error that names the attribute and the address. */
export async function loadPaint(address: string, signal: AbortSignal): Promise<Texture> {
  const response = await fetchFile('paint', address, signal);
  // Not as an image element, whose addresses may not be allowed to be those of blobs.
  const picture = await createImageBitmap(await response.blob(), asStored).catch((cause: unknown) => {
    throw new Error(`paint: ${response.url} is not a picture (${(cause as Error).message})`, { cause });
  });
  return textureOf(picture);
}

/** Makes a texture as glTF has them, of a copy of its picture: it stays when the other is disposed of. */
export const copyOf = async (texture: Texture): Promise<Texture> =>
  textureOf(await createImageBitmap(texture.image as ImageBitmap, asStored));

/** A texture that closes its picture when it is disposed of. */
function textureOf(picture: ImageBitmap): Texture {
  const texture = new Texture(picture);
  texture.flipY = false;
  texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  texture.addEventListener('dispose', () => picture.close());
  return texture;
}

/** Frees the geometries, materials and textures of a model. */
export function disposeModel(model: Object3D): void {
  model.traverse((child) => {
    const { geometry, material } = child as Partial<Mesh>;
    geometry?.dispose();
    for (const one of [material].flat()) if (one) disposeMaterial(one);
  });
}

function disposeMaterial(material: Material): void {
  for (const value of Object.values(material)) if (value instanceof Texture) value.dispose();
  material.dispose();
}
