import {
  blendModes,
  type Edits,
  type Layer,
  type LayerStack,
  maxLayers,
  PaintedSheet,
  paintingSizes,
  type Sheet,
  type Style,
} from '#three';
import type { Paint } from '../paint';
import type { PutAwayLayers } from '../put-away-layers';
import { kChecker, type Samples } from '../sample';
import type { Session } from '../session';
import { damaged, listOf, numberOf, objectOf, oneOf, textOf } from './checks';
import type { Contribution, Files, Keep } from './project';

interface ReadLayer {
  name: string;
  sheet: Sheet;
  style: Partial<Style>;
}

/** What has the layers. */
export interface LayersOfPage {
  session: Session;
  stack: LayerStack;
  edits: Edits;
  away: PutAwayLayers;
  samples: Samples;
  /** Undefined without WebGL. */
  painter: Painting | undefined;
  images: ImageFiles;
}

/** What draws paintings. */
interface Painting {
  on(event: 'painted', listener: (sheet: PaintedSheet) => void): unknown;
  /** Finishes what is being drawn. */
  settle(): void;
  sheetOf(size: PaintedSheet['size'], texels: Uint8Array<ArrayBuffer>): PaintedSheet;
}

/** Reads and writes images. */
interface ImageFiles {
  /**
   * Refuses images that would take all memory together, before any is decoded. A project can name its images as it likes: none is trusted.
   * @param painted The files of paintings, and their pixels. @throws Error that names the file.
   */
  check(files: readonly File[], painted: { files: readonly File[]; pixels: number }): Promise<void>;
  /** @param picture URL of the image; an object URL of the file by default. */
  load(file: File, picture?: string): Promise<Paint>;
  /** The name of a sample's paint in links. @param picture Its URL. */
  nameOf(picture: string): string;
  /** Compresses bytes; takes the buffer. */
  pack(bytes: Uint8Array<ArrayBuffer>): Promise<Blob>;
  /** Restores them. @param size Their number. */
  unpack(packed: Blob, size: number): Promise<Uint8Array<ArrayBuffer>>;
}

/** The layers: paintings by their texels, images by their files; also those that were put away. */
export function layersPart(page: LayersOfPage): Contribution {
  const { session, stack, edits, away, samples, painter, images } = page;
  /** Stands for the texels of a painting until they change; the file where they were read from one. */
  const states = new WeakMap<PaintedSheet, object>();
  painter?.on('painted', (sheet) => states.delete(sheet));
  const saveSheet = (sheet: Sheet, keep: Keep): object => {
    if (sheet instanceof PaintedSheet) {
      const state = states.get(sheet) ?? {};
      states.set(sheet, state);
      const { size } = sheet;
      const whole = { left: 0, top: 0, right: size, bottom: size };
      const bytes = (): Uint8Array<ArrayBuffer> => {
        painter?.settle();
        return sheet.get(whole) as Uint8Array<ArrayBuffer>;
      };
      const packed = state instanceof File ? undefined : () => images.pack(bytes());
      return { size, file: keep(state, packed) };
    }
    const { file, sample, picture, drawn } = sheet as Paint;
    if (!file) return { paint: kChecker };
    return { file: keep(file), ...(sample && { paint: images.nameOf(picture) }), ...(drawn && { drawn }) };
  };
  const readSheet = async (saved: unknown, files: Files, taken: Set<unknown>): Promise<Sheet | Paint> => {
    const { size, file, paint, drawn } = objectOf(saved, 'paint');
    if (paint === kChecker) return session.checker;
    if (size === undefined) {
      const known = typeof paint === 'string' ? samples.find(paint) : undefined;
      const loaded = await images.load(files(file), known?.paint.file);
      if (typeof drawn === 'string') return { ...loaded, drawn: textOf(drawn, '') };
      return known ? { ...loaded, sample: known.sample } : loaded;
    }
    const side = sideOf(size);
    const packed = files(file);
    if (taken.has(packed)) damaged('two layers have one painting');
    taken.add(packed);
    const sheet = painter!.sheetOf(side, await images.unpack(packed, 4 * side * side));
    states.set(sheet, packed);
    return sheet;
  };
  const saveAll = (layers: readonly Layer[], keep: Keep): object[] =>
    layers.map(({ name, sheet, opacity, tint, blend, visible }) => ({
      name,
      style: { opacity, tint, blend, visible },
      sheet: saveSheet(sheet, keep),
    }));
  const readAll = async (saved: unknown, files: Files, taken: Set<unknown>): Promise<ReadLayer[]> => {
    const layers: ReadLayer[] = [];
    // One at a time: each takes memory while it is read.
    for (const one of layersIn(saved)) {
      const { name, style, sheet } = objectOf(one, 'layer');
      layers.push({ name: textOf(name, 'Layer'), style: styleOf(style), sheet: await readSheet(sheet, files, taken) });
    }
    return layers;
  };

  return {
    name: 'layers',
    isWork: true,
    save: (keep) => ({
      layers: saveAll(stack.layers, keep),
      away: saveAll(away.layers, keep),
      base: stack.base ? stack.layers.indexOf(stack.base) : -1,
    }),
    async read(saved, files) {
      const { layers, away: putAway, base } = objectOf(saved, 'layers');
      await checkImages([...layersIn(layers), ...layersIn(putAway)], files, page);
      const taken = new Set<unknown>(); // each painting takes memory of its own
      const [all, others] = [await readAll(layers, files, taken), await readAll(putAway, files, taken)];
      return {
        ready() {
          for (const { id } of stack.layers) stack.remove(id);
          // Adding gives them the ids that bring them back.
          const made = others.map(({ name, sheet, style }) => stack.add(name, sheet, style));
          for (const { id } of made) stack.remove(id);
          all.forEach(({ name, sheet, style }, place) => {
            if (place !== base) return void stack.add(name, sheet, style);
            stack.setBase(name, sheet);
            stack.restyle(stack.base!, style);
            stack.move(stack.base!, place);
          });
          stack.select(stack.layers.at(-1));
          // Earlier undo steps do not apply any more.
          edits.forget();
          away.show(made);
        },
      };
    },
  };
}

/** Checks what all images and paintings take together, before any is read. @throws Error that names a file. */
async function checkImages(saved: unknown[], files: Files, { painter, images }: LayersOfPage): Promise<void> {
  const sheets = saved.map((one) => objectOf(objectOf(one, 'layer')['sheet'], 'paint'));
  const stored = sheets.filter(({ paint }) => paint !== kChecker);
  const [painted, given] = [true, false].map((is) => stored.filter(({ size }) => (size !== undefined) === is));
  if (painted!.length > 0 && !painter) throw new Error('paintings need WebGL, which is not available in this browser');
  const pixels = painted!.reduce((sum, { size }) => sum + sideOf(size) ** 2, 0);
  const filesOf = (list: typeof stored) => list.map(({ file }) => files(file));
  await images.check(filesOf(given!), { files: filesOf(painted!), pixels });
}

const layersIn = (saved: unknown): unknown[] => listOf(saved ?? [], maxLayers, 'layers');

/** Texels per side of a painting. */
const sideOf = (size: unknown): PaintedSheet['size'] =>
  paintingSizes.find((one) => one === size) ?? damaged('a painting has an unknown size');

function styleOf(saved: unknown): Partial<Style> {
  const { opacity, tint, blend, visible } = objectOf(saved, 'style of a layer');
  return {
    opacity: numberOf(opacity, 0, 1, 1),
    tint: /^#[0-9a-f]{6}$/i.test(String(tint)) ? String(tint) : '#ffffff',
    blend: oneOf(blend, blendModes),
    visible: visible !== false,
  };
}
