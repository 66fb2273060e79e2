import type { Classification } from 'cagecast';
import type { Vector2 } from 'three';
import {
  type Aim,
  type CageMesh,
  type Layer,
  LayerPainter,
  type PaintedLayers,
  PaintedSheet,
  type PaintingSize,
  type PointerView,
  readStraight,
  type StickerPart,
  StickersSheet,
} from '#three';
import { showError } from '../../platform/page';
import type { ExtractedMesh } from '../../state/model';
import type { Session } from '../../state/session';
import type { Spot } from '../../view/pick';
import type { Viewer } from '../../view/viewer';
import type { PaintOptions } from './paint-options';
import { PartUvs, uvOf } from './part-uvs';

const kPicture = 96; // pixels per side of a layer's thumbnail
const kPictureDelay = 300; // milliseconds

/** The layers that are painted on, their composite, and the undo steps. */
export type Layers = Omit<PaintedLayers, 'renderer'>;

/** Paints on the cage of the session: maps spots of the target to points of the cage, and makes thumbnails. */
export class Painter extends LayerPainter implements PointerView {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #options: PaintOptions;
  readonly #stack: Layers['stack'];
  #picturing: ReturnType<typeof setTimeout> | undefined;
  #parts: { of: Classification; uvs: PartUvs } | undefined;
  readonly #unpictured = new Set<PaintedSheet>();
  /** Called before texels are saved: it removes what is only a preview. */
  settle: () => void = () => {};

  constructor(session: Session, viewer: Viewer, layers: Layers, options: PaintOptions) {
    super({ renderer: viewer.renderer, ...layers });
    this.#session = session;
    this.#viewer = viewer;
    this.#options = options;
    this.#stack = layers.stack;
    session.on('transfer', ({ cage }) => {
      this.settle();
      this.setCage(atRest(cage.mesh));
    });
    layers.stack.on('select', (layer) => {
      const sheet = layer?.sheet;
      if (sheet instanceof StickersSheet && !sheet.fixed) return;
      if (sheet instanceof PaintedSheet) options.texels = sheet.size;
    });
    this.on('change', () => viewer.redraw());
    this.on('painted', (sheet) => this.#picture(sheet));
  }

  override get size(): PaintingSize {
    return this.#options.texels;
  }

  override set size(size: PaintingSize) {
    this.#options.texels = size;
  }

  override addLayer(): Layer {
    const layer = super.addLayer();
    this.hideChecker();
    return layer;
  }

  /** Hides the checker below the first paint: it was only a placeholder, and would be saved with the model. */
  hideChecker(): void {
    const { base } = this.#stack;
    if (base?.sheet === this.#session.checker) this.#stack.restyle(base, { visible: false });
  }

  /** Number of triangles of the target. */
  get triangles(): number {
    return (this.#session.shown?.target.mesh.indices.length ?? 0) / 3;
  }

  aimAt(x: number, y: number): Aim | undefined {
    return this.aimOf(this.#viewer.screen.pick(x, y));
  }

  /** Where a spot of the target takes its paint from. */
  aimOf(spot: Spot | undefined): Aim | undefined {
    const { shown, classification } = this.#session;
    if (!spot || !shown) return undefined;
    const isPainted = classification?.cosmeticTriangles[spot.triangle];
    return {
      surface: isPainted ? this.cageTexels?.at(...uvOf(spot, shown)) : undefined,
      scale: this.#viewer.screen.pixelsAt(spot.seen),
    };
  }

  /** UVs of the painted triangles of the piece that a spot lies on, 6 numbers for each. */
  uvsOfPart({ triangle }: Spot): number[] {
    return this.#partUvs?.ofPiece(triangle) ?? [];
  }

  override partAt(uv: Vector2): StickerPart | undefined {
    return this.#partUvs?.at(uv);
  }

  get #partUvs(): PartUvs | undefined {
    const { shown, classification } = this.#session;
    if (!shown || !classification) return undefined;
    if (this.#parts?.of !== classification)
      this.#parts = { of: classification, uvs: new PartUvs(shown, classification) };
    return this.#parts.uvs;
  }

  /** Begins something. @returns False, after telling why, if it cannot begin. */
  telling(begin: () => boolean): boolean {
    try {
      return begin();
    } catch (error) {
      showError((error as Error).message);
      return false;
    }
  }

  /** A painting with these texels, as `PaintedSheet.get` returns them. */
  sheetOf(size: PaintingSize, texels: Uint8Array): PaintedSheet {
    const sheet = new PaintedSheet(size);
    this.keep(sheet);
    sheet.put(this.#viewer.renderer, { left: 0, top: 0, right: size, bottom: size }, texels);
    this.#picture(sheet);
    return sheet;
  }

  /** Updates a thumbnail in the list, once the strokes pause. */
  #picture(sheet: PaintedSheet): void {
    this.#unpictured.add(sheet);
    clearTimeout(this.#picturing);
    this.#picturing = setTimeout(() => {
      for (const one of this.#unpictured)
        one.picture = addressOf(readStraight(this.#viewer.renderer, one.texture, kPicture));
      this.#unpictured.clear();
      this.#stack.pictured();
    }, kPictureDelay);
  }
}

const cagesAtRest = new WeakMap<ExtractedMesh, CageMesh>();

/** A cage as it is painted: at rest, however it is moved with the model. The same object for the same cage; undefined without UVs. */
function atRest(mesh: ExtractedMesh): CageMesh | undefined {
  const { uvs, indices } = mesh;
  if (!uvs) return undefined;
  const positions = (mesh.rest ??= mesh.positions.slice());
  const cage = cagesAtRest.get(mesh) ?? { positions, indices, uvs };
  cagesAtRest.set(mesh, cage);
  return cage;
}

function addressOf(image: ImageData): string {
  const canvas = document.createElement('canvas');
  canvas.width = image.width;
  canvas.height = image.height;
  canvas.getContext('2d')!.putImageData(image, 0, 0);
  return canvas.toDataURL();
}
