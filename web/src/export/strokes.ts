import type { WebGLRenderer } from 'three';
import { type Layer, PaintedSheet, readStraight } from '#three';
import { loadPaint } from '../loading/load-paint';
import type { Paint } from '../state/paint';

const kPrefix = 'strokes:';
const kSizes = [512, 256]; // texels per side
const kQuality = 0.8;
/** Characters of one layer in a link: messengers cut what is much longer. */
const kMaxLength = 12_000;

/** Bytes in base64 for addresses; undefined if they are not. */
function bytesOf(text: string): Uint8Array<ArrayBuffer> | undefined {
  try {
    return Uint8Array.from(atob(text.replace(/-/g, '+').replace(/_/g, '/')), (letter) => letter.charCodeAt(0));
  } catch {
    return undefined;
  }
}

/** Strokes and stickers as texts of links. */
export class Strokes {
  readonly #renderer: WebGLRenderer | undefined;
  /** The text of a sheet, for the thumbnail that it had then. */
  readonly #written = new WeakMap<PaintedSheet, { of: string; text: string | undefined }>();

  /** @param renderer Undefined without WebGL. */
  constructor(renderer: WebGLRenderer | undefined) {
    this.#renderer = renderer;
  }

  /** The text for a layer that is painted; undefined for others, and for what is too much for a link. Cost: it is read back once. */
  write({ sheet }: Layer): string | undefined {
    if (!(sheet instanceof PaintedSheet) || !sheet.picture) return undefined;
    const known = this.#written.get(sheet);
    if (known?.of === sheet.picture) return known.text;
    const text = kSizes.map((size) => this.#encode(sheet, size)).find((text) => text && text.length <= kMaxLength);
    this.#written.set(sheet, { of: sheet.picture, text });
    return text;
  }

  #encode(sheet: PaintedSheet, size: number): string | undefined {
    if (!this.#renderer) return undefined;
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = size;
    canvas.getContext('2d')!.putImageData(readStraight(this.#renderer, sheet.texture, size), 0, 0);
    const [head, data] = canvas.toDataURL('image/webp', kQuality).split(',');
    // Browsers that cannot encode it give a PNG.
    return head?.includes('webp')
      ? kPrefix +
          data!
            .replace(/\+/g, '-')
            .replace(/\//g, '_')
            .replace(/={1,2}$/, '')
      : undefined;
  }

  /** Whether a text of a link is of strokes. */
  static has = (text: string): boolean => text.startsWith(kPrefix) && text.length <= kMaxLength;

  /**
   * The image of a text, and its size, which nothing is decoded for.
   * @returns Undefined if it is damaged. @throws Error if it says to have other sizes than those that are written here.
   */
  static async check(text: string): Promise<File | undefined> {
    const bytes = bytesOf(text.slice(kPrefix.length));
    const { checkImage } = await import('cagecast/gltf');
    const size = bytes && checkImage(bytes);
    if (!size) return undefined;
    const { width, height } = size;
    if (width !== height || !kSizes.includes(width)) {
      const [has, may] = [[[width, height]], kSizes.map((side) => [side, side])].map((sizes) =>
        sizes.map(([w, h]) => `${w!.toLocaleString('en')} × ${h!.toLocaleString('en')}`).join(' or '),
      );
      throw new Error(`its strokes have ${has} pixels, not ${may}`);
    }
    return new File([bytes], 'Painting', { type: 'image/webp' });
  }

  /** The paint of a text. @param file  What `check` returned. @throws Error if it is damaged. */
  static async read(text: string, file: File): Promise<Paint> {
    return { ...(await loadPaint(file)), linked: text };
  }
}
