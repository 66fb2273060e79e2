import { MeshStandardMaterial, type Texture } from 'three';
import { type GLTF, GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import type { Preset } from '../api/index.js';
import { kPartLists } from '../api/option-names.js';
import { CagecastError } from '../core/error.js';
import {
  type Applied,
  type ApplyOptions,
  applyTransfer,
  applyTransferAsync,
  deserialize,
  serialize,
} from '../three/index.js';
import { inspectorOf } from './check.js';
import type { ViewerElement, ViewerEvents } from './events.js';
import { copyOf, disposeModel, type Fetched, fetchFile, loadPaint, readModel } from './load.js';
import { defaultOrbit, type Orbit, Stage } from './stage.js';

/** Attributes of which a change means another transfer. */
const kOfTransfer = ['target', 'cage', 'preset', 'threshold', 'borders', 'motion', 'feather', ...kPartLists];

const kLost =
  'cagecast-viewer: the browser has stopped this 3D view, as the page has more of them than it allows (16 in Chromium) or the graphics were reset';

/** Milliseconds in which a browser may give a graphics context back by itself. */
const kPatience = 3000;

const kStyle = `
  :host { display: block; position: relative; width: 300px; height: 300px; }
  :host([hidden]) { display: none; }
  canvas { display: block; width: 100%; height: 100%; touch-action: none; }
  canvas:focus-visible { outline: 2px solid Highlight; outline-offset: -2px; }
  .poster, .error { position: absolute; inset: 0; width: 100%; height: 100%; box-sizing: border-box; object-fit: contain; }
  .error { margin: 0; padding: 1em; overflow: auto; color: #7a0000; background: #fff; font: 14px/1.4 system-ui, sans-serif; }
  [hidden] { display: none; }
`;

/** What is shown. */
interface Shown {
  file: Fetched; // of the model
  gltf: GLTF;
  applied: Applied | undefined;
  parts: ApplyOptions['parts'];
  paint: Texture | undefined;
  /** Of the paint. */
  opacity: number;
}

/**
 * `<cagecast-viewer>`. Attributes, all of which may change at any time; the last change wins:
 *
 * - `target`, `cage`: addresses of a glTF or GLB file each. Without a cage the target is shown bare.
 * - `paint`: the address of a picture in the cage's UVs.
 * - `opacity`, `feather`, `preset`, `threshold`, `borders`, `motion`: as the options of `applyTransfer`.
 * - `ignore`, `keep`, `exclude`: as those of its option `parts`: patterns, with commas between them.
 * - `camera-orbit`: degrees from the front and from above, and the distance as a share of that which shows all: `20deg 80deg 100%`.
 * - `alt`: what assistive technology says. `poster`: the address of a picture to show until the model is there.
 * - `check`: inspects the cage too, in a worker, which takes up to 15 times as long as a transfer; `verdict` comes after `load`.
 *
 * Events: `progress` (`detail: { share, stage }`), `load`, `verdict` (`detail`: `Check`), `error` (`detail`: the `Error`, which the
 * element shows too). Arrow keys turn the model, + and - zoom, Home goes back. When it is removed from the page, it frees all it has.
 *
 * One that the browser has stopped, as the page has too many 3D views, says so. It is loaded again 3 seconds later if it is in view
 * then, once; and whenever it comes into view or the page is shown again.
 *
 * In a page with a Content-Security-Policy: `script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self' blob:;
 * img-src 'self' blob:`.
 */
export class CagecastViewer extends ((globalThis.HTMLElement ?? Object) as unknown as new () => ViewerElement) {
  static readonly observedAttributes = [...kOfTransfer, 'paint', 'opacity', 'camera-orbit', 'alt', 'poster', 'check'];

  /** Loads models. For files that are compressed, give it the decoders: `viewer.loader.setDRACOLoader(…)`. */
  loader = new GLTFLoader();
  #canvas: HTMLCanvasElement;
  readonly #poster: HTMLImageElement;
  readonly #error = newAlert();
  /** Shown while the graphics context is lost. */
  readonly #lost = newAlert();
  /** Whether the error that is shown is about the opacity or the camera. */
  #hasBadAppearance = false;
  #stage: Stage | undefined;
  /** Whether it was loaded again though it was seen all the time: more than once, and elements that are too many would never rest. */
  #isRestarted = false;
  #shown: Shown | undefined;
  #orbit = defaultOrbit;
  /** Whether the attributes name another model than the one that is shown, which could not be loaded, or not yet. */
  #isOutdated = true;
  /** Ends the loading under way. */
  #loading: AbortController | undefined;
  /** The attributes that have changed since the last update. */
  #changed = new Set<string>();
  /** The values of the attributes at the last update. */
  #used = new Map<string, string | null>();

  constructor() {
    super();
    const root = this.attachShadow({ mode: 'open', delegatesFocus: true });
    this.#setStyle();
    this.#canvas = this.#newCanvas();
    this.#poster = Object.assign(document.createElement('img'), { className: 'poster', hidden: true, alt: '' });
    root.append(this.#canvas, this.#poster, this.#error, this.#lost);
  }

  connectedCallback(): void {
    // One that was moved within the page still shows what it did.
    for (const name of CagecastViewer.observedAttributes)
      if (!this.#stage || this.getAttribute(name) !== this.#used.get(name)) this.#change(name);
  }

  disconnectedCallback(): void {
    // An element that is moved is connected again at once.
    queueMicrotask(() => this.isConnected || this.#free());
  }

  adoptedCallback(): void {
    this.#setStyle();
  }

  attributeChangedCallback(name: string, before: string | null, now: string | null): void {
    if (before !== now && this.isConnected) this.#change(name);
  }

  /**
   * A picture of what is shown.
   * @param type     An image type that canvases can write. Default: `image/png`.
   * @param quality  0 to 1, for types with losses.
   * @throws Error if nothing is shown yet, or the browser has stopped the 3D view.
   */
  async toBlob(type?: string, quality?: number): Promise<Blob> {
    this.#get('toBlob');
    if (this.#stage!.isLost) throw new Error(kLost);
    this.#stage!.drawNow();
    return new Promise((resolve, reject) =>
      this.#canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('toBlob: no picture'))), type, quality),
    );
  }

  /**
   * The painted model as a file, with the paint as an overlay that any glTF viewer shows.
   * @throws Error if nothing is shown yet.
   */
  async exportGlb(): Promise<ArrayBuffer> {
    const { file, applied, parts, paint, opacity } = this.#get('exportGlb');
    // Of the file as it was: its address may lead nowhere by now. The paint may change meanwhile.
    const [{ GLTFExporter }, { scene, animations }, map] = await Promise.all([
      import('three/addons/exporters/GLTFExporter.js'),
      readModel(this.loader, 'target', file),
      paint && copyOf(paint),
    ]);
    try {
      if (applied && map) {
        map.channel = applied.channel;
        const material = new MeshStandardMaterial({ map, transparent: true, opacity });
        applyTransfer(scene, { saved: deserialize(serialize(applied)), parts, channel: applied.channel, material });
      }
      return (await new GLTFExporter().parseAsync(scene, { binary: true, animations })) as ArrayBuffer;
    } finally {
      disposeModel(scene);
      map?.dispose();
    }
  }

  #get(method: string): Shown {
    if (!this.#shown) throw new Error(`${method}: <cagecast-viewer> shows nothing yet; wait for its event load`);
    return this.#shown;
  }

  /** Each document needs a style sheet of its own. */
  #setStyle(): void {
    const window = this.ownerDocument.defaultView;
    if (!window) return; // nothing of this document is shown
    const style = new window.CSSStyleSheet();
    style.replaceSync(kStyle);
    this.shadowRoot!.adoptedStyleSheets = [style];
  }

  #newCanvas(): HTMLCanvasElement {
    const canvas = document.createElement('canvas');
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-keyshortcuts', 'ArrowLeft ArrowRight ArrowUp ArrowDown + - Home');
    return canvas;
  }

  #change(name: string): void {
    if (this.#changed.size === 0) queueMicrotask(() => this.#update());
    this.#changed.add(name);
  }

  #update(): void {
    const changed = this.#changed;
    this.#changed = new Set();
    if (!this.isConnected) return;
    this.#used = new Map(CagecastViewer.observedAttributes.map((name) => [name, this.getAttribute(name)]));
    this.#canvas.setAttribute('aria-label', this.getAttribute('alt') || '3D model');
    const poster = this.getAttribute('poster');
    if (poster) this.#poster.src = poster;
    this.#poster.hidden = !poster || this.#shown !== undefined;
    // A paint alone needs no other transfer; but one under way is begun anew.
    const isOther = changed.has('paint') && this.#isOutdated;
    // What could not be loaded may have failed for its opacity.
    const isAgain = changed.has('opacity') && !this.#loading && this.#isOutdated;
    if (isOther || isAgain || changed.has('check') || kOfTransfer.some((name) => changed.has(name)))
      void this.#load((signal) => this.#loadAll(signal));
    else if (changed.has('paint')) void this.#load((signal) => this.#loadPaint(signal));
    if (changed.has('opacity') || changed.has('camera-orbit')) this.#setAppearance(changed.has('camera-orbit'));
  }

  /** Takes what needs no loading: the opacity and the camera's orbit. */
  #setAppearance(isPlaced: boolean): void {
    try {
      this.#orbit = readOrbit(this.getAttribute('camera-orbit'));
      if (isPlaced && this.#shown) this.#stage?.place(this.#orbit);
      const { opacity = 1 } = this.#options();
      this.#shown?.applied?.setOpacity(opacity);
      if (this.#shown) this.#shown.opacity = opacity;
      this.#stage?.draw();
      if (this.#hasBadAppearance) this.#error.hidden = true;
      this.#hasBadAppearance = false;
    } catch (error) {
      if (this.#loading) return; // the end of that reports it
      this.#fail(error);
      this.#hasBadAppearance = true;
    }
  }

  /** Loads something instead of what is being loaded. */
  async #load(work: (signal: AbortSignal) => Promise<void>): Promise<void> {
    this.#loading?.abort();
    this.#loading = undefined;
    this.#error.hidden = true;
    if (!this.getAttribute('target')) {
      this.#drop();
      return;
    }
    const loading = new AbortController();
    this.#loading = loading;
    try {
      this.#stage ??= new Stage(
        this.#canvas,
        () => this.#tellLost(),
        () => this.#onSight(),
      );
      await work(loading.signal);
      loading.signal.throwIfAborted();
      this.#loading = undefined;
      this.#setAppearance(false); // It may have changed since; or its error was hidden.
      this.#tell('load', undefined);
    } catch (error) {
      if (loading.signal.aborted) return;
      this.#loading = undefined;
      this.#fail(error);
    }
  }

  #tellLost(): void {
    const isLost = this.#stage!.isLost;
    this.#lost.textContent = kLost;
    this.#lost.hidden = !isLost;
    if (!isLost) return;
    this.#tell('error', new Error(kLost));
    setTimeout(() => {
      if (!this.#stage?.isLost || !this.#stage.isSeen || this.#isRestarted) return;
      this.#isRestarted = true;
      this.#restart();
    }, kPatience);
  }

  #onSight(): void {
    const stage = this.#stage;
    if (!stage?.isSeen) this.#isRestarted = false;
    else if (stage.isLost) this.#restart();
    else stage.draw(); // browsers take the context that was drawn longest ago
  }

  #fail(error: unknown): void {
    this.#error.textContent = (error as Error).message;
    this.#error.hidden = false;
    this.#hasBadAppearance = false;
    this.#tell('error', error as Error);
  }

  async #loadAll(signal: AbortSignal): Promise<void> {
    this.#isOutdated = true;
    const [target, cage, paint] = ['target', 'cage', 'paint'].map((name) => this.getAttribute(name) ?? '');
    this.#tell('progress', { share: 0, stage: 'files' });
    const load = async (name: string, address: string) => {
      const file = await fetchFile(name, address, signal);
      return { file, gltf: await readModel(this.loader, name, file) };
    };
    const model = load('target', target!);
    const around = cage ? load('cage', cage) : undefined;
    const texture = paint ? loadPaint(paint, signal) : undefined;
    let shown: Shown;
    let tellVerdict: (() => Promise<void>) | undefined;
    try {
      const [{ file, gltf }, outer, paint] = await Promise.all([model, around, texture]);
      signal.throwIfAborted();
      const options = this.#options();
      const check = outer && this.hasAttribute('check') ? inspectorOf(gltf, outer.gltf, options.parts) : undefined;
      const onProgress = (share: number, stage: string) => this.#tell('progress', { share: 0.3 + 0.7 * share, stage });
      const applied =
        outer &&
        (await applyTransferAsync(gltf, {
          cage: outer.gltf,
          ...options,
          texture: paint,
          signal,
          onProgress,
        }));
      signal.throwIfAborted();
      shown = { file, gltf, applied, parts: options.parts, paint, opacity: options.opacity ?? 1 };
      if (check && applied)
        tellVerdict = async () => {
          const verdict = await check(applied, options);
          if (this.#shown === shown) this.#tell('verdict', verdict);
        };
    } catch (error) {
      // Neither what was loaded nor what is still to come is of use now.
      free(model);
      free(texture);
      throw error;
    } finally {
      free(around);
    }
    // Another transfer of the same model leaves the camera where people have moved it.
    const isSame = this.#shown?.file.url === shown.file.url;
    this.#drop();
    this.#shown = shown;
    this.#isOutdated = false;
    this.#poster.hidden = true;
    this.#stage!.show(shown.gltf.scene, isSame ? undefined : this.#orbit);
    // The model is there, whatever comes of this.
    tellVerdict?.().catch((error: Error) => this.#shown === shown && this.#tell('error', error));
  }

  async #loadPaint(signal: AbortSignal): Promise<void> {
    const address = this.getAttribute('paint');
    const paint = address ? await loadPaint(address, signal) : undefined;
    // What comes later has its own paint, and perhaps another model.
    if (signal.aborted) paint?.dispose();
    signal.throwIfAborted();
    const shown = this.#shown!;
    shown.applied?.setTexture(paint);
    shown.paint?.dispose();
    shown.paint = paint;
  }

  #options(): ApplyOptions {
    const number = (name: string) => {
      const given = this.getAttribute(name);
      if (given === null) return undefined;
      if (given.trim() === '' || Number.isNaN(Number(given)))
        throw new CagecastError('badOption', 'cagecast-viewer', `${name} is "${given}", not a number`);
      return Number(given);
    };
    const text = <T extends string>(name: string) => (this.getAttribute(name) as T | null) ?? undefined;
    const whether = (name: string) => {
      const given = text(name);
      if (given !== undefined && given !== 'true' && given !== 'false')
        throw new CagecastError('badOption', 'cagecast-viewer', `${name} is "${given}", not true or false`);
      return given === undefined ? undefined : given === 'true';
    };
    const trim = (pattern: string) => pattern.trim();
    const patterns = (list: string) => text(list)?.split(',').map(trim);
    const all = {
      parts: Object.fromEntries(kPartLists.map((list) => [list, patterns(list)])),
      opacity: number('opacity'),
      feather: number('feather'),
      threshold: number('threshold'),
      preset: text<Preset>('preset'),
      borders: text<'cut' | 'triangle'>('borders'),
      motion: whether('motion'),
    };
    return Object.fromEntries(Object.entries(all).filter(([, value]) => value !== undefined));
  }

  #tell<Type extends keyof ViewerEvents>(type: Type, detail: ViewerEvents[Type]['detail']): void {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  /** Frees what is shown. */
  #drop(): void {
    this.#stage?.clear();
    // Geometries first: a transfer that ends takes away what three.js would free with them.
    if (this.#shown) disposeModel(this.#shown.gltf.scene);
    this.#shown?.applied?.dispose();
    this.#shown?.paint?.dispose();
    this.#shown = undefined;
    this.#isOutdated = true;
    this.#poster.hidden = !this.getAttribute('poster');
  }

  /** Loads all again, with another graphics context. */
  #restart(): void {
    this.#free();
    this.connectedCallback();
  }

  #free(): void {
    this.#loading?.abort();
    this.#loading = undefined;
    this.#drop();
    if (!this.#stage) return;
    this.#stage.dispose();
    this.#stage = undefined;
    this.#lost.hidden = true;
    // A canvas never gets a second graphics context.
    const canvas = this.#newCanvas();
    this.#canvas.replaceWith(canvas);
    this.#canvas = canvas;
  }
}

/** The orbit that an attribute names; what it leaves out is as usual. @throws {CagecastError} `badOption` */
function readOrbit(given: string | null): Orbit {
  const found = /^(?:(\S+?)(?:deg)?)?(?:\s+(\S+?)(?:deg)?)?(?:\s+(\S+?)%?)?$/.exec((given ?? '').trim());
  const { azimuth, polar, distance } = defaultOrbit;
  const values = [azimuth, polar, 100 * distance].map((usual, i) => Number(found ? (found[i + 1] ?? usual) : NaN));
  if (!(values.every(Number.isFinite) && values[2]! > 0)) {
    const what = 'angles and a distance such as 20deg 80deg 100%';
    throw new CagecastError('badOption', 'cagecast-viewer', `camera-orbit is "${given}", not ${what}`);
  }
  return { azimuth: values[0]!, polar: values[1]!, distance: values[2]! / 100 };
}

function newAlert(): HTMLElement {
  const alert = Object.assign(document.createElement('p'), { className: 'error', hidden: true });
  alert.setAttribute('role', 'alert');
  alert.setAttribute('part', 'error');
  return alert;
}

/** Frees what is being loaded, once it is there. */
function free(loading: Promise<Texture | { gltf: GLTF }> | undefined): void {
  loading?.then(
    (loaded) => ('gltf' in loaded ? disposeModel(loaded.gltf.scene) : loaded.dispose()),
    () => {}, // has been said
  );
}
