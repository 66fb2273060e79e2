import { type Camera, Raycaster, type Texture, Vector2, Vector3 } from 'three';
import { show } from '../../core/error.js';
import type { PaintingSize } from '../../gltf/look/saved-layers.js';
import type { Applied } from '../apply/apply-options.js';
import { extract } from '../apply/extract-scene.js';
import type { LoadedCage } from '../apply/models.js';
import { check, checkColor, checkShare, notA, wrong } from '../errors.js';
import { Emitter } from '../layers/emitter.js';
import { createLayers, type Layers, type LayersOptions } from '../layers/layers.js';
import type { SurfacePoint } from './cage-texels.js';
import { LayerPainter } from './layer-painter.js';
import { pickSpot, pixelsPerUnit, type Spot } from './pick.js';
import { type Drag, listenTo } from './pointer.js';
import { type Aim, type BrushStyle, PointerStroke } from './pointer-stroke.js';
import { checkPicture, type StickerPicture, StickerSheet } from './sticker.js';
import { Stroke } from './stroke.js';

/** Options of `createPainter`. */
export interface PainterOptions extends Partial<Pick<LayersOptions, 'renderer'>> {
  /** The layers to paint on, of `createLayers`. Default: new ones, for which `renderer` is needed. */
  layers?: Layers | undefined;
  /** The lowest of new layers, as for `layers.add`. It is ignored where there are `layers`: add it to those. */
  texture?: Texture | undefined;
  /** What was painted: the models that pointers paint on. Each of them is given the layers' texture. */
  applied: Applied | readonly Applied[];
  /** The cage of the transfer; of several models with cages of one layout, that of one of them. */
  cage: LoadedCage;
  /** Texels per side of what is painted, 1024 or 2048. Default: 1024. */
  size?: PaintingSize | undefined;
}

/** What pointers do. */
export type Tool = 'brush' | 'eraser' | 'sticker';

/** A spot of a model, or a UV of the cage; with the pressure there, 0 to 1 (default: 1), which makes the brush smaller. */
export type StrokePoint = (Spot | { x: number; y: number }) & { pressure?: number | undefined };

/** Where a sticker lies, and how. */
export interface StickerPlace {
  /** A spot of a model, or a UV of the cage. Undefined, as `pick` returns it beside the models, is no place: nothing is laid. */
  at: Spot | { x: number; y: number } | undefined;
  /** Its longer side, as a share of the diagonal of the cage: above 0, up to 2. Default: 0.2. */
  size?: number | undefined;
  /** Radians, clockwise as seen. Default: 0. */
  angle?: number | undefined;
  /** Whether it is seen as in a mirror. Default: false. */
  mirrored?: boolean | undefined;
  /** 0 to 1. Default: 1. */
  opacity?: number | undefined;
  /** The direction of its upper edge, in the cage's space. Default: that of y. */
  up?: Vector3 | undefined;
}

const checkSize = (size: number): void => check(size > 0 && size <= 2, 'size', size, 'a number from 0 to 2');

/** Paints on models, in the cage's UV space. */
export class Painter extends Emitter<{
  /** Why a pointer cannot paint, such as no room for another layer. Without a listener it is thrown, so that the page reports it. */
  error: Error;
}> {
  readonly layers: Layers;
  /** How `stroke` and pointers paint; the fields may be set. A size of 0.05 is a twentieth of the diagonal of the cage. */
  readonly brush: Omit<BrushStyle, 'erases'> = {
    color: '#000000',
    size: 0.05,
    hardness: 0.5,
    opacity: 1,
    mirror: false,
  };
  /** What pointers do; undefined leaves them to others. */
  tool: Tool | undefined = 'brush';
  /** What pointers place with the tool `sticker`, upright as seen; the other fields are as those of `StickerPlace`. */
  picture: (StickerPicture & { size?: number; angle?: number; opacity?: number; mirrored?: boolean }) | undefined;
  readonly #painter: LayerPainter;
  readonly #models: readonly Applied[];
  readonly #sheet = new StickerSheet();
  readonly #stops = new Set<() => void>();
  readonly #unfollow: () => void;
  #isDisposed = false;

  constructor(options: PainterOptions) {
    super();
    const { layers, renderer, texture, applied, cage, size } = options ?? {};
    this.#models = [applied].flat();
    if (this.#models.some((model) => typeof model?.setTexture !== 'function'))
      throw wrong('options.applied is not what applyTransfer returned');
    const { positions, indices, uvs } = extract(cage, 'cage').mesh;
    if (!uvs) throw wrong('options.cage has no UVs');
    this.layers = layers ?? createLayers({ renderer, cage } as LayersOptions);
    if (texture && !layers) this.layers.add(texture, { undoable: false });
    this.#painter = new LayerPainter(this.layers);
    if (size !== undefined) this.#painter.size = size;
    this.#painter.setCage({ positions: Float32Array.from(positions), indices, uvs: Float32Array.from(uvs) });
    this.#unfollow = follow(this.layers, this.#painter);
    for (const model of this.#models) model.setTexture(this.layers.texture);
  }

  /** All layers in one, for further models. */
  get texture(): Texture {
    return this.layers.texture;
  }

  /**
   * The nearest spot of the models on a ray; parts that are hidden, or were taken out of the scene, are passed over. Where nothing may be
   * painted its `uv` is undefined.
   */
  pick(raycaster: Raycaster): Spot | undefined {
    return pickSpot(this.#models, raycaster, this.#painter.cageTexels);
  }

  /** As `pick`, for a position of a page, such as a pointer event. @throws {CagecastError} `badArgument` without a camera. */
  pickAt({ clientX, clientY }: { clientX: number; clientY: number }, camera: Camera): Spot | undefined {
    checkCamera(camera);
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    const at = new Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height);
    camera.updateMatrixWorld();
    const raycaster = new Raycaster();
    raycaster.setFromCamera(at, camera);
    raycaster.layers.mask = camera.layers.mask;
    return this.pick(raycaster);
  }

  /**
   * Paints a stroke along the cage through some points, as one undo step.
   * @param points  Undefined, as `pick` returns it beside the models, ends a line; the next point begins another.
   * @param style   What differs from `brush`.
   * @throws {CagecastError} `badOption` that names a field and its value, `badArgument` for points that are no array, or if there is no
   * room for a layer.
   */
  stroke(points: readonly (StrokePoint | undefined)[], style: Partial<Omit<BrushStyle, 'erases'>> = {}): void {
    this.#stroke(points, { ...this.brush, ...style, erases: false });
  }

  /**
   * Erases along some points what was painted, as `stroke` paints: what that has left, it takes away. The texture stays.
   * @throws {CagecastError} as `stroke`; never if nothing is painted yet.
   */
  erase(points: readonly (StrokePoint | undefined)[], style: Partial<Omit<BrushStyle, 'erases'>> = {}): void {
    if (this.#painter.hasPainting) this.#stroke(points, { ...this.brush, ...style, erases: true });
  }

  /**
   * Lays a text or an image on the model, as one undo step; nothing where no cage is.
   * @throws {CagecastError} as `stroke`, and `badArgument` for what is no picture or place, and for an image that is not loaded yet.
   */
  sticker(picture: StickerPicture, place: StickerPlace): void {
    checkPicture(picture);
    if (!('at' in Object(place))) throw notA('an object with "at"', 'the place', place);
    const surface = this.#surfaceAt(place.at);
    if (!surface) return;
    this.#beginSticker(picture, place)(surface, place.up);
    this.#painter.end();
  }

  /** As `layers.undo`, which takes back changes of the layers, too. */
  undo(): string | undefined {
    return this.layers.undo();
  }

  /** As `layers.redo`. */
  redo(): string | undefined {
    return this.layers.redo();
  }

  get canUndo(): boolean {
    return this.layers.canUndo;
  }

  get canRedo(): boolean {
    return this.layers.canRedo;
  }

  /** Draws the texture again where it has changed, as `layers.update`. Call it before each frame. */
  update(): boolean {
    return this.layers.update();
  }

  /** Adds an empty layer on top, which is painted on from now on. @throws {CagecastError} for the 17th layer. */
  addLayer(): void {
    this.layers.edits.do('adding a painting', () => this.#painter.addLayer());
  }

  /**
   * Lets pointers paint with `tool`: those that go down where paint may be are not seen by what listens to the element otherwise, such
   * as `OrbitControls`. Of several fingers on the page, the first one paints. The pressure of pens makes the brush smaller.
   * @param camera   By which the models are drawn on the element.
   * @param element  Default: the renderer's canvas. Its `touch-action` is `none` until no painter listens to it.
   * @returns a function that ends it. After `dispose` nothing is listened to.
   * @throws {CagecastError} `badArgument` without a camera.
   */
  listen(camera: Camera, element = this.#canvas): () => void {
    checkCamera(camera);
    if (this.#isDisposed) return () => {};
    const stop = listenTo(element, (event) => {
      try {
        return this.#drag(event, camera);
      } catch (error) {
        if (!this.emit('error', error as Error)) throw error;
        return undefined;
      }
    });
    this.#stops.add(stop);
    return () => {
      stop();
      this.#stops.delete(stop);
    };
  }

  /** Frees what is its own, and paints no more. The layers stay, with what was painted. */
  dispose(): void {
    this.#isDisposed = true;
    for (const stop of this.#stops) stop();
    this.#painter.dispose();
    this.#sheet.dispose();
    if (!this.#painter.hasSheets) this.#unfollow();
  }

  get #canvas(): HTMLElement {
    return this.layers.canvas;
  }

  /** Begins what the tool does with a pointer. */
  #drag(event: PointerEvent, camera: Camera): Drag | undefined {
    const { tool } = this;
    const spot = tool && this.pickAt(event, camera);
    if (!spot?.surface) return undefined;
    if (tool === 'sticker') return this.#dragSticker(spot, camera);
    if (tool === 'eraser' && !this.#painter.hasPainting) return undefined;
    const style = { ...this.brush, erases: tool === 'eraser' };
    checkBrush(style);
    const aim = (at: { clientX: number; clientY: number }) => this.#aim(this.pickAt(at, camera), camera);
    const stroke = new PointerStroke(this.#painter, {
      aimAt: (clientX, clientY) => aim({ clientX, clientY }),
      triangles: this.#models.reduce((sum, { result }) => sum + result.cosmeticTriangles.length, 0),
    });
    if (!stroke.begin(this.#aim(spot, camera), event, style)) return undefined;
    return {
      move: (moved) => stroke.move(aim(moved), moved),
      end: () => stroke.end(),
      cancel: () => stroke.cancel(),
    };
  }

  /** A sticker follows the pointer until that goes up. */
  #dragSticker(first: Spot, camera: Camera): Drag | undefined {
    const { picture } = this;
    if (!picture) return undefined;
    const lay = this.#beginSticker(picture, picture);
    const place = (spot: Spot | undefined): void => {
      if (!spot?.surface) return;
      lay(spot.surface, new Vector3().setFromMatrixColumn(camera.matrixWorld, 1).transformDirection(spot.toCage));
    };
    place(first);
    return {
      move: (event) => place(this.pickAt(event, camera)),
      end: () => this.#painter.end(),
      cancel: () => this.#painter.cancel(),
    };
  }

  #aim(spot: Spot | undefined, camera: Camera): Aim | undefined {
    const { height } = this.#canvas.getBoundingClientRect();
    return spot && { surface: spot.surface, scale: spot.scale * pixelsPerUnit(camera, spot.point, height) };
  }

  /** Begins a sticker. @returns a function that lays it somewhere, upright with respect to a direction. */
  #beginSticker(
    picture: StickerPicture,
    { size = 0.2, angle = 0, mirrored, opacity = 1 }: Partial<StickerPlace>,
  ): (surface: SurfacePoint, up?: Vector3) => void {
    checkSize(size);
    check(Number.isFinite(angle), 'angle', angle, 'a number');
    checkShare('opacity', opacity);
    this.#sheet.draw(picture);
    this.#painter.begin('sticker', { color: '#000000', opacity, hardness: 1, erases: false });
    const style = { size: size * this.#painter.cageTexels!.diagonal, angle, mirrored };
    return (surface, up = new Vector3(0, 1, 0)) => this.#painter.stick(surface, this.#sheet, style, up);
  }

  #stroke(points: readonly (StrokePoint | undefined)[], style: BrushStyle): void {
    checkBrush(style);
    if (!Array.isArray(points)) throw notA('an array', 'points', points);
    const texels = this.#painter.cageTexels;
    if (!texels) return; // disposed of
    const stroke = new Stroke(texels, { radius: (style.size / 2) * texels.diagonal, mirror: style.mirror });
    this.#painter.begin(style.erases ? 'erasing' : 'stroke', style);
    try {
      for (const point of points) {
        const { pressure = 1 } = point ?? {};
        checkShare('pressure', pressure);
        this.#painter.extend(stroke.to(this.#surfaceAt(point), Infinity, pressure));
      }
    } catch (error) {
      this.#painter.cancel();
      throw error;
    }
    this.#painter.end();
  }

  #surfaceAt(point: Spot | { x: number; y: number } | undefined): SurfacePoint | undefined {
    if (point === undefined) return undefined;
    const { toCage, surface, x, y } = Object(point) as Partial<Spot & { x: number; y: number }>;
    const { cageTexels: texels } = this.#painter;
    if (toCage) return texels && surface;
    if (![x, y].every(Number.isFinite)) throw wrong(`a point is (${show(x)}, ${show(y)}), not a UV`);
    return texels?.at(x!, y!);
  }
}

/** Also after a painter has been disposed of that has painted, as the layers stay: so this holds no more of it. */
function follow(layers: Layers, painter: LayerPainter): () => void {
  painter.on('change', () => layers.announce());
  return layers.on('restored', () => painter.restore());
}

/** @throws {CagecastError} `badArgument` */
function checkCamera(camera: Camera): void {
  if (!camera?.isCamera) throw notA('a Camera', 'camera', camera);
}

/** @throws {CagecastError} `badOption` that names the field and its value. */
function checkBrush({ color, size, hardness, opacity }: BrushStyle): void {
  checkColor('color', color);
  checkShare('opacity', opacity);
  checkShare('hardness', hardness);
  checkSize(size);
}

/**
 * Makes a painter, and shows what it paints on the models.
 * @throws {CagecastError} that names the option.
 * Cost: tens of milliseconds for the first stroke.
 *
 * @example
 * const applied = applyTransfer(head, { cage, texture });
 * const painter = createPainter({ renderer, texture, applied, cage });
 * painter.brush.color = '#cc2244';
 * painter.listen(camera);
 * renderer.setAnimationLoop(() => {
 *   painter.update();
 *   renderer.render(scene, camera);
 * });
 * undoButton.onclick = () => painter.undo();
 */
export const createPainter = (options: PainterOptions): Painter => new Painter(options);
