import { SRGBColorSpace, Texture, type WebGLRenderer } from 'three';
import { show } from '../../core/error.js';
import { fromDataUrl, toPng } from '../canvas.js';
import { kPaint, notA, wrong } from '../errors.js';
import { kWhole, toTexels } from '../gpu/rect.js';
import { readStraight } from '../gpu/straight.js';
import { Composite } from './composite.js';
import { type Layer, plainStyle, readStyle, type Sheet, type Style } from './layer.js';
import { PaintedSheet, type PaintingSize, paintingSizes } from './painted-sheet.js';
import { checkRegion, type Regions } from './regions.js';
import { maxLayers } from './stack.js';

const kVersion = 1;

/** A layer as plain data. */
export interface SavedLayer extends Style {
  name: string;
  /** The data URL of an image file, in the cage's UV space. */
  image: string;
  /** Texels per side of a painting, which can be painted on again. Default: it is no painting. */
  painting?: PaintingSize | undefined;
}

/** Layers as plain data, for `JSON.stringify`. */
export interface SavedLayers {
  /** Of this format. */
  version: typeof kVersion;
  /** From the lowest to the uppermost. */
  layers: SavedLayer[];
}

/** The layers as data. */
export async function saveLayers(renderer: WebGLRenderer, layers: readonly Layer[]): Promise<SavedLayers> {
  const saved = layers.map(({ name, sheet, opacity, tint, blend, visible, region }) => {
    const painting = sheet instanceof PaintedSheet ? sheet.size : undefined;
    return {
      ...{ name, opacity, tint, blend, visible, region },
      ...(painting && { painting }),
      pixels: drawn(renderer, sheet, painting, (composite) =>
        readStraight(renderer, composite.texture, composite.size),
      ),
    };
  });
  const named = async ({ pixels, ...layer }: (typeof saved)[number]) => ({ ...layer, image: await toPng(pixels) });
  return { version: kVersion, layers: await Promise.all(saved.map(named)) };
}

/** A layer of saved ones. */
export interface LoadedLayer {
  name: string;
  sheet: Sheet;
  style: Partial<Style>;
}

/**
 * Reads what `saveLayers` returned.
 * @param regions  Of the cage, if there is one.
 * @throws {CagecastError} `badArgument` that names the layer, `badOption` for a style or a region.
 */
export async function loadLayers(
  renderer: WebGLRenderer,
  saved: SavedLayers,
  regions: Regions | undefined,
): Promise<LoadedLayer[]> {
  const { version, layers } = Object(saved) as Partial<SavedLayers>;
  if (!Array.isArray(layers)) throw notA('what save returned', 'saved', saved, kPaint);
  if (version !== kVersion) throw wrong(`saved.version is ${show(version)}, not ${kVersion}`, kPaint);
  if (layers.length > maxLayers) throw wrong(`saved.layers are ${layers.length}, more than ${maxLayers}`, kPaint);
  const checked = layers.map((layer, i) => {
    const { name, painting } = layer ?? {};
    if (typeof name !== 'string') throw notA('a name', `saved.layers[${i}].name`, name, kPaint);
    if (painting !== undefined && !paintingSizes.includes(painting))
      throw notA(paintingSizes.join(' or '), `saved.layers[${i}].painting`, painting, kPaint);
    const style = readStyle(layer, `saved.layers[${i}]`);
    checkRegion(style.region, regions);
    return { layer, style };
  });
  return Promise.all(
    checked.map(async ({ layer: { name, image, painting }, style }, i) => {
      const bitmap = await fromDataUrl(String(image)).catch((error: Error) => {
        throw wrong(`saved.layers[${i}].image cannot be read: ${error.message}`, kPaint);
      });
      const sheet = new ImageSheet(bitmap);
      return { name, style, sheet: painting ? paintingOf(renderer, sheet, painting) : sheet };
    }),
  );
}

/** A sheet with an image of its own. */
class ImageSheet implements Sheet {
  readonly texture: Texture;
  readonly bytes: number;
  readonly dispose: () => void;

  constructor(bitmap: ImageBitmap) {
    const settings = { flipY: false, colorSpace: SRGBColorSpace, generateMipmaps: false, needsUpdate: true };
    this.texture = Object.assign(new Texture(bitmap), settings);
    this.bytes = 4 * bitmap.width * bitmap.height;
    this.dispose = () => {
      this.texture.dispose();
      bitmap.close();
    };
  }
}

/** A sheet to paint on that shows what another one does, in its place. */
function paintingOf(renderer: WebGLRenderer, sheet: ImageSheet, size: PaintingSize): PaintedSheet {
  const painting = new PaintedSheet(size);
  painting.put(
    renderer,
    toTexels(kWhole, size),
    drawn(renderer, sheet, size, (composite) => composite.read(renderer)),
  );
  sheet.dispose();
  return painting;
}

/** Draws a sheet by itself: whatever its texture is, the renderer can read it then. */
function drawn<Result>(
  renderer: WebGLRenderer,
  sheet: Sheet,
  size: number | undefined,
  read: (composite: Composite) => Result,
): Result {
  const composite = new Composite(size);
  composite.set([{ ...plainStyle, id: 0, name: '', sheet }]);
  composite.update(renderer);
  const result = read(composite);
  composite.dispose();
  return result;
}
