import { Cache, type Light, type Material, type Mesh, type Object3D, SRGBColorSpace, Texture } from 'three';
import type { GLTF, GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import type { CagecastError } from '../api/index.js';
import { checkGltf, checkImage } from '../gltf/checks/check-gltf.js';

/** A file, and where it came from. */
export interface Fetched {
  url: string;
  blob: Blob;
}

/** Fetches a file. @throws Error that names the attribute and the address. */
export async function fetchFile(attribute: string, address: string, signal: AbortSignal): Promise<Fetched> {
  let response: Response;
  let blob: Blob;
  try {
    response = await fetch(new URL(address, document.baseURI).href, { signal });
    blob = await response.blob();
  } catch (cause) {
    signal.throwIfAborted();
    throw new Error(`${attribute}: ${address} cannot be fetched (${(cause as Error).message})`, { cause });
  }
  const { ok, url, status, statusText } = response;
  if (!ok) throw new Error(`${attribute}: ${url}: ${status} ${statusText}`.trim());
  return { url, blob };
}

/** Reads a model from its file. @throws Error that names the attribute and the address. */
export async function readModel(loader: GLTFLoader, attribute: string, { url, blob }: Fetched): Promise<GLTF> {
  try {
    const bytes = await blob.arrayBuffer();
    checkCost(new Uint8Array(bytes));
    // Beside a blob or a data address there is nothing.
    const folder = /^(blob|data):/.test(url) ? '' : new URL('.', url).href;
    const gltf = await loader.parseAsync(bytes, folder);
    // The stage has lights of its own; thousands of others would keep shaders from being compiled.
    gltf.scene.traverse((object) => (object as Partial<Light>).isLight && object.layers.disableAll());
    return gltf;
  } catch (cause) {
    throw new Error(`${attribute}: ${url} cannot be read (${(cause as Error).message})`, { cause });
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
    throw new Error((error as CagecastError).reason ?? (error as Error).message, { cause: error });
  }
}

/** As three.js wants pictures: not multiplied by their alpha, and without a change of colours. */
const asStored: ImageBitmapOptions = { premultiplyAlpha: 'none', colorSpaceConversion: 'none' };

/** Loads a picture as a texture as glTF has them. @throws Error that names the attribute and the address. */
export async function loadPaint(address: string, signal: AbortSignal): Promise<Texture> {
  const { url, blob } = await fetchFile('paint', address, signal);
  try {
    checkImage(new Uint8Array(await blob.arrayBuffer()));
  } catch (cause) {
    throw new Error(`paint: ${url} cannot be read (${(cause as CagecastError).reason})`, { cause });
  }
  // Not as an image element, whose addresses may not be allowed to be those of blobs.
  const picture = await createImageBitmap(blob, asStored).catch((cause: unknown) => {
    throw new Error(`paint: ${url} is not a picture (${(cause as Error).message})`, { cause });
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

/** Frees the geometries, materials, textures and pictures of a model. */
export function disposeModel(model: Object3D): void {
  model.traverse((child) => {
    const { geometry, material } = child as Partial<Mesh>;
    geometry?.dispose();
    for (const one of [material].flat()) if (one) disposeMaterial(one);
  });
}

function disposeMaterial(material: Material): void {
  for (const value of Object.values(material)) {
    if (!(value instanceof Texture)) continue;
    value.dispose();
    // What is in the page's cache may be shown again.
    if (!Cache.enabled && value.image instanceof ImageBitmap) value.image.close();
  }
  material.dispose();
}
