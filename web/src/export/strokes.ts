import { type Layer, PaintedSheet, readStraight } from 'cagecast/three/paint';
import type { WebGLRenderer } from 'three';
import { loadPaint } from '../loading/load-paint';
import type { Paint } from '../state/paint';

const kPrefix = 'strokes:';
const kSizes = [512, 256]; // texels per side
const kQuality = 0.8;
/** Characters of one layer in a link: messengers cut what is much longer. */
const kMaxLength = 12_000;

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
      ? kPrefix + data!.replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '')
      : undefined;
  }

  /** Whether a text of a link is of strokes. */
  static has = (text: string): boolean => text.startsWith(kPrefix) && text.length <= kMaxLength;

  /** The paint of a text. @throws Error if it is damaged. */
  static async read(text: string): Promise<Paint> {
    const data = text.slice(kPrefix.length).replace(/-/g, '+').replace(/_/g, '/');
    const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
    return { ...(await loadPaint(new File([bytes], 'Painting', { type: 'image/webp' }))), linked: text };
  }
}
