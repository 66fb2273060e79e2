import { SRGBColorSpace, Texture, type WebGLRenderer } from 'three';
import { CagecastError, show } from '../../core/error.js';
import { toPng } from '../canvas.js';
import { checkColor, notA, wrong } from '../errors.js';
import { kWhole, toTexels } from '../gpu/rect.js';
import { readStraight, Stored } from '../gpu/straight.js';
import { kWhite } from './base-tint.js';
import { Composite, maxCompositeSize } from './composite.js';
import { type Layer, plainStyle, readStyle, type Sheet, type Style } from './layer.js';
import { sidesOf, storedIn } from './layer-pass.js';
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
  /** Its image in the cage's UV space, the first row at v = 0, as glTF has it: a place in `images`, or the data URL of an image file. */
  image: number | string;
  /** Texels per side of a painting, which can be painted on again. Default: it is no painting. */
  painting?: PaintingSize | undefined;
  /** Its normal map, in the same way. Default: it has none. */
  normal?: number | string | undefined;
}

/** Layers as plain data, for `JSON.stringify`. */
export interface SavedLayers {
  /** Of this format. */
  version: typeof kVersion;
  /** From the lowest to the uppermost. */
  layers: SavedLayer[];
  /** The data URLs of image files, each once, of the size that it has as a layer, or of 2048 pixels along the longer side. Default: none. */
  images?: string[] | undefined;
  /** As `Layers.baseTint`. Default: white. */
  baseTint?: string | undefined;
}

/** The layers as data. */
export async function saveLayers(
  renderer: WebGLRenderer,
  layers: readonly Layer[],
  baseTint: string,
): Promise<SavedLayers> {
  const read = new Map<Texture, Promise<string>>();
  /** Reads a texture, once. */
  const urlOf = (texture: Texture, pixels: () => ImageData): Promise<string> => {
    const url = read.get(texture) ?? toPng(pixels());
    read.set(texture, url);
    return url;
  };
  // All of them at once: what is drawn meanwhile is not in it.
  const reading = layers.map(({ sheet, normal }) => ({
    image: urlOf(sheet.texture, () => readStraight(renderer, sheet.texture, savedSize(sheet.texture), storedIn(sheet))),
    normal: normal ? urlOf(normal, () => readRelief(renderer, normal)) : undefined,
  }));
  await Promise.all(read.values());
  const images: string[] = [];
  const placeOf = (url: string): number => (images.includes(url) ? images.indexOf(url) : images.push(url) - 1);
  const saved: SavedLayer[] = [];
  for (const [i, { name, sheet, opacity, tint, blend, visible, region, normal: _, ...rest }] of layers.entries()) {
    const normal = await reading[i]!.normal;
    saved.push({
      ...{ name, opacity, tint, blend, visible, region },
      ...(sheet instanceof PaintedSheet && { painting: sheet.size }),
      ...channelsIn(rest),
      image: placeOf(await reading[i]!.image),
      ...(normal !== undefined && { normal: placeOf(normal) }),
    });
  }
  return { version: kVersion, layers: saved, images, ...(baseTint !== kWhite && { baseTint }) };
}

/** As many texels as a texture has, or as many as can be loaded, in its proportions. */
function savedSize(texture: Texture): readonly [width: number, height: number] {
  const sides = sidesOf(texture);
  const share = Math.min(1, maxCompositeSize / Math.max(...sides));
  const [width, height] = sides.map((side) => Math.max(1, Math.round(share * side)));
  return [width!, height!];
}

/** Those channels of a layer that are not as by default. */
function channelsIn(layer: Required<SavedChannels>): SavedChannels {
  const given = kChannels.filter((name) => layer[name] !== plainStyle[name]);
  return Object.fromEntries(given.map((name) => [name, layer[name]]));
}

/** A normal map as an image, as glTF has it. */
function readRelief(renderer: WebGLRenderer, normal: Texture): ImageData {
  const image = readStraight(renderer, normal, savedSize(normal), Stored.data);
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
  const { version, layers, images, baseTint = kWhite } = Object(saved) as Partial<SavedLayers>;
  if (!Array.isArray(layers)) throw notA('what save returned', 'saved', saved);
  if (version !== kVersion) throw wrong(`saved.version is ${show(version)}, not ${kVersion}`);
  if (layers.length > maxLayers) throw wrong(`saved.layers are ${layers.length}, more than ${maxLayers}`);
  checkColor('saved.baseTint', baseTint);
  const placeOf = (i: number): string => `saved.layers[${i}]`;
  const styles = Array.from(layers, (layer, i) => checkLayer(layer, placeOf(i), regions));
  const checked = layers.map(({ name, painting, image, normal }, i): CheckedLayer => {
    return {
      ...{ name, painting, style: styles[i]! },
      image: readImage(urlIn(images, image), `${placeOf(i)}.image`, painting),
      normal: normal === undefined ? undefined : readImage(urlIn(images, normal), `${placeOf(i)}.normal`),
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

/** The image that a layer names by its place in a list; or what else it says. */
const urlIn = (images: unknown, image: unknown): unknown =>
  typeof image === 'number' ? ((images as unknown[] | undefined)?.[image] ?? image) : image;

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
