import type { Mesh } from '../../api/index.js';
import type { Image } from '../../bake/image.js';
import type { Angles, ViewName } from './views.js';

/** Options of `thumbnail`. */
export interface ThumbnailOptions {
  /** Pixels along each side; 16 to 2048. Default: 256. */
  size?: number | undefined;
  /**
   * From where the model is seen: `front`, `back`, its own `left` and `right`, `top`, `bottom`; `face`, its head from the front, or all of it
   * if no joint is called a head; or an azimuth and an elevation. Default: `front`, which is +z, and −z of a VRM 0.
   */
  view?: ViewName | Angles | undefined;
  /** The parts that fill the picture, as patterns for names of nodes, meshes and materials; `*` is any text. Default: all drawn ones. */
  frame?: readonly string[] | undefined;
  /** What is to fill the picture, by a cage around it: the bytes of a GLB, or a mesh, in the space of the model's scene. */
  cage?: Uint8Array | Pick<Mesh, 'positions'> | undefined;
  /** The colour behind the model: `#rrggbb`, or `#rrggbbaa`. Default: transparent. */
  background?: string | undefined;
  /**
   * Decodes an image of the model: RGBA, not premultiplied. Default: `createImageBitmap` and `OffscreenCanvas`; Node has neither, and takes
   * what sharp makes, as in the example.
   */
  decode?: ((bytes: Uint8Array, mimeType: string) => Image | Promise<Image>) | undefined;
}

/** What `thumbnail` made. */
export interface Thumbnail {
  /** Pixels, both the same. */
  width: number;
  height: number;
  /** RGBA, 4 bytes per pixel, not premultiplied, from the top left, as `ImageData` and sharp take it. */
  data: Uint8ClampedArray<ArrayBuffer>;
  /** What fills the picture: `face` only if a head was found. */
  framed: 'model' | 'face' | 'parts' | 'cage';
  /** The textures that are not shown, each with the reason: `"skin: is a KTX2 image"`. Their materials have their plain colours. */
  undecoded: string[];
}

/** Pixels along each side: by default, at least, at most. */
export const [kSize, kSmallest, kLargest] = [256, 16, 2048];
const kHex = /^#(?:[\da-f]{6}|[\da-f]{8})$/i;

/** Whether a text is a colour as `background` takes it. */
export const isColor = (text: unknown): text is string => typeof text === 'string' && kHex.test(text);
