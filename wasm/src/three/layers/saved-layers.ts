import { SRGBColorSpace, Texture, type WebGLRenderer } from 'three';
import { maxCompositeSize } from '../../gltf/look/saved-images.js';
import {
  type CheckedLayer,
  kWhite,
  type PaintingSize,
  type Regions,
  readSavedLayers,
  type SavedChannels,
  type SavedLayer,
  type SavedLayers,
  savedChannels,
  savedVersion,
} from '../../gltf/look/saved-layers.js';
import { areEqual } from '../../gltf/look/style.js';
import { toPng } from '../canvas.js';
import { kWhole, toTexels } from '../gpu/rect.js';
import { readStraight, Stored } from '../gpu/straight.js';
import { Composite } from './composite.js';
import { type Layer, plainStyle, type Sheet, type Style } from './layer.js';
import { sidesOf, storedIn } from './layer-pass.js';
import { PaintedSheet } from './painted-sheet.js';
import { decoded } from './saved-images.js';

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
  return { version: savedVersion, layers: saved, images, ...(baseTint !== kWhite && { baseTint }) };
}

/** As many texels as a texture has, or as many as can be loaded, in its proportions. */
function savedSize(texture: Texture): readonly [width: number, height: number] {
  const sides = sidesOf(texture);
  const share = Math.min(1, maxCompositeSize / Math.max(...sides));
  const [width, height] = sides.map((side) => Math.max(1, Math.round(share * side)));
  return [width!, height!];
}

/** The place and the channels of a layer, as far as they are not as by default. */
function channelsIn(layer: Required<SavedChannels>): SavedChannels {
  const given = savedChannels.filter((name) => !areEqual(layer[name], plainStyle[name]));
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
  const { layers: checked, baseTint } = readSavedLayers(saved, regions);
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

async function loadLayer(renderer: WebGLRenderer, layer: CheckedLayer): Promise<LoadedLayer> {
  const { name, painting, image, normal } = layer;
  const style: Partial<Style> = { ...layer.style };
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
