import { ImageLoader } from 'three';
import { imageType } from '../gltf/image-file.js';

/** Why a file beside a model is missing. */
export const kNotFound = 'it was not found';

/** What stands for an image, in place of an element of a page: its bytes, if it was found and a GLB can hold it. */
export interface ImageBytes {
  bytes: Uint8Array | undefined;
}

/**
 * Calls a loader whose images are read as bytes, and not decoded: there need be no page. Loaders ask for images while they parse, which
 * they do at once: only so long three's own way is replaced.
 * @param read  Reads a file beside the model.
 * @param parse  Calls the loader, before it first waits for anything.
 * @param onMissing  Called for each image that there is not, or that a GLB cannot hold.
 */
export async function withFiles<Scene>(
  read: (name: string) => Promise<Uint8Array | undefined>,
  parse: () => Promise<Scene>,
  onMissing: (name: string, reason: string) => void,
): Promise<Scene> {
  const { load } = ImageLoader.prototype;
  const { warn } = console;
  const page = globalThis as { window?: object };
  const { window } = page;
  const images: Promise<unknown>[] = [];
  ImageLoader.prototype.load = (url, onLoad) => {
    const image: ImageBytes = { bytes: undefined };
    images.push(
      readImage(read, url)
        .catch(() => undefined)
        .then((bytes) => {
          const type = bytes && imageType(bytes);
          if (!bytes) onMissing(nameOf(url), kNotFound);
          else if (type === undefined || type === 'image/ktx2')
            onMissing(nameOf(url), 'it is no PNG, JPEG or WebP image');
          else image.bytes = bytes;
          onLoad?.(image as unknown as HTMLImageElement);
        }),
    );
    return image as unknown as HTMLImageElement;
  };
  console.warn = () => {}; // of what they leave out
  page.window ??= { innerWidth: 1, innerHeight: 1 }; // asked for by cameras
  let scene: Promise<Scene>;
  try {
    scene = parse();
  } finally {
    ImageLoader.prototype.load = load;
    console.warn = warn;
    if (!window) delete page.window;
  }
  const done = await scene;
  await Promise.all(images);
  return done;
}

/** The name of an image as it stands in the model, with slashes. */
const nameOf = (url: string): string => (isInside(url) ? 'an image in it' : url.replaceAll('\\', '/'));

/** Whether an image is within the model. */
const isInside = (url: string): boolean => /^(blob|data):/.test(url);

async function readImage(
  read: (name: string) => Promise<Uint8Array | undefined>,
  url: string,
): Promise<Uint8Array | undefined> {
  if (isInside(url)) return new Uint8Array(await (await fetch(url)).arrayBuffer());
  const name = nameOf(url);
  // Of a path on the computer where the model was made, at least the file's name may hold.
  return (await read(name)) ?? read(name.split('/').at(-1)!);
}
