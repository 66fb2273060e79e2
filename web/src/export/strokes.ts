import type { WebGLRenderer } from 'three';
import { type Layer, PaintedSheet, readStraight } from '#three';
import { loadPaint } from '../loading/load-paint';
import { pngOf } from '../platform/png';
import type { Paint } from '../state/paint';
import { packedSides, packTexels, unpackTexels } from './packed-texels';

const kPrefix = 'strokes:';
/** Letters of all layers in a link: messengers cut what is much longer. */
const kMaxLength = 6000;

/** What was painted with brushes and stickers, as texts of links. */
export class Strokes {
  readonly #renderer: WebGLRenderer | undefined;
  /** The texts of a sheet, by their sides, for the thumbnail that it had then. */
  readonly #written = new WeakMap<PaintedSheet, { of: string; texts: Map<number, Promise<string>> }>();

  /** @param renderer Undefined without WebGL. */
  constructor(renderer: WebGLRenderer | undefined) {
    this.#renderer = renderer;
  }

  /**
   * The texts for the layers that are painted, as fine as fits into a link. Where even the coarsest are too much, the longest have none.
   * Cost: each is read back once.
   */
  async write(layers: readonly Layer[]): Promise<Map<Layer, string>> {
    let texts: [Layer, string][] = [];
    const length = (): number => texts.reduce((sum, [, text]) => sum + text.length, 0);
    for (const side of packedSides) {
      texts = await Promise.all(
        layers.map(async (layer): Promise<[Layer, string]> => [layer, await this.#text(layer, side)]),
      );
      texts = texts.filter(([, text]) => text);
      if (length() <= kMaxLength) break;
    }
    texts.sort(([, one], [, other]) => one.length - other.length);
    while (length() > kMaxLength) texts.pop();
    return new Map(texts);
  }

  /** Empty for other layers. */
  async #text({ sheet }: Layer, side: number): Promise<string> {
    const { linked } = sheet as Partial<Paint>;
    if (linked) return linked;
    if (!(sheet instanceof PaintedSheet) || !sheet.picture || !this.#renderer) return '';
    const known = this.#written.get(sheet);
    const { texts } = known?.of === sheet.picture ? known : { texts: new Map<number, Promise<string>>() };
    this.#written.set(sheet, { of: sheet.picture, texts });
    const text = texts.get(side) ?? packTexels(readStraight(this.#renderer, sheet.texture, side));
    texts.set(side, text);
    text.catch(() => texts.delete(side)); // it is tried again
    return kPrefix + (await text);
  }

  /** Whether a text of a link is of strokes. */
  static has = (text: string): boolean => text.startsWith(kPrefix) && text.length <= kMaxLength;

  /** The paint of a text; undefined if that is damaged. */
  static async read(text: string): Promise<Paint | undefined> {
    const texels = await unpackTexels(text.slice(kPrefix.length));
    if (!texels) return undefined;
    const png = await pngOf(new ImageData(texels.data, texels.width));
    return { ...(await loadPaint(new File([png], 'Painting', { type: 'image/png' }))), linked: text };
  }
}
