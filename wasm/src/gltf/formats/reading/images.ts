import { ImageLoader } from 'three';
import { imageIsWhole, imageSize, imageType } from '../../image-file.js';

/** Why a file beside a model is missing. */
export const kNotFound = 'it was not found';

/** What stands for an image, in place of an element of a page: its bytes, if it was found and a GLB can hold it. */
export interface ImageBytes {
  bytes: Uint8Array | undefined;
}

/**
 * Calls a loader whose images are read as bytes, and not decoded: there need be no page.
 * @param read  Reads a file beside the model.
 * @param onMissing  Called for each image that there is not, or that a GLB cannot hold.
 */
export async function withFiles<Scene>(
  read: (name: string) => Promise<Uint8Array | undefined>,
  parse: () => Promise<Scene>,
  onMissing: (name: string, reason: string) => void,
): Promise<Scene> {
  /** Of each address, however many materials have it. */
  const images = new Map<string, Promise<Uint8Array | string>>();
  ImageLoader.prototype.load = (url, onLoad) => {
    let found = images.get(url);
    if (!found) images.set(url, (found = readImage(read, url)));
    const image: ImageBytes = { bytes: undefined };
    void found.then((bytes) => {
      if (typeof bytes !== 'string') image.bytes = bytes;
      onLoad?.(image as unknown as HTMLImageElement);
    });
    return image as unknown as HTMLImageElement;
  };
  // Asked for by cameras.
  (globalThis as { window?: object }).window ??= { innerWidth: 1, innerHeight: 1 };
  const scene = await parse();
  for (const [url, found] of images) {
    const reason = await found;
    if (typeof reason === 'string') onMissing(nameOf(url), reason);
  }
  return scene;
}

/** The bytes of an image, or why there are none. */
async function readImage(
  read: (name: string) => Promise<Uint8Array | undefined>,
  url: string,
): Promise<Uint8Array | string> {
  const bytes = await bytesOf(read, url).catch(() => undefined);
  const type = bytes && imageType(bytes);
  if (!bytes) return kNotFound;
  if (type === undefined || type === 'image/ktx2') return 'it is no PNG, JPEG or WebP image';
  return imageSize(bytes) && imageIsWhole(bytes) ? bytes : 'it is damaged';
}

/** The name of an image as it stands in the model, with slashes. */
const nameOf = (url: string): string => (isInside(url) ? 'an image in it' : url.replaceAll('\\', '/'));

/** Whether an image is within the model. */
const isInside = (url: string): boolean => /^(blob|data):/.test(url);

async function bytesOf(
  read: (name: string) => Promise<Uint8Array | undefined>,
  url: string,
): Promise<Uint8Array | undefined> {
  if (isInside(url)) return new Uint8Array(await (await fetch(url)).arrayBuffer());
  const name = nameOf(url);
  // Of a path on the computer where the model was made, at least the file's name may hold.
  return (await read(name)) ?? read(name.split('/').at(-1)!);
}
