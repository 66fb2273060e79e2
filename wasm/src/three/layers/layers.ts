import type { Texture, WebGLRenderer } from 'three';
import { maxCompositeSize } from '../../gltf/look/saved-images.js';
import { checkRegion, kWhite, type Regions, type SavedLayers } from '../../gltf/look/saved-layers.js';
import type { LoadedCage } from '../apply/models.js';
import { check, notA, wrong } from '../errors.js';
import { readStraight } from '../gpu/straight.js';
import { BaseTint } from './base-tint.js';
import { Composite } from './composite.js';
import { CopiedTexture } from './copied-texture.js';
import { Edits } from './edits.js';
import { Emitter } from './emitter.js';
import { History } from './history.js';
import { checkTexture, freeName, type Layer, readStyle, type Style } from './layer.js';
import { giveBack, lendRenderer, type OtherRenderer } from './own-renderer.js';
import { PaintedSheet } from './painted-sheet.js';
import { regionsOf } from './regions.js';
import { loadLayers, saveLayers } from './saved-layers.js';
import { ShownChannels } from './shown-channels.js';
import { LayerStack } from './stack.js';

/** Options of `createLayers`. */
export interface LayersOptions {
  /**
   * Draws the texture; the models that show it have to be drawn by the same one. For a `WebGPURenderer`, a `WebGLRenderer` of their own
   * draws the layers, and an `update` that has changed them copies the texture, for which it waits for the GPU; the page calls
   * `enableLayers` of `cagecast/three/webgpu` once.
   */
  renderer: WebGLRenderer | OtherRenderer;
  /** The cage, for layers that are seen within one of its regions. Default: there are no regions. */
  cage?: LoadedCage | undefined;
  /** Texels per side of the texture: 256, 512, 1024 or 2048. Default: 1024, or 2048 where a layer is larger than 1024. */
  size?: (typeof kSizes)[number] | undefined;
}

const kSizes = [256, 512, 1024, maxCompositeSize] as const;

const kColorsOnly =
  'cagecast/three: toImageData has the colours only, not gloss, metal, glow, relief, base tint; what save returns has all, also for paintGlb';

/** How a change is made. */
export interface ChangeOptions {
  /** Whether the change is a step that `undo` takes back. Default: true. */
  undoable?: boolean | undefined;
}

/** The style of a new layer, its name, and where it lies. */
export interface NewLayer extends Partial<Style>, ChangeOptions {
  /** For people, also in the undo history. Default: the texture's name. */
  name?: string | undefined;
  /** From 0, the lowest, an integer; what is out of range is clamped. Default: on top. */
  place?: number | undefined;
}

/** A stack of layers that is shown as one texture. Every change is a step that can be undone. */
export class Layers extends Emitter<{
  /** The texture will change with the next `update`: draw a frame. */
  change: undefined;
  /** The graphics context was lost and is back: what was painted has to be uploaded again. For painters. */
  restored: undefined;
}> {
  /** The layers by themselves, with their events; what is changed here cannot be undone. @internal */
  readonly stack = new LayerStack();
  /** @internal */
  readonly history = new History();
  /** @internal */
  readonly edits = new Edits(this.stack, this.history);
  /** @internal */
  readonly composite: Composite;
  /** What draws the layers. */
  readonly renderer: WebGLRenderer;
  /** The canvas on which models are seen. @internal */
  readonly canvas: HTMLElement;
  /** Where another renderer shows the layers. */
  readonly #copied: CopiedTexture | undefined;
  readonly #channels: ShownChannels;
  readonly #baseTint = new BaseTint(this.history, () => this.announce());
  #isDisposed = false;
  /** Whether the console was told that an image has the colours only. */
  #isTold = false;
  readonly #regions: Regions | undefined;
  /** Paintings that were loaded, as far as they may be shown again. */
  readonly #loaded: WeakRef<PaintedSheet>[] = [];
  /** Normal maps that were loaded, which are nobody else's. */
  readonly #reliefs: WeakRef<Texture>[] = [];
  readonly #restored = (): void => {
    for (const sheet of this.#loaded) sheet.deref()?.restore(this.renderer);
    this.emit('restored', undefined);
    this.composite.set(this.stack.layers);
    this.announce();
  };

  constructor(options: LayersOptions) {
    super();
    const { renderer, cage, size } = options ?? {};
    const isOther = (renderer as OtherRenderer | undefined)?.isWebGPURenderer === true;
    // Other renderers have no such map.
    if (!isOther && typeof (renderer as WebGLRenderer | undefined)?.properties?.get !== 'function')
      throw wrong('options.renderer is neither a WebGLRenderer nor a WebGPURenderer');
    if (size !== undefined) check(kSizes.includes(size), 'size', size, `one of ${kSizes.join(', ')}`);
    this.#regions = cage && regionsOf(cage);
    this.canvas = renderer.domElement;
    this.renderer = isOther ? lendRenderer() : (renderer as WebGLRenderer);
    this.composite = new Composite(size, this.#regions);
    this.#copied = isOther ? new CopiedTexture(this.composite.texture) : undefined;
    this.#channels = new ShownChannels(this.texture, isOther);
    this.stack.on('change', (layers) => {
      this.composite.set(layers);
      this.announce();
    });
    this.renderer.domElement.addEventListener('webglcontextrestored', this.#restored);
  }

  /**
   * All layers in one, for `applied.setTexture` of any number of models. Always the same object, with mipmaps;
   * its colours are premultiplied by alpha. Call `update` before it is drawn.
   */
  get texture(): Texture {
    return this.#copied?.texture ?? this.composite.texture;
  }

  /** From the lowest to the uppermost. */
  get list(): readonly Layer[] {
    return this.stack.layers;
  }

  /**
   * Adds a layer.
   * @param texture  In the cage's UV space; its `colorSpace` and `flipY` count (false for what is drawn for a glTF), its offset, repeat and rotation
   *                 do not, but those of the options. One whose `needsUpdate` is set later, such as a canvas, is drawn again by `update`. It is not disposed of
   *                 with the layer.
   * @throws {CagecastError} `badArgument` for the 17th layer or if it is not a texture, `badOption` that names an option and its value.
   */
  add(texture: Texture, options: NewLayer = {}): Layer {
    checkTexture(texture, 'texture');
    this.#checkReadable(texture, 'texture');
    const style = this.#readStyle(options, 'options');
    const { name, place, undoable } = options;
    const title = name ?? (texture.name || freeName('Layer', this.list));
    return this.#do(`adding ${title}`, undoable, () => {
      const premultiplied = texture.premultiplyAlpha;
      const layer = this.stack.add(title, { texture, premultiplied }, style);
      if (place !== undefined) this.stack.move(layer, place);
      return layer;
    });
  }

  /**
   * Changes opacity, tint, blend mode, visibility, region, place, roughness, metalness, glow or relief. Equal changes of a layer in quick succession, as by a slider, are one step.
   * @throws {CagecastError} `badOption` that names a field and its value, `badArgument` if the layer was removed.
   */
  set(layer: Pick<Layer, 'id'>, style: Partial<Style>, { undoable }: ChangeOptions = {}): void {
    const change = this.#readStyle(style, 'style');
    this.#do(`changing ${Object.keys(change).join(', ')} of ${this.#nameOf(layer)}`, undoable, () =>
      this.stack.restyle(layer, change),
    );
  }

  /** By what the model's own colour is multiplied beneath all layers, #rrggbb. White, the default, changes nothing. */
  get baseTint(): string {
    return this.#baseTint.value;
  }

  /**
   * Tints the model beneath all layers: its own colour is multiplied by `tint`, in linear light, where it is painted, up to the soft
   * border. Changes in quick succession, as by a slider, are one step. Overlays, of materials that cannot be painted, do not show it.
   * @param tint  #rrggbb; white for none.
   * @throws {CagecastError} `badOption` for another value.
   */
  setBaseTint(tint: string, { undoable }: ChangeOptions = {}): void {
    if (undoable !== false) this.#baseTint.change(tint);
    else this.#baseTint.set(tint);
  }

  /**
   * Moves a layer.
   * @param place  From 0, the lowest; what is out of range is clamped.
   * @throws {CagecastError} `badArgument` if it is no integer, or the layer was removed.
   */
  move(layer: Pick<Layer, 'id'>, place: number, { undoable }: ChangeOptions = {}): void {
    this.#do(`moving ${this.#nameOf(layer)}`, undoable, () => this.stack.move(layer, place));
  }

  /** Removes a layer. @throws {CagecastError} `badArgument` if it was removed. */
  remove(layer: Pick<Layer, 'id'>, { undoable }: ChangeOptions = {}): void {
    this.#do(`removing ${this.#nameOf(layer)}`, undoable, () => this.stack.remove(layer.id));
  }

  /** Undoes the last step. @returns its name; undefined if there was none. */
  undo(): string | undefined {
    return this.history.undo()?.name;
  }

  /** Repeats the step that was undone. @returns its name; undefined if there was none. */
  redo(): string | undefined {
    return this.history.redo()?.name;
  }

  get canUndo(): boolean {
    return this.history.last !== undefined;
  }

  get canRedo(): boolean {
    return this.history.next !== undefined;
  }

  /**
   * Draws the texture again where it has changed. Call it before each frame.
   * @returns whether anything had changed.
   * Cost: nothing if not; else one pass over what has changed, two with more than eight visible layers; as much again if some layer
   * has roughness or metalness, if one glows, and if one has a normal map. Each of these three is a texture more, of which the shaders of
   * the models that show the layers are compiled anew when it is needed for the first time.
   */
  update(): boolean {
    const isDrawn = this.composite.update(this.renderer);
    if (isDrawn) this.#copied?.copy(this.composite.target, this.renderer);
    const isTinted = this.#channels.tint(this.baseTint);
    if (isDrawn || isTinted) this.#channels.show(this.composite, this.renderer);
    return isDrawn || isTinted;
  }

  /** Announces that a part of the texture has changed, or that a stroke is in progress. For painters. @internal */
  touch(...change: Parameters<Composite['touch']>): void {
    this.composite.touch(...change);
    this.announce();
  }

  /** Announces a change of the texture, after `composite` was told its place. For painters. @internal */
  announce(): void {
    this.emit('change', undefined);
  }

  /**
   * Reads the texture, as image files have it: sRGB, colours not multiplied by alpha. Waits for the GPU. Roughness, metalness, glow,
   * relief and the base tint are not in it, of which the console warns once; `paintGlb` of `cagecast/gltf` writes all of what `save` returns.
   * @param size  Texels per side, 1 to 2048. Default: those of the texture.
   * @throws {CagecastError} `badArgument` for another size.
   */
  toImageData(size = this.composite.size): ImageData {
    if (!(Number.isInteger(size) && size > 0 && size <= maxCompositeSize))
      throw notA(`an integer from 1 to ${maxCompositeSize}`, 'size', size);
    this.update();
    const hasMore = this.composite.channels.size > 0 || this.baseTint !== kWhite;
    if (hasMore && !this.#isTold) console.warn(kColorsOnly);
    this.#isTold ||= hasMore;
    return readStraight(this.renderer, this.composite.texture, size);
  }

  /**
   * All layers as plain data, for `JSON.stringify`: their order, styles, images and normal maps, and the base tint; paintings can be painted on again. On any model with
   * a cage of the same layout they look the same. A stroke in progress is left out.
   * Each image is there once, of its own size, at most 2048 texels along a side.
   * Cost: draws and reads each image, and waits for the GPU; for paintings then some hundred milliseconds for PNG files.
   */
  save(): Promise<SavedLayers> {
    return saveLayers(this.renderer, this.list, this.baseTint);
  }

  /**
   * Puts saved layers and their base tint in the place of those that there are, as one step. Their images have at
   * most 2048 × 2048 pixels, as `save` writes them. Sizes are read before any of them is decoded, one after the other.
   * @throws {CagecastError} `badArgument` that names the layer, the value and the limit, if it is not what `save` returned; `badOption` for
   * a style that is wrong, or a region that the cage does not have. Then nothing is changed.
   */
  async load(saved: SavedLayers, { undoable }: ChangeOptions = {}): Promise<void> {
    const { layers, baseTint } = await loadLayers(this.renderer, saved, this.#regions);
    const before = this.baseTint;
    const put = () => {
      for (const { id } of this.list) this.stack.remove(id);
      for (const { name, sheet, style } of layers) this.stack.add(name, sheet, style);
      this.#baseTint.set(baseTint);
    };
    const tinting = baseTint !== before ? this.#baseTint.between(before, baseTint) : undefined;
    if (undoable !== false) this.edits.do('loading layers', put, tinting);
    else put();
    for (const { sheet, style } of layers) {
      if (sheet instanceof PaintedSheet) this.#loaded.push(new WeakRef(sheet));
      if (style.normal) this.#reliefs.push(new WeakRef(style.normal));
    }
  }

  /** Frees the GPU memory of the texture and of what was painted. Textures that were added are the caller's. */
  dispose(): void {
    for (const { sheet } of this.list) sheet.dispose?.();
    this.renderer.domElement.removeEventListener('webglcontextrestored', this.#restored);
    for (const relief of this.#reliefs) relief.deref()?.dispose();
    this.composite.dispose();
    this.#channels.dispose();
    this.#copied?.texture.dispose();
    if (this.#copied && !this.#isDisposed) giveBack();
    this.#isDisposed = true;
  }

  #do<Result>(name: string, undoable: boolean | undefined, run: () => Result): Result {
    return undoable !== false ? this.edits.do(name, run) : run();
  }

  #readStyle(style: Partial<Style>, argument: string): Partial<Style> {
    const given = readStyle(style, argument);
    checkRegion(given.region, this.#regions);
    this.#checkReadable(given.normal, `${argument}.normal`);
    return given;
  }

  #checkReadable(texture: Texture | null | undefined, name: string): void {
    if (this.#copied && texture?.isRenderTargetTexture)
      throw wrong(`${name} is drawn by another renderer than the layers, which cannot read it`);
  }

  #nameOf(layer: Pick<Layer, 'id'>): string {
    if (typeof layer?.id !== 'number') throw notA('a layer', 'layer', layer);
    return this.list.find(({ id }) => id === layer.id)?.name ?? 'a layer';
  }
}

/**
 * Makes an empty stack of layers.
 * @throws {CagecastError} `badArgument` without a `WebGLRenderer`, or a `WebGPURenderer` and its entry; `badOption` for another size;
 * `unsupported` with a `WebGPURenderer` where there is no WebGL 2.
 *
 * @example
 * const layers = createLayers({ renderer });
 * layers.add(stripes);
 * const blush = layers.add(cheeks, { blend: 'multiply', opacity: 0.6, tint: '#ff8080' });
 * for (const applied of models) applied.setTexture(layers.texture);
 * layers.set(blush, { opacity: 0.3 });
 * renderer.setAnimationLoop(() => {
 *   layers.update();
 *   renderer.render(scene, camera);
 * });
 */
export const createLayers = (options: LayersOptions): Layers => new Layers(options);
