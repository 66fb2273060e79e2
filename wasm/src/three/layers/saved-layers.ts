import { SRGBColorSpace, Texture, type WebGLRenderer } from 'three';
import { CagecastError } from '../../api/index.js';
import { show } from '../../core/error.js';
import { toPng } from '../canvas.js';
import { checkColor, notA, wrong } from '../errors.js';
import { kWhole, toTexels } from '../gpu/rect.js';
import { readStraight } from '../gpu/straight.js';
import { kWhite } from './base-tint.js';
import { Composite, maxCompositeSize } from './composite.js';
import { type Layer, plainStyle, readStyle, type Sheet, type Style } from './layer.js';
import { sidesOf } from './layer-pass.js';
import { PaintedSheet, type PaintingSize, paintingSizes } from './painted-sheet.js';
import { checkRegion, type Regions } from './regions.js';
import { decoded, readImage, type SavedImage } from './saved-images.js';
import { maxLayers } from './stack.js';

const kVersion = 1;

/** What a layer makes of the surface; as in `Style`, of whose defaults a saved layer says nothing. */
const kChannels = ['roughness', 'metalness', 'emissive', 'normalScale'] as const;
type SavedChannels = Partial<Pick<Style, (typeof kChannels)[number]>>;

/** A layer as plain data. */
export interface SavedLayer extends Omit<Style, (typeof kChannels)[number] | 'normal'>, SavedChannels {
  name: string;
  /** The data URL of an image file, in the cage's UV space. */
  image: string;
  /** Texels per side of a painting, which can be painted on again. Default: it is no painting. */
  painting?: PaintingSize | undefined;
  /** The data URL of an image file with its normal map, the first row at v = 0, as glTF has it. Default: it has none. */
  normal?: string | undefined;
}

/** Layers as plain data, for `JSON.stringify`. */
export interface SavedLayers {
  /** Of this format. */
  version: typeof kVersion;
  /** From the lowest to the uppermost. */
  layers: SavedLayer[];
  /** As `Layers.baseTint`. Default: white. */
  baseTint?: string | undefined;
}

/** The layers as data. */
export async function saveLayers(
  renderer: WebGLRenderer,
  layers: readonly Layer[],
  baseTint: string,
): Promise<SavedLayers> {
  const saved = layers.map(({ name, sheet, opacity, tint, blend, visible, region, normal, ...rest }) => {
    const painting = sheet instanceof PaintedSheet ? sheet.size : undefined;
    return {
      ...{ name, opacity, tint, blend, visible, region },
      ...(painting && { painting }),
      ...channelsIn(rest),
      relief: normal && readRelief(renderer, normal),
      pixels: drawn(renderer, sheet, painting, (composite) =>
        readStraight(renderer, composite.texture, composite.size),
      ),
    };
  });
  const named = async ({ pixels, relief, ...layer }: (typeof saved)[number]) => ({
    ...layer,
    ...(relief && { normal: await toPng(relief) }),
    image: await toPng(pixels),
  });
  const all = await Promise.all(saved.map(named));
  return { version: kVersion, layers: all, ...(baseTint !== kWhite && { baseTint }) };
}

/** Those channels of a layer that are not as by default. */
function channelsIn(layer: Required<SavedChannels>): SavedChannels {
  const given = kChannels.filter((name) => layer[name] !== plainStyle[name]);
  return Object.fromEntries(given.map((name) => [name, layer[name]]));
}

/** A normal map as an image, as glTF has it. */
function readRelief(renderer: WebGLRenderer, normal: Texture): ImageData {
  const size = Math.min(maxCompositeSize, Math.max(...sidesOf(normal)));
  const image = readStraight(renderer, normal, size, true);
  // With its last row at v = 0, green means down.
  if (normal.flipY) for (let at = 1; at < image.data.length; at += 4) image.data[at] = 255 - image.data[at]!;
  return image;
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
 * @throws {CagecastError} that names the layer, the value and the limit: `badArgument`, or `badOption` for a style or a region. Nothing is
 * left of what was read then.
 */
export async function loadLayers(
  renderer: WebGLRenderer,
  saved: SavedLayers,
  regions: Regions | undefined,
): Promise<{ layers: LoadedLayer[]; baseTint: string }> {
  const { version, layers, baseTint = kWhite } = Object(saved) as Partial<SavedLayers>;
  if (!Array.isArray(layers)) throw notA('what save returned', 'saved', saved);
  if (version !== kVersion) throw wrong(`saved.version is ${show(version)}, not ${kVersion}`);
  if (layers.length > maxLayers) throw wrong(`saved.layers are ${layers.length}, more than ${maxLayers}`);
  checkColor('saved.baseTint', baseTint);
  const placeOf = (i: number): string => `saved.layers[${i}]`;
  const styles = Array.from(layers, (layer, i) => checkLayer(layer, placeOf(i), regions));
  const checked = layers.map(({ name, painting, image, normal }, i): CheckedLayer => {
    return {
      ...{ name, painting, style: styles[i]! },
      image: readImage(image, `${placeOf(i)}.image`, painting),
      normal: normal === undefined ? undefined : readImage(normal, `${placeOf(i)}.normal`),
    };
  });
  const loaded: LoadedLayer[] = [];
  try {
    // One after the other: each takes more memory while it is decoded.
    for (const layer of checked) loaded.push(await loadLayer(renderer, layer));
  } catch (error) {
    for (const { sheet, style } of loaded) {
      sheet.dispose?.();
      style.normal?.dispose();
    }
    throw error;
  }
  return { layers: loaded, baseTint };
}

const kMaxName = 1000; // characters

/** A layer of which all but its pixels is read. */
interface CheckedLayer {
  name: string;
  style: Partial<Style>;
  painting: PaintingSize | undefined;
  image: SavedImage;
  normal: SavedImage | undefined;
}

/** Checks all of a layer but its images. @param place  Of the layer, for messages. @returns its style. @throws {CagecastError} */
function checkLayer(layer: SavedLayer, place: string, regions: Regions | undefined): Partial<Style> {
  const { name, painting, normal: _, ...rest } = Object(layer) as SavedLayer;
  if (typeof name !== 'string') throw notA('a name', `${place}.name`, name);
  if (name.length > kMaxName) throw wrong(`${place}.name has ${name.length} characters, more than ${kMaxName}`);
  if (painting !== undefined && !paintingSizes.includes(painting))
    throw notA(paintingSizes.join(' or '), `${place}.painting`, painting);
  try {
    const style = readStyle(rest);
    checkRegion(style.region, regions);
    return style;
  } catch (error) {
    if (!(error instanceof CagecastError)) throw error;
    throw wrong(`${place}.${error.reason}`, undefined, error.code, { cause: error });
  }
}

async function loadLayer(renderer: WebGLRenderer, layer: CheckedLayer): Promise<LoadedLayer> {
  const { name, style, painting, image, normal } = layer;
  const sheet = new ImageSheet(await decoded(image));
  try {
    if (normal) style.normal = reliefOf(await decoded(normal));
  } catch (error) {
    sheet.dispose();
    throw error;
  }
  return { name, style, sheet: painting ? paintingOf(renderer, sheet, painting) : sheet };
}

/** A normal map with an image of its own. */
function reliefOf(bitmap: ImageBitmap): Texture {
  const texture = new Texture(bitmap);
  texture.addEventListener('dispose', () => bitmap.close());
  return Object.assign(texture, { flipY: false, generateMipmaps: false, needsUpdate: true });
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
