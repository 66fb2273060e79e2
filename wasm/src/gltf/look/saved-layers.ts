import { checkColor, notA, wrong } from '../../core/checks.js';
import { CagecastError, show } from '../../core/error.js';
import type { Outline } from '../../parts/template.js';
import { type ReadImages, readImage, type SavedImage } from './saved-images.js';
import { type PlainStyle, readPlainStyle } from './style.js';

/** No tint. */
export const kWhite = '#ffffff';
/** The greatest number of layers. */
export const maxLayers = 16;
/** Texels per side of the mask of a region. */
export const maskSize = 1024;
/** Sizes of paintings, in texels per side. */
export const paintingSizes = [1024, 2048] as const;
export type PaintingSize = (typeof paintingSizes)[number];

/** Outlines in UVs, by the names of regions. */
export type Regions = Readonly<Record<string, readonly Outline[]>>;

/** The version of saved layers. */
export const savedVersion = 1;

/** Where a layer lies, and what it makes of the surface; as in `PlainStyle`, of whose defaults a saved layer says nothing. */
export const savedChannels = [
  'roughness',
  'metalness',
  'emissive',
  'normalScale',
  'offset',
  'scale',
  'rotation',
  'center',
] as const;
export type SavedChannels = Partial<Pick<PlainStyle, (typeof savedChannels)[number]>>;

/** A layer as plain data. */
export interface SavedLayer extends Omit<PlainStyle, (typeof savedChannels)[number]>, SavedChannels {
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
  version: typeof savedVersion;
  /** From the lowest to the uppermost. */
  layers: SavedLayer[];
  /** The data URLs of image files, each once, of the size that it has as a layer, or of 2048 pixels along the longer side. Default: none. */
  images?: string[] | undefined;
  /** As `Layers.baseTint`. Default: white. */
  baseTint?: string | undefined;
}

/** @throws {CagecastError} `badOption` that lists the regions, for a name that none has. */
export function checkRegion(name: string | null | undefined, regions: Regions | undefined): void {
  if (name === null || name === undefined || (regions && Object.hasOwn(regions, name))) return;
  const known = Object.keys(regions ?? {});
  const why = !regions
    ? 'give createLayers the cage'
    : known.length > 0
      ? `the cage has these: ${known.map(show).join(', ')}`
      : 'the cage has none';
  throw wrong(`region is ${show(name)}, which is not known; ${why}`, undefined, 'badOption');
}

/**
 * Checks what `save` of layers returned, but for the pixels of its images.
 * @param regions  Of the cage, if there is one.
 * @throws {CagecastError} that names the layer, the value and the limit: `badArgument`, or `badOption` for a style or a region.
 */
export function readSavedLayers(
  saved: unknown,
  regions: Regions | undefined,
): { layers: CheckedLayer[]; baseTint: string } {
  const { version, layers, images, baseTint = kWhite } = Object(saved) as Partial<SavedLayers>;
  if (!Array.isArray(layers)) throw notA('what save returned', 'saved', saved);
  if (version !== savedVersion) throw wrong(`saved.version is ${show(version)}, not ${savedVersion}`);
  if (layers.length > maxLayers) throw wrong(`saved.layers are ${layers.length}, more than ${maxLayers}`);
  checkColor('saved.baseTint', baseTint);
  const placeOf = (i: number): string => `saved.layers[${i}]`;
  const styles = Array.from(layers, (layer, i) => checkLayer(layer, placeOf(i), regions));
  const known: ReadImages = new Map();
  const checked = layers.map(({ name, painting, image, normal }, i): CheckedLayer => {
    return {
      ...{ name, painting, style: styles[i]! },
      image: readImage(urlIn(images, image), `${placeOf(i)}.image`, known, painting),
      normal: normal === undefined ? undefined : readImage(urlIn(images, normal), `${placeOf(i)}.normal`, known),
    };
  });
  return { layers: checked, baseTint };
}

/** The image that a layer names by its place in a list; or what else it says. */
const urlIn = (images: unknown, image: unknown): unknown =>
  typeof image === 'number' ? ((images as unknown[] | undefined)?.[image] ?? image) : image;

const kMaxName = 1000; // characters

/** A layer of which all but its pixels is read. */
export interface CheckedLayer {
  name: string;
  style: Partial<PlainStyle>;
  painting: PaintingSize | undefined;
  image: SavedImage;
  normal: SavedImage | undefined;
}

/** Checks all of a layer but its images. @param place  Of the layer, for messages. @returns its style. @throws {CagecastError} */
function checkLayer(layer: SavedLayer, place: string, regions: Regions | undefined): Partial<PlainStyle> {
  const { name, painting, normal: _, ...rest } = Object(layer) as SavedLayer;
  if (typeof name !== 'string') throw notA('a name', `${place}.name`, name);
  if (name.length > kMaxName) throw wrong(`${place}.name has ${name.length} characters, more than ${kMaxName}`);
  if (painting !== undefined && !paintingSizes.includes(painting))
    throw notA(paintingSizes.join(' or '), `${place}.painting`, painting);
  try {
    const style = readPlainStyle(rest);
    checkRegion(style.region, regions);
    return style;
  } catch (error) {
    if (!(error instanceof CagecastError)) throw error;
    throw wrong(`${place}.${error.reason}`, undefined, error.code, { cause: error });
  }
}
